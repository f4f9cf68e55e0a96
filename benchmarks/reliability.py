"""How small a change of the relaxed leg shows, and how well a measure tells legs apart.

Virtual legs whose truth is hidden (``ankle-legs``), each with three visits of three trials: placed
anew without a change, and placed anew with one. Every pair is compared as `surae.change` does it.
Curves are kept in a folder, so that it goes on where it was stopped; the count is written to
``reliability.json``, and with --write into README.md and the documentation.
"""

import argparse
import json
import math
import pickle
import tempfile
from collections import defaultdict
from datetime import UTC, datetime
from pathlib import Path
from typing import Any

import numpy as np

import surae
from surae.inference.relaxed.build import relaxed_curve
from surae.inference.relaxed.curve import RelaxedCurve
from surae.measures.relaxed_change import rest_change
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
    "torque_rise": "rise of the torque over the range",
    "slow_stiffness@10deg": "stiffness in a slow stretch, 10°",
    "slow_stiffness@0deg": "the same, 0°",
    "passive_stiffness@10deg": "stiffness at rest, 10°",
    "end_stiffness": "stiffness at the end of the range",
    "stiffness_at_torque@10Nm": "stiffness at rest, with 10 Nm",
    "relaxed_share@10s": "part that relaxes within 10 s",
    "end_torque": "torque at the end of the range",
}
#: What clinics know: smallest detectable change and ICC of NeuroFlexor, as published.
BESIDE = (
    "NeuroFlexor, as published: ICC 0.9, smallest detectable change 10.3 N (neural), "
    "3.1 N (elastic), 0.5 N (viscous)"
)


def curves_of(family: str, seed: int, folder: Path) -> dict[str, Any]:
    """Curves of three visits of a leg, made where they are not kept."""
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
            made["visits"].append({"curve": relaxed_curve(inputs)})
    kept.write_bytes(pickle.dumps(made))
    return made


def truths_of(made: dict[str, Any], visit: int) -> list[dict[str, float | None]] | None:
    """True measures before and at a visit, over the range that both moved through."""
    from ankle_legs.curve import own_measures
    from ankle_legs.make import leg

    curves = [made["visits"][v]["curve"] for v in (0, visit)]
    if not all(isinstance(curve, RelaxedCurve) for curve in curves):
        return None
    one = leg(made["family"], made["seed"])
    placed = [one.placed(3 * v + 1) for v in (0, visit)]
    zero = float(np.mean([np.degrees(p.departures[0].zero()) for p in placed]))
    ends = max(c.moved[0] for c in curves) - zero, min(c.moved[1] for c in curves) - zero
    return [own_measures(p.ankle(), tuple(np.radians(ends))) for p in placed]


def counted(legs: list[tuple[str, int]], folder: Path) -> dict[str, Any]:
    """What all pairs of these legs say, by measure."""
    rows: dict[str, list[dict[str, Any]]] = defaultdict(list)
    pairs = withheld = 0
    for family, seed in legs:
        made = curves_of(family, seed, folder)
        for visit in (1, 2):
            truth = truths_of(made, visit)
            if truth is None:
                continue
            pairs += 1
            told = rest_change(*(made["visits"][v]["curve"] for v in (0, visit)), ANGLES)
            withheld += bool(told.doubt)
            for name in SHOWN:
                d = told.differences.get(name)
                true = [each.get(name) for each in truth]
                if d is None or d.difference is None or d.ci95 is None or None in true:
                    continue
                p = math.erfc(abs(d.difference) / d.sd / math.sqrt(2.0))
                rows[name].append(
                    {
                        "changed": made["change"] if visit == 2 else None,
                        "holds": d.ci95[0] <= true[1] - true[0] <= d.ci95[1],
                        "half": 0.5 * (d.ci95[1] - d.ci95[0]),
                        "before": d.before,
                        "true": true[0],
                        "claimed": p < 0.05 and not told.doubt,
                        "judged": not told.doubt,
                    }
                )
    return {
        "surae": surae.__version__,
        "date": f"{datetime.now(UTC):%Y-%m-%d}",
        "legs": len(legs),
        "pairs": pairs,
        "withheld": withheld,
        "measures": {name: _summary(own) for name, own in rows.items()},
    }


def _summary(rows: list[dict[str, Any]]) -> dict[str, Any]:
    """SDC, ICC and claims of one measure."""
    same = [row for row in rows if row["changed"] is None]
    third = [row for row in rows if row["changed"] in ("softer", "stiffer") and row["judged"]]
    sems = [row["half"] / (1.96 * math.sqrt(2.0)) for row in same]
    people = float(np.std([row["true"] for row in same], ddof=1))
    icc = people**2 / (people**2 + float(np.median(sems)) ** 2)
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
    lines = [
        f"{result['pairs']} pairs of visits of {result['legs']} virtual legs, fresh seeds, nobody "
        f"stated the angle's zero; counted once on {result['date']} "
        f"(`python benchmarks/reliability.py`); {result['withheld']} pairs withheld:",
        "",
        "| between two visits of one leg, three trials each | smallest detectable change (SDC) | "
        "ICC | false, asked | found of ± 30 % | intervals that hold |",
        "|---|--:|--:|--:|--:|--:|",
    ]
    for name, called in SHOWN.items():
        own = result["measures"].get(name)
        if own is None:
            continue
        false, found, holds = (f"{a} of {b}" for a, b in (own["false"], own["found"], own["holds"]))
        tissue = "–" if name == "relaxed_share@10s" else found
        lines.append(
            f"| {called} | {own['sdc_percent']:.0f} % | {own['icc']:.2f} ({word_of(own['icc'])}) "
            f"| {false} | {tissue} | {holds} |"
        )
    return "\n".join([*lines, "", f"{BESIDE}."])


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
