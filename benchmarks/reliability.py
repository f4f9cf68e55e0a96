"""How small a change of the relaxed leg shows, and how well a measure tells legs apart.

Virtual legs whose truth is hidden (``ankle-legs``), each with three visits of three trials: placed
anew without a change, and placed anew with one. Every pair is compared as `surae.change` does it,
twice: as nobody stated anything, and as the recipe has it, where at each visit the empty device was
recorded and a goniometer set the angle's zero within 1° (drawn). Curves are kept in a folder, so
that it goes on where it was stopped; the count is written to ``reliability.json``, and with --write
into README.md and the documentation.

    .venv/bin/python benchmarks/reliability.py FOLDER ra:9100 rb:9101 … [--write]
"""

import argparse
import json
import math
import pickle
import sys
import tempfile
from collections import defaultdict
from collections.abc import Iterator
from datetime import UTC, datetime
from pathlib import Path
from typing import Any

import numpy as np

import surae
from surae.inference.relaxed.build import relaxed_curve
from surae.inference.relaxed.context import UNKNOWN, Laboratory
from surae.inference.relaxed.curve import RelaxedCurve
from surae.measures.claims import false_discovery
from surae.measures.relaxed_change import SIZE, RestChange, RestDifference, rest_change
from surae.measures.reliability import word_of
from surae.recording import read
from surae.signals import prepare

HERE = Path(__file__).resolve().parent
RESULT = HERE / "reliability.json"
PAGES = (HERE.parent / "README.md", HERE.parent / "docs" / "how-to" / "before-and-after.md")
BEGIN, END = "<!-- reliability: begin -->", "<!-- reliability: end -->"
ANGLES = (-10.0, 0.0, 10.0)
#: Measures of the table, and what they are called there.
SHOWN = {
    "curve_size": "torque at rest over the whole curve",
    "torque_rise": "rise of the torque over the range",
    "slow_stiffness@10deg": "stiffness in a slow stretch, 10°",
    "slow_stiffness@0deg": "the same, 0°",
    "passive_stiffness@10deg": "stiffness at rest, 10°",
    "end_stiffness": "stiffness at the end of the range",
    "stiffness_at_torque@10Nm": "stiffness at rest, with 10 Nm",
    "relaxed_share@10s": "part that relaxes within 10 s",
    "end_torque": "torque at the end of the range",
}
#: What the legs' changes make of the whole curve [%].
SIZES = {"softer": -30.0, "stiffer": 30.0}
#: Ways of measuring, and how well the angle's zero is known by them [deg]; None: nobody stated it.
WAYS = {"nothing": None, "recipe": 1.0}
#: Level of what was asked beforehand, and of false discoveries.
LEVEL = 0.05
#: What clinics know: smallest detectable change and ICC of NeuroFlexor, as published.
BESIDE = (
    "NeuroFlexor, as published: ICC 0.9, smallest detectable change 10.3 N (neural), "
    "3.1 N (elastic), 0.5 N (viscous)"
)


def curves_of(family: str, seed: int, folder: Path) -> dict[str, Any]:
    """Curves of three visits of a leg by every way, made where they are not kept."""
    from ankle_legs.make import leg, write_csv

    kept = folder / f"{family}-{seed}.pkl"
    if kept.exists():
        return dict(pickle.loads(kept.read_bytes()))
    one = leg(family, seed)
    made: dict[str, Any] = {"family": family, "seed": seed, "change": one.change, "visits": []}
    with tempfile.TemporaryDirectory() as place:
        for visit in range(3):
            inputs = []
            for trial in range(3 * visit + 1, 3 * visit + 4):
                kind, seconds = one.usual(trial)
                path = Path(place) / f"trial-{trial}.csv"
                run = one.record(trial, seconds, kind)
                write_csv(path, one.columns(run, trial), "# emg: envelope\n")
                inputs.append(prepare(read(path)))
            made["visits"].append(
                {way: relaxed_curve(inputs, _known(one, visit, sd)) for way, sd in WAYS.items()}
            )
    kept.write_bytes(pickle.dumps(made))
    return made


def _known(one: Any, visit: int, sd: float | None) -> Laboratory:
    """What a laboratory states of a visit whose zero it sets within `sd` [deg]."""
    if sd is None:
        return UNKNOWN
    read = sd * np.random.default_rng([one.seed, visit, 97]).standard_normal()
    return Laboratory(read - turned(one, visit), sd, plate_known="Untared" not in _handled(one))


def _handled(one: Any) -> set[str]:
    return {type(each).__name__ for each in one.departures}


def turned(one: Any, visit: int) -> float:
    """How much more than the ankle's own angle the device shows at a visit [deg]."""
    return float(np.degrees(one.placed(3 * visit + 1).departures[0].zero()))


def truths_of(made: dict[str, Any], visit: int, way: str) -> list[dict[str, float | None]] | None:
    """True measures before and at a visit, over the range that both moved through."""
    from ankle_legs.curve import own_measures
    from ankle_legs.make import leg

    curves = [made["visits"][v][way] for v in (0, visit)]
    if not all(isinstance(curve, RelaxedCurve) for curve in curves):
        return None
    one = leg(made["family"], made["seed"])
    beside = float(
        np.mean([turned(one, v) + c.zero_deg for v, c in zip((0, visit), curves, strict=True)])
    )
    ends = (
        max(c.moved[0] + c.zero_deg for c in curves) - beside,
        min(c.moved[1] + c.zero_deg for c in curves) - beside,
    )
    places = [one.placed(3 * v + 1) for v in (0, visit)]
    truth = [own_measures(place.ankle(), tuple(np.radians(ends))) for place in places]
    sizes = (0.0, SIZES.get(made["change"], 0.0) if visit == 2 else 0.0)
    return [{**each, SIZE: 100.0 + size} for each, size in zip(truth, sizes, strict=True)]


def counted(legs: list[tuple[str, int]], folder: Path) -> dict[str, Any]:
    """What all pairs of these legs say, by way and measure."""
    made = []
    for family, seed in legs:
        try:
            made.append(curves_of(family, seed, folder))
        except ArithmeticError as error:  # no leg: its departures do not settle
            print(f"{family}:{seed}: {error}", file=sys.stderr)
    return {
        "surae": surae.__version__,
        "date": f"{datetime.now(UTC):%Y-%m-%d}",
        "legs": [f"{leg['family']}:{leg['seed']}" for leg in made],
        "ways": {way: _counted(made, way) for way in WAYS},
    }


def _counted(legs: list[dict[str, Any]], way: str) -> dict[str, Any]:
    """What all pairs say by one way."""
    rows: dict[str, list[dict[str, Any]]] = defaultdict(list)
    pairs = withheld = lacking = 0
    explored = {"unchanged": 0, "with_claim": 0, "claims": 0, "false_claims": 0}
    for leg in legs:
        for visit in (1, 2):
            truth = truths_of(leg, visit, way)
            if truth is None:
                lacking += 1
                continue
            pairs += 1
            told = rest_change(*(leg["visits"][v][way] for v in (0, visit)), ANGLES)
            withheld += bool(told.doubt)
            change = leg["change"] if visit == 2 else None
            for row in _rows(told, truth, change):
                rows[row["name"]].append(row)
            _explore(explored, told, truth, change)
    return {
        "pairs": pairs,
        "without_rest": lacking,
        "withheld": withheld,
        "explored": explored,
        "measures": {name: _summary(own) for name, own in rows.items()},
    }


def _rows(
    told: RestChange, truth: list[dict[str, float | None]], change: str | None
) -> Iterator[dict[str, Any]]:
    """Every measure of a pair that has a difference and a truth."""
    for name, d in told.differences.items():
        true = [each.get(name) for each in truth]
        if name not in SHOWN or d.difference is None or d.ci95 is None or None in true:
            continue
        yield {
            "name": name,
            "changed": change,
            "holds": d.ci95[0] <= true[1] - true[0] <= d.ci95[1],
            "half": 0.5 * (d.ci95[1] - d.ci95[0]),
            "before": d.before or 100.0,
            "true": true[0],
            "claimed": _p(d) < LEVEL and not told.doubt,
            "judged": not told.doubt,
        }


def _p(difference: RestDifference) -> float:
    return math.erfc(abs(difference.difference) / difference.sd / math.sqrt(2.0))


def _explore(
    into: dict[str, int],
    told: RestChange,
    truth: list[dict[str, float | None]],
    change: str | None,
) -> None:
    """Add what a pair claims of which nothing was asked beforehand."""
    judged = {
        name: _p(d)
        for name, d in told.differences.items()
        if d.difference is not None and d.sd is not None and not told.doubt
    }
    claimed = [name for name, p in false_discovery(judged).items() if p < LEVEL]
    into["unchanged"] += change is None
    into["with_claim"] += change is None and bool(claimed)
    into["claims"] += len(claimed)
    for name in claimed:
        before, after = (each.get(name) for each in truth)
        same = before is not None and after is not None and abs(after - before) < 1e-3 * abs(before)
        right = (told.differences[name].difference or 0.0) * (
            (after or 0.0) - (before or 0.0)
        ) > 0.0
        into["false_claims"] += same or (before is not None and after is not None and not right)


def _summary(rows: list[dict[str, Any]]) -> dict[str, Any]:
    """SDC, ICC and claims of one measure."""
    same = [row for row in rows if row["changed"] is None]
    third = [row for row in rows if row["changed"] in ("softer", "stiffer") and row["judged"]]
    sems = [row["half"] / (1.96 * math.sqrt(2.0)) for row in same]
    people = float(np.std([row["true"] for row in same], ddof=1))
    icc = people**2 / (people**2 + float(np.median(sems)) ** 2) if people > 0.0 else None
    judged = [row for row in same if row["judged"]]
    return {
        "sdc_percent": 100.0 * float(np.median([r["half"] / abs(r["before"]) for r in same])),
        "icc": icc,
        "holds": [int(sum(row["holds"] for row in rows)), len(rows)],
        "false": [int(sum(row["claimed"] for row in judged)), len(judged)],
        "found": [int(sum(row["claimed"] for row in third)), len(third)],
    }


def table(result: dict[str, Any]) -> str:
    """The table in Markdown."""
    ways = result["ways"]
    alone, recipe = ways["nothing"], ways["recipe"]
    lines = [
        f"{alone['pairs']} pairs of visits of {len(result['legs'])} virtual legs, fresh seeds; "
        f"counted once on {result['date']} (`python benchmarks/reliability.py`). Nobody stated the "
        f"angle's zero ({alone['withheld']} pairs withheld), or it was set within 1° at each visit "
        f"and the empty device recorded, as the recipe has it ({recipe['withheld']} withheld):",
        "",
        "| between two visits of one leg, three trials each | smallest detectable change (SDC); "
        "by the recipe | ICC | false, asked; by the recipe | found of ± 30 %; by the recipe | "
        "intervals that hold; by the recipe |",
        "|---|--:|--:|--:|--:|--:|",
    ]
    for name, called in SHOWN.items():
        told = [way["measures"].get(name) for way in (alone, recipe)]
        if None in told:
            continue
        false, found, holds = (
            "; ".join("{} of {}".format(*each[key]) for each in told)
            for key in ("false", "found", "holds")
        )
        untouched = name in ("relaxed_share@10s", "stiffness_at_torque@10Nm")
        icc = told[0]["icc"]
        lines.append(
            f"| {called} | {told[0]['sdc_percent']:.0f} %; {told[1]['sdc_percent']:.0f} % | "
            f"{'–' if icc is None else f'{icc:.2f} ({word_of(icc)})'} | {false} | "
            f"{'–' if untouched else found} | {holds} |"
        )
    explored = alone["explored"]
    said = (
        f"Nothing asked beforehand: {explored['with_claim']} of {explored['unchanged']} unchanged "
        f"pairs have any claim; {explored['false_claims']} of {explored['claims']} claims are "
        "false."
    )
    return "\n".join([*lines, "", said, "", f"{BESIDE}."])


def written(page: str, result: dict[str, Any]) -> str:
    """A page with the table between its marks."""
    before, _, rest = page.partition(BEGIN)
    _, _, after = rest.partition(END)
    return f"{before}{BEGIN}\n{table(result)}\n{END}{after}"


def main() -> None:
    """Count, keep the result, and print the table."""
    parser = argparse.ArgumentParser(description=__doc__)
    parser.add_argument("folder", type=Path, nargs="?", help="where curves are kept")
    parser.add_argument("legs", nargs="*", metavar="FAMILY:SEED")
    parser.add_argument("--write", action="store_true", help="write the pages from the result")
    given = parser.parse_args()
    if given.folder is not None:
        given.folder.mkdir(parents=True, exist_ok=True)
        legs = [(f, int(s)) for f, _, s in (each.partition(":") for each in given.legs)]
        result = counted(legs, given.folder)
        RESULT.write_text(json.dumps(result, indent=1) + "\n", encoding="utf-8")
    result = json.loads(RESULT.read_text(encoding="utf-8"))
    print(table(result))
    for page in PAGES if given.write else ():
        page.write_text(written(page.read_text("utf-8"), result), encoding="utf-8")


if __name__ == "__main__":
    main()
