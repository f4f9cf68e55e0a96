"""How much of what is called identified is true, on legs that share no code with surae.

Legs of `legs/`, two trials each, written as CSV files and fitted as anybody would. Run it as

    .venv/bin/python benchmarks/trust.py --families a,b --seeds 11-14 [--changes]

The scorer of `legs/` counts, the worst family first: what is identified and how much of it is true,
intervals that hold the truth, and values called repeatable that the other trial repeats. With
`--joint 3` three trials of other movement are one visit, fitted jointly. With
`--changes` each leg is measured mounted anew and treated as well, and `surae.change` compares all
trials with the first. Measures are counted as parameters are,
apart from them. Families of one letter may be looked at while `auto` is made, l-1 and on not.
"""

import argparse
import csv
import sys
import tempfile
import time
import warnings
from collections import Counter
from collections.abc import Container
from pathlib import Path

import surae

sys.path.insert(0, str(Path(__file__).parents[1] / "legs" / "src"))
from ankle_legs.make import make, truth_of
from ankle_legs.measures import MEASURED_AT
from ankle_legs.score import CHANGES, COLUMNS, change_table, measures_of, names, score, table
from ankle_legs.subject import PARAMETERS

#: Trials that are counted, and those that are compared with the first: of another movement, mounted
#: anew, and treated.
TRIALS, COMPARED = (1, 2), (2, 4, 7)
HEAD = (*COLUMNS, "grade", "repeatable", "repeat_low", "repeat_high", "visit")


def numbers(text: str) -> list[int]:
    """Seeds of a text as 11-14 or 3,5,8."""
    pieces = [part.partition("-") for part in text.split(",")]
    return [n for low, _, high in pieces for n in range(int(low), int(high or low) + 1)]


def kinds(text: str) -> tuple[str, ...]:
    """Kinds of trials of a text as 3 (active) or active,active,passive."""
    return ("active",) * int(text) if text.isdigit() else tuple(text.split(","))


def answers(fit: surae.Fit, known: Container[str]) -> list[list[object]]:
    """What a fit says of the leg's parameters, and of the measures whose truth is known."""
    told = {name: p for name, p in fit.parameters.items() if p.free and name in PARAMETERS}
    told |= {name: m for name, m in fit.measures(angles=MEASURED_AT).items() if name in known}
    return [
        [
            name,
            "" if p.value is None else p.value,
            *(p.ci95 or ("", "")),
            p.verdict,
            fit.adequacy.grade,
            getattr(p, "repeatable", ""),
            *(p.ci95_repeat or ("", "")),
        ]
        for name, p in told.items()
    ]


def identified_without(fit: surae.Fit) -> Counter[str]:
    """Values within 10 %, as they are and with the share of one source of the variance gone."""
    counts: Counter[str] = Counter()
    own = [p for name, p in fit.parameters.items() if p.free and p.ci95 and name in PARAMETERS]
    for source in ("(none)", *{source for p in own for source in p.budget}):
        for p in own:
            low, high = p.ci95
            half = (high - low) / 2 * max(1 - p.budget.get(source, 0.0), 0.0) ** 0.5
            counts[source] += half <= 0.1 * abs(p.value)
    return counts


def write(path: Path, head: tuple[str, ...], rows: list[list[object]]) -> Path:
    """Write a table."""
    with path.open("w", encoding="utf-8", newline="") as file:
        csv.writer(file).writerows([head, *rows])
    return path


def main() -> None:
    """Make legs, fit them, and count."""
    parser = argparse.ArgumentParser(description=__doc__)
    parser.add_argument("--families", default="a,b,c,d,e,f,g,h,i,j,k,p")
    parser.add_argument("--seeds", type=numbers, default=numbers("11-14"), metavar="11-14")
    parser.add_argument("--changes", action="store_true", help="count changes too")
    parser.add_argument("--model", default="auto")
    parser.add_argument("--raw", action="store_true", help="raw EMG at 1024 Hz")
    visits = "visits of at most 3 trials fitted jointly: how many, or of what kind"
    parser.add_argument("--joint", type=kinds, default=(), metavar="N|active,passive…", help=visits)
    parser.add_argument("--trials", type=numbers, default=list(TRIALS), help="of single fits")
    parser.add_argument("--geometry", action="store_true", help="give each leg's own geometry")
    parser.add_argument("--output", type=Path, metavar="DIR", help="keep answers.csv, changes.csv")
    given = parser.parse_args()
    warnings.simplefilter("ignore")
    said: list[list[object]] = []
    compared: list[list[object]] = []
    without: Counter[str] = Counter()
    visit = given.joint or ("active",)
    compare = tuple(n for n in COMPARED if not given.joint or n > len(visit))
    first = (1,) if given.joint else tuple(given.trials)
    trials = sorted({*first, *(compare if given.changes else ())})
    with tempfile.TemporaryDirectory() as temporary:
        folder = given.output or Path(temporary)
        folder.mkdir(parents=True, exist_ok=True)
        for family in given.families.split(","):
            for seed in given.seeds:
                fits = {}
                for trial in trials:
                    known = {"raw": given.raw, "geometry": given.geometry}
                    paths = [
                        make(family, seed, Path(temporary), (trial + i,), kind=kind, **known)[0]
                        for i, kind in enumerate(visit)
                    ]
                    own = (
                        {
                            "geometry": paths[0].parent / "geometry" / "geometry.csv",
                            "geometry_of": "person",
                        }
                        if given.geometry
                        else {}
                    )
                    begin = time.process_time()
                    fits[trial] = surae.fit(paths, model=given.model, quality=(), **own)
                    seconds = time.process_time() - begin
                    print(
                        f"{family}-{seed}, trial {trial}: {seconds:.1f} s of processor, "
                        f"{fits[trial].result.message}",
                        file=sys.stderr,
                        flush=True,
                    )
                for trial in first:
                    known = truth_of(family, seed, trial)["measures"]
                    rows = answers(fits[trial], known)
                    said += [[family, seed, trial, *row, "+".join(visit)] for row in rows]
                    without += identified_without(fits[trial])
                for trial in compare if given.changes else ():
                    told = surae.change(fits[1], fits[trial])
                    compared += [
                        [family, seed, 1, trial, d.name, d.verdict]
                        for d in (*told.measures.values(), *told.parameters.values())
                    ]
                write(folder / "answers.csv", HEAD, said)
                write(folder / "changes.csv", CHANGES, compared)
        path = folder / "answers.csv"
        print(table(score(path, PARAMETERS)))
        print("measures\n" + table(score(path, measures_of(path))))
        print(names(path, measures_of(path)))
        print(
            "within 10 % if a source were known: "
            + ", ".join(f"{s} {n}" for s, n in without.most_common())
        )
        if given.changes:
            print(change_table(folder / "changes.csv"))


if __name__ == "__main__":
    main()
