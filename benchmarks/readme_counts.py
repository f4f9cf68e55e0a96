"""README's counts of what is claimed, from answers to the challenge: one command renews them.

    .venv/bin/python benchmarks/challenge.py --families va,vb,vc --seeds 3401-3403 --output ANSWERS
    .venv/bin/python benchmarks/readme_counts.py ANSWERS

The first makes one table of answers an entrant; the second counts those there are, keeps the
counts beside this file (`readme_counts.json`, with the version that made them) and writes the rows
between the marks of README. `tests/test_benchmarks.py` holds README to the kept counts, and these
to the product.
"""

import argparse
import json
import re
import sys
from collections.abc import Container, Iterator
from dataclasses import asdict, dataclass
from pathlib import Path

import surae

sys.path.insert(0, str(Path(__file__).parents[1] / "legs" / "src"))
from ankle_legs.score import Count, measures_of, rows, score
from ankle_legs.subject import PARAMETERS

KEPT = Path(__file__).with_suffix(".json")
README = Path(__file__).parents[1] / "README.md"
MARKS = "<!-- counts -->\n", "<!-- end of counts -->\n"
#: How measures begin that no arm and no path changes.
INVARIANTS = (
    *("passive_exponent_", "active_width_", "tendon_rotational_stiffness_"),
    *("torque_gain_", "maximal_torque_", "working_point_"),
)
#: What each row is of: the entrant, its group of values, and what README calls them.
ROWS = {
    ("plain", "parameters"): "a plain SciPy fit of the muscle model",
    ("muscle", "parameters"): "`muscle`: the same model with surae's doubts",
    (
        "auto",
        "parameters",
    ): "**`auto`, the default: parameters** (k, x0, l0, gains …)",
    ("auto", "invariants"): "**`auto`: what no arm changes** (exponent, width, strength, gain …)",
    ("auto", "measures"): "**`auto`: other measures** (stiffness, torque …)",
}


@dataclass(frozen=True)
class Sum:
    """Of one entrant and group of values, over all legs."""

    legs: int  #: That were answered.
    identified: int
    true: int  #: Of the identified.
    hold: int  #: Of all intervals.
    intervals: int


def groups(path: Path) -> Iterator[tuple[str, Container[str]]]:
    """The groups of values of a table of answers."""
    yield "parameters", PARAMETERS
    told = measures_of(path)
    ours = {name for name in told if name.startswith(INVARIANTS)}
    if told:
        yield "invariants", ours
        yield "measures", told - ours


def summed(total: Count) -> Sum:
    """The sum over all families."""
    return Sum(len(total.legs), total.identified, total.true, total.hold, total.intervals)


def counted(folder: Path) -> dict[str, object]:
    """All counts of a folder with answers, and which legs and version they are of."""
    made: dict[str, object] = {"surae": surae.__version__}
    for entrant in dict.fromkeys(entrant for entrant, _ in ROWS):
        path = folder / f"{entrant}.csv"
        if not path.exists():
            continue
        said = rows(path, ("family", "seed"))
        for name in ("family", "seed"):
            made[name] = sorted({row[name] for row in said})
        for group, of in groups(path):
            *families, total = score(path, of)
            made[f"{entrant} {group}"] = asdict(summed(total))
            each = sorted(families, key=lambda count: count.family)
            made[f"{entrant} {group} by family"] = {
                f.family: [f.identified, f.true, f.hold, f.intervals] for f in each
            }
    return made


def table(kept: dict[str, object]) -> str:
    """The rows of README, of what was answered."""
    there = {words: Sum(**kept[" ".join(key)]) for key, words in ROWS.items() if _told(kept, key)}
    legs = max(of.legs for of in there.values())
    head = (
        f"| one trial of each of {legs} legs, families {_ends(kept['family'])}, "
        f"seeds {_ends(kept['seed'])} | identified | of these true | all intervals that hold |\n"
        "|---|--:|--:|--:|\n"
    )
    return head + "".join(_row(words, of) for words, of in there.items())


def _told(kept: dict[str, object], key: tuple[str, str]) -> bool:
    return kept.get(" ".join(key), {"intervals": 0})["intervals"] > 0


def _ends(names: list[str]) -> str:
    return names[0] if len(names) == 1 else f"{names[0]} to {names[-1]}"


def _row(words: str, of: Sum) -> str:
    claimed = f"{_part(of.identified, of.intervals)} ({of.identified} of {of.intervals})"
    true = f"{_part(of.true, of.identified)} ({of.true})" if of.identified else "–"
    return f"| {words} | {claimed} | {true} | {_part(of.hold, of.intervals)} |\n"


def _part(count: int, of: int) -> str:
    return f"{100 * count / of:.0f} %"


def written(text: str, kept: dict[str, object]) -> str:
    """README with the rows of kept counts."""
    between = re.compile(re.escape(MARKS[0]) + ".*?" + re.escape(MARKS[1]), re.S)
    return between.sub(lambda _: MARKS[0] + table(kept) + MARKS[1], text)


def main() -> None:
    """Count, keep, write."""
    parser = argparse.ArgumentParser(description=__doc__)
    parser.add_argument("answers", type=Path, help="folder with a table of answers an entrant")
    given = parser.parse_args()
    kept = counted(given.answers)
    KEPT.write_text(json.dumps(kept, indent=1) + "\n", encoding="utf-8")
    README.write_text(written(README.read_text(encoding="utf-8"), kept), encoding="utf-8")
    print(table(kept))


if __name__ == "__main__":
    main()
