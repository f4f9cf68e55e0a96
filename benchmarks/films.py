"""What filming buys: how wide intervals are with a film and without, and how often they hold.

Legs of `ankle-legs`, each fitted with model `auto` without its film, with that of the tibialis and
with those of both groups, which drift by 1 to 2 mm. Prints a Markdown table.
"""

import argparse
import json
import tempfile
from collections import defaultdict
from collections.abc import Iterator, Mapping
from pathlib import Path
from typing import Any

import numpy as np

import surae
from surae.measures.leg import elongation
from surae.model.tendon import tendon_curve

LENGTHS = ("l0_tri", "l0_tib", "x0_tri", "x0_tib", "dlt_tri", "dlt_tib")
MAXIMAL = {"tri": 8000.0, "tib": 1400.0}
WAYS = {"no film": (), "tibialis": ("tib",), "both": ("tib", "gm")}


def secant(dlt: float, group: str, most: float) -> float:
    """Stiffness of a tendon between 20 and 80 % of a force [N/mm]."""
    curve = tendon_curve(dlt, 0.3, 4.0, MAXIMAL[group])
    return 6e-4 * most / (elongation(curve, 0.8 * most) - elongation(curve, 0.2 * most))


def numbers(fit: surae.Fit, truth: Mapping[str, Any]) -> Iterator[tuple[str, float, float, float]]:
    """Name, truth, and ends of the interval of each number that has all of them."""
    true = truth["trials"][0]["parameters"]
    for name in LENGTHS:
        ends = fit.parameters[name].ci95
        if ends and true.get(name):
            yield name, true[name], *ends
    told, state = fit.measures(), fit.tendon()
    for row, group in enumerate(("tri", "tib")):
        ends = told[f"tendon_secant_{group}"].ci95
        if ends and true.get(f"dlt_{group}"):
            most = float(np.percentile(state.tendon_force[row], 99.0))
            yield f"tendon_secant_{group}", secant(true[f"dlt_{group}"], group, most), *ends
    ends, seen = told["optimal_fascicle_tib"].ci95, truth["fascicles"]["fascicle_tib"]
    if ends and true.get("l0_tib"):
        yield "optimal_fascicle_tib", 1e3 * seen["scale"] * true["l0_tib"] + seen["zero_mm"], *ends


def main() -> None:
    """Fit the legs that are asked for and print the table."""
    from ankle_legs.make import make

    parser = argparse.ArgumentParser(description=__doc__)
    parser.add_argument("--families", default="a,b,c,d,f,i")
    parser.add_argument("--seeds", default="11,12")
    given = parser.parse_args()
    rows: dict[str, dict[str, list[tuple[float, bool]]]] = defaultdict(lambda: defaultdict(list))
    follows = []
    with tempfile.TemporaryDirectory() as folder:
        for family in given.families.split(","):
            for seed in map(int, given.seeds.split(",")):
                (mapped,) = make(family, seed, Path(folder), film=True)
                truth = json.loads(Path(folder, "truth", f"{family}-{seed}.json").read_text())
                text = mapped.read_text()
                for way, muscles in WAYS.items():
                    parts = [
                        part
                        for part in text.split("[channels.")
                        if not part.startswith("fascicle")
                        or part[9:].startswith(tuple(muscles) or "-")
                    ]
                    mapped.write_text("[channels.".join(parts))
                    fit = surae.fit(mapped, quality=())
                    follows += [q.rmse_mm for r in fit.assessment.recordings for q in r.fascicles]
                    for name, true, low, high in numbers(fit, truth):
                        rows[name][way].append(((high - low) / 2 / true, low <= true <= high))
                print(f"{family}-{seed} done", flush=True)
    print(f"fascicles followed within {np.median(follows):.2f} mm, at most {max(follows):.2f} mm")
    print("| number | " + " | ".join(f"{way}: ± | holds" for way in WAYS) + " |")
    print("|---|" + "---|---|" * len(WAYS))
    for name, ways in rows.items():
        cells = []
        for way in WAYS:
            found = ways.get(way, [])
            wide = f"{100 * np.median([w for w, _ in found]):.0f} %" if found else "–"
            cells += [wide, f"{sum(h for _, h in found)} of {len(found)}"]
        print(f"| {name} | " + " | ".join(cells) + " |")


if __name__ == "__main__":
    main()
