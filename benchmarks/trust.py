"""How much of what is called identified is true, on legs that share no code with surae.

Legs of `legs/`, two trials each, written as CSV files and fitted as anybody would. Run it as

    .venv/bin/python benchmarks/trust.py --families a,b --seeds 11-14 [--changes]

The scorer of `legs/` counts, the worst family first: what is identified and how much of it is true,
intervals that hold the truth, and values called repeatable that the other trial repeats. With
`--joint 3` three trials of other movement are one visit, fitted jointly. With
`--changes` each leg is measured mounted anew and treated as well, and `surae.change` compares all
trials with the first. Families a to k and p may be looked at while `auto` is made, l-1 to l-20 not.
"""

import argparse
import csv
import sys
import tempfile
import time
import warnings
from collections import Counter
from pathlib import Path

import surae

sys.path.insert(0, str(Path(__file__).parents[1] / "legs" / "src"))
from ankle_legs.make import make
from ankle_legs.score import CHANGES, COLUMNS, change_table, score, table
from ankle_legs.subject import PARAMETERS

#: Trials that are counted, and those that are compared with the first: of another movement, mounted
#: anew, and treated.
TRIALS, COMPARED = (1, 2), (2, 4, 7)
HEAD = (*COLUMNS, "grade", "repeatable", "repeat_low", "repeat_high")


def numbers(text: str) -> list[int]:
    """Seeds of a text as 11-14 or 3,5,8."""
    pieces = [part.partition("-") for part in text.split(",")]
    return [n for low, _, high in pieces for n in range(int(low), int(high or low) + 1)]


def answers(fit: surae.Fit) -> list[list[object]]:
    """What a fit says of the leg's own parameters: rows from the parameter's name on."""
    return [
        [
            name, p.value, *(p.ci95 or ("", "")), p.verdict, fit.adequacy.grade, p.repeatable,
            *(p.ci95_repeat or ("", "")),
        ]
        for name, p in fit.parameters.items()
        if p.free and name in PARAMETERS
    ]  # fmt: skip


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
    visits = "visits of N trials, at most 3, fitted jointly"
    parser.add_argument("--joint", type=int, default=0, metavar="N", help=visits)
    parser.add_argument("--geometry", action="store_true", help="give each leg's own geometry")
    parser.add_argument("--output", type=Path, metavar="DIR", help="keep answers.csv, changes.csv")
    given = parser.parse_args()
    warnings.simplefilter("ignore")
    said: list[list[object]] = []
    compared: list[list[object]] = []
    without: Counter[str] = Counter()
    compare = COMPARED if not given.joint else tuple(n for n in COMPARED if n > given.joint)
    first = (1,) if given.joint else TRIALS
    trials = sorted({*first, *(compare if given.changes else ())})
    with tempfile.TemporaryDirectory() as temporary:
        folder = given.output or Path(temporary)
        folder.mkdir(parents=True, exist_ok=True)
        for family in given.families.split(","):
            for seed in given.seeds:
                fits = {}
                for trial in trials:
                    visit = tuple(range(trial, trial + max(1, given.joint)))
                    known = {"raw": given.raw, "geometry": given.geometry}
                    paths = make(family, seed, Path(temporary), visit, **known)
                    own = {"geometry": paths[0].parent / "geometry" / "geometry.csv",
                           "geometry_of": "person"} if given.geometry else {}  # fmt: skip
                    begin = time.process_time()
                    fits[trial] = surae.fit(paths, model=given.model, quality=(), **own)
                    seconds = time.process_time() - begin
                    print(f"{family}-{seed}, trial {trial}: {seconds:.1f} s of processor, "
                          f"{fits[trial].result.message}", file=sys.stderr, flush=True)  # fmt: skip
                for trial in first:
                    said += [[family, seed, trial, *row] for row in answers(fits[trial])]
                    without += identified_without(fits[trial])
                for trial in compare if given.changes else ():
                    told = surae.change(fits[1], fits[trial])
                    compared += [
                        [family, seed, 1, trial, d.name, d.verdict]
                        for d in (*told.measures.values(), *told.parameters.values())
                    ]
                write(folder / "answers.csv", HEAD, said)
                write(folder / "changes.csv", CHANGES, compared)
        print(table(score(folder / "answers.csv")))
        print("within 10 % if a source were known: "
              + ", ".join(f"{s} {n}" for s, n in without.most_common()))  # fmt: skip
        if given.changes:
            print(change_table(folder / "changes.csv"))


if __name__ == "__main__":
    main()
