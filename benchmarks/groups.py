"""What a cohort of eight and eight legs tells beside a t-test, by resampling.

Relaxed curves of virtual legs that `reliability.py` keeps in a folder, their first visit; two
groups of eight are drawn forty times, alike or the second half as stiff again (values and their
errors times 1.5). `cohort` is asked for one measure beforehand; Welch's t-test has the same
estimates, and the true values. The count is kept in ``groups.json``, and with --write stands in the
documentation.

    .venv/bin/python benchmarks/groups.py FOLDER… [--write]
"""

import argparse
import json
import pickle
from datetime import UTC, datetime
from pathlib import Path
from typing import Any

import numpy as np
from scipy.stats import ttest_ind

import surae
from surae.base.frozen import FrozenDict
from surae.cohorts.member import CohortMember
from surae.cohorts.pooled import pool
from surae.inference import Adequacy, Grade
from surae.inference.relaxed.curve import RelaxedCurve
from surae.measures.compared import Quantities, Quantity
from surae.measures.rest.judged import rated_measures

HERE = Path(__file__).resolve().parent
RESULT = HERE / "groups.json"
PAGE = HERE.parent / "docs" / "how-to" / "run-a-cohort.md"
MARKS = "<!-- groups: begin -->", "<!-- groups: end -->"
ASKED = {
    "slow_stiffness@10deg": "stiffness in a slow stretch, 10°",
    "slow_stiffness@0deg": "the same, 0°",
    "passive_stiffness@10deg": "stiffness at rest, 10°",
}
SIZE, TIMES, STIFFER, LEVEL, SEED = 8, 40, 1.5, 0.05, 7


def legs_of(folders: list[Path]) -> list[dict[str, tuple[float, float, float]]]:
    """Of each leg, by measure: estimate, its standard deviation, and the truth."""
    from ankle_legs.curve import own_measures
    from ankle_legs.make import leg

    made = []
    for path in sorted(p for folder in folders for p in folder.glob("*.pkl")):
        kept = pickle.loads(path.read_bytes())
        curve = kept["visits"][0].get("nothing") if isinstance(kept, dict) else None
        if not isinstance(curve, RelaxedCurve):
            continue
        true = own_measures(leg(kept["family"], kept["seed"]).placed(1).ankle(), (-0.5, 0.2))
        rated = {each.measure.name: each for each in rated_measures(curve, (0.0, 10.0))}
        one = {
            name: (rated[name].measure.value, rated[name].total, true[name])
            for name in ASKED
            if rated[name].measure.value is not None and true.get(name) is not None
        }
        if len(one) == len(ASKED):
            made.append(one)
    return made


def claim(name: str, sides: list[list[tuple[float, float, float]]]) -> float:
    """p of `cohort`, asked for this measure, that two groups do not differ."""
    rows = [
        CohortMember(f"{group}{k}", "", group, "", {}, _brought(name, value, sd))
        for group, side in zip("ab", sides, strict=True)
        for k, (value, sd, _) in enumerate(side)
    ]
    return float(pool(rows, [name]).pooled[name].differences["a → b"].p)


def _brought(name: str, value: float, sd: float) -> Quantities:
    quantity = Quantity(name, "Nm/deg", "", "measure", value, sd, sd, 0.0, basis="rest")
    adequate = Adequacy(Grade.ADEQUATE, (), np.nan)
    return Quantities("", FrozenDict(), adequate, (), FrozenDict({name: quantity}))


def counted(legs: list[dict[str, tuple[float, float, float]]]) -> dict[str, Any]:
    """How often each says that groups differ, that do and that do not."""
    random = np.random.default_rng(SEED)
    told = {name: {"false": [0, 0, 0], "found": [0, 0, 0]} for name in ASKED}
    for _ in range(TIMES):
        drawn = random.permutation(len(legs))[: 2 * SIZE]
        for name, counts in told.items():
            own = [legs[k][name] for k in drawn]
            for key, factor in (("false", 1.0), ("found", STIFFER)):
                other = [tuple(factor * each for each in leg) for leg in own[SIZE:]]
                sides = [own[:SIZE], other]
                p = [claim(name, sides)]
                p += [
                    float(
                        ttest_ind(*([leg[k] for leg in side] for side in sides), equal_var=False)[1]
                    )
                    for k in (0, 2)
                ]
                counts[key] = [n + (each < LEVEL) for n, each in zip(counts[key], p, strict=True)]
    return {
        "surae": surae.__version__,
        "date": f"{datetime.now(UTC):%Y-%m-%d}",
        "legs": len(legs),
        "measures": told,
    }


def table(result: dict[str, Any]) -> str:
    """The table in Markdown."""
    lines = [
        f"Two groups of {SIZE} of {result['legs']} virtual legs, drawn {TIMES} times; counted on "
        f"{result['date']} (`python benchmarks/groups.py`). Called different at 5 %:",
        "",
        "| asked beforehand | groups alike: `cohort`, t-test, t-test of the true values | the "
        "second half as stiff again: the same three |",
        "|---|--:|--:|",
    ]
    for name, called in ASKED.items():
        false, found = (
            ", ".join(f"{n}" for n in result["measures"][name][key]) for key in ("false", "found")
        )
        lines.append(f"| {called} | {false} of {TIMES} | {found} of {TIMES} |")
    return "\n".join(lines)


def written(page: str, result: dict[str, Any]) -> str:
    """A page with the table between its marks."""
    begin, end = MARKS
    return f"{page.partition(begin)[0]}{begin}\n{table(result)}\n{end}{page.partition(end)[2]}"


def main() -> None:
    """Count, keep the result, and print the table."""
    parser = argparse.ArgumentParser(description=__doc__)
    parser.add_argument("folders", type=Path, nargs="+", help="where reliability.py keeps curves")
    parser.add_argument("--write", action="store_true", help="write the page from the result")
    given = parser.parse_args()
    result = counted(legs_of(given.folders))
    RESULT.write_text(json.dumps(result, indent=1) + "\n", encoding="utf-8")
    print(table(result))
    if given.write:
        PAGE.write_text(written(PAGE.read_text("utf-8"), result), encoding="utf-8")


if __name__ == "__main__":
    main()
