"""The command ``ankle-legs``."""

from __future__ import annotations

import argparse
import sys
from pathlib import Path

from ankle_legs import __version__
from ankle_legs.courses import COURSES
from ankle_legs.laboratory import STEPS, WRONG
from ankle_legs.movement import KINDS


def _trials(text: str) -> tuple[int, ...]:
    if "," not in text:
        return tuple(range(1, int(text) + 1))
    return tuple(int(part) for part in text.split(",") if part)


def _parser() -> argparse.ArgumentParser:
    parser = argparse.ArgumentParser(
        prog="ankle-legs", description="Virtual legs with hidden truth, and a scorer of answers."
    )
    parser.add_argument("--version", action="version", version=__version__)
    commands = parser.add_subparsers(dest="command", required=True)
    make = commands.add_parser("make", help="write recordings of legs, and their truth apart")
    make.add_argument("family", help="a letter of the README's table")
    make.add_argument("seed", nargs="+", type=int)
    make.add_argument("--output", required=True, type=Path, metavar="DIR")
    make.add_argument(
        "--trials",
        type=_trials,
        default=(1,),
        metavar="N|N,N…",
        help="how many, or which: 4 to 6 are mounted anew, 7 to 9 treated (default: 1)",
    )
    make.add_argument(
        "--seconds", type=float, help="a trial's length (default: 35; of relaxed legs 35 to 80)"
    )
    make.add_argument(
        "--kind",
        choices=(*KINDS, *COURSES),
        help="active: with efforts; passive: moved alike, at rest; curve: long holds, at rest; "
        "isometric: eight angles held with efforts; alone: one muscle after another; maximal; "
        "of relaxed legs ramps, bouts, ladder, stretches (default: active, or as the README says)",
    )
    make.add_argument("--raw", action="store_true", help="raw EMG at 1024 Hz")
    make.add_argument("--film", action="store_true", help="filmed fascicles too, and a mapping")
    make.add_argument("--geometry", action="store_true", help="the leg's own arms and lengths too")
    session = commands.add_parser(
        "laboratory", help="write one leg's session of steps, with what the laboratory knows"
    )
    session.add_argument("family")
    session.add_argument("seed", nargs="+", type=int)
    session.add_argument("--output", required=True, type=Path, metavar="DIR")
    steps = f"of {', '.join(STEPS)}, isometric (default: all but the last)"
    session.add_argument("--steps", default=",".join(STEPS), metavar="STEP,STEP…", help=steps)
    session.add_argument("--wrong", metavar="KIND", help=f"what is wrong: {', '.join(WRONG)}")
    session.add_argument("--active", type=int, default=2, help="active trials (default: 2)")
    score = commands.add_parser("score", help="count answers against the truth, worst family first")
    score.add_argument(
        "answers",
        type=Path,
        metavar="ANSWERS.csv|DIR",
        help="a table; of perturbed and stretched legs a folder of FAMILY-SEED.json",
    )
    score.add_argument("--changes", type=Path, metavar="CHANGES.csv", help="pairs of trials")
    return parser


def main(arguments: list[str] | None = None) -> int:
    """Run the command; return its exit code."""
    given = _parser().parse_args(arguments)
    try:
        if given.command == "make":
            from ankle_legs.make import make

            for seed in given.seed:
                paths = make(
                    *(given.family, seed, given.output, given.trials),
                    **{
                        key: getattr(given, key)
                        for key in ("seconds", "kind", "raw", "film", "geometry")
                    },
                )
                print(*paths, sep="\n")
        elif given.command == "laboratory":
            from ankle_legs import laboratory

            for seed in given.seed:
                what = {"wrong": given.wrong, "active": given.active}
                made = laboratory.measure(given.family, seed, given.steps.split(","), **what)
                print(laboratory.write(made, given.output))
        elif given.answers.is_dir():
            from ankle_legs.nerve import score as score_folder

            print(score_folder(given.answers))
        else:
            from ankle_legs.score import change_table, measures_of, score, table
            from ankle_legs.subject import PARAMETERS

            print(table(score(given.answers, PARAMETERS)))
            if others := measures_of(given.answers):
                print("measures\n" + table(score(given.answers, others)))
            if given.changes:
                print(change_table(given.changes))
    except (ValueError, OSError) as error:
        print(f"ankle-legs: {error}", file=sys.stderr)
        return 2
    except ArithmeticError as error:
        print(f"ankle-legs: {error}", file=sys.stderr)
        return 1
    return 0


if __name__ == "__main__":
    sys.exit(main())
