"""How much of what is called identified is true, on legs of the family that a fit searches.

Virtual legs of `tests/richer_legs.py`, each written as a CSV file and fitted as anybody would,
through the ordinary filters. Run it as

    .venv/bin/python benchmarks/trust.py --legs 60 --set a

Set a has tendons of its own, crosstalk, a delay and a zero; b an axis beside the device's and drift
too; c is foreign to every model of the family. `--trials 3` fits three trials of a leg together.

`--again` measures and fits each leg once more, with other noise, effort, zero and drift, and counts
what is called repeatable: two values of a leg may differ by √((a² + b²)/2), a and b the half-widths
of their two ci95_repeat. `--again anew` puts electrodes and foot on anew, which makes weights of
the EMG other numbers, so that they are not counted. `--varying 0.05` is a leg whose stiffness,
relaxation and strength are not the same in all trials.
"""

import argparse
import sys
import tempfile
import time
import warnings
from collections import Counter
from pathlib import Path

import numpy as np

import surae
from surae.recording import MUSCLES

sys.path.insert(0, str(Path(__file__).parents[1] / "tests"))
from richer_legs import RicherLeg, richer_leg

#: Weights of the EMG, which are other numbers with other electrodes.
WEIGHTS = ("g1", "g2", "g3", "g4")


def trials_of(seed: int, asked: argparse.Namespace, *, again: bool = False) -> list[RicherLeg]:
    """The trials of a leg, or as many more."""
    motion = {
        name: value
        for name in ("profile", "task", "duration", "chirp_amplitude")
        if (value := getattr(asked, name)) is not None
    }
    return [
        richer_leg(
            seed, drifting=asked.set in "bc", foreign=asked.set == "c", noise=asked.noise,
            emg_noise=asked.emg_noise, raw=asked.raw, rate_hz=asked.rate, trial=trial,
            mounting=int(again and asked.again == "anew"), varying=asked.varying, **motion,
        )
        for trial in range(again * asked.trials, (1 + again) * asked.trials)
    ]  # fmt: skip


def fitted(legs: list[RicherLeg], asked: argparse.Namespace) -> surae.Fit:
    """The fit of files of these trials."""
    given: dict = {"model": asked.model}
    if asked.model == "auto":
        given["nuisances"] = asked.nuisances
    muscles = MUSCLES if asked.channels == 4 else ("ta", "sol")
    fixed = {} if asked.channels == 4 else {"g2": 0.0, "g4": 0.0}
    with tempfile.TemporaryDirectory() as folder:
        paths = [Path(folder) / f"{number}.csv" for number in range(len(legs))]
        for path, leg in zip(paths, legs, strict=True):
            leg.write(path, muscles)
        return surae.fit(paths, fixed=fixed, quality=(), **given)


def differences(one: surae.Fit, other: surae.Fit, *, weights: bool) -> dict[str, float]:
    """How far what both call repeatable is apart, in parts of what they allow it to be."""
    apart = {}
    for name, p in one.parameters.items():
        q = other.parameters.get(name)
        if q is None or not (p.free and p.repeatable and q.repeatable):
            continue
        if weights or name not in WEIGHTS:
            a, b = (0.5 * (each.ci95_repeat[1] - each.ci95_repeat[0]) for each in (p, q))
            apart[name] = (p.value - q.value) / float(np.sqrt(0.5 * (a**2 + b**2)))
    return apart


def main() -> None:
    """Count."""
    parser = argparse.ArgumentParser(description=__doc__)
    parser.add_argument("--legs", type=int, default=60)
    parser.add_argument("--first", type=int, default=0, help="seed of the first leg")
    parser.add_argument("--set", choices="abc", default="a")
    parser.add_argument("--trials", type=int, default=1, help="trials of a leg in one joint fit")
    parser.add_argument("--again", choices=("same", "anew"), nargs="?", const="same")
    parser.add_argument("--varying", type=float, default=0.0)
    parser.add_argument("--model", default="auto")
    parser.add_argument("--nuisances", default="all")
    parser.add_argument("--noise", type=float, default=0.03)
    parser.add_argument("--emg-noise", type=float)
    parser.add_argument("--rate", type=float, default=128.0)
    parser.add_argument("--raw", action="store_true", help="raw EMG at 1024 Hz")
    parser.add_argument("--channels", type=int, choices=(2, 4), default=4)
    parser.add_argument("--profile")
    parser.add_argument("--task")
    parser.add_argument("--duration", type=float)
    parser.add_argument("--chirp-amplitude", type=float)
    asked = parser.parse_args()
    warnings.simplefilter("ignore")
    free = claimed = true = 0
    repeats: list[float] = []
    grades: Counter[str] = Counter()
    seconds, away, misses = [], [], Counter()
    for seed in range(asked.first, asked.first + asked.legs):
        legs = trials_of(seed, asked)
        begin = time.process_time()
        fit = fitted(legs, asked)
        seconds.append(time.process_time() - begin)
        truth, said = legs[0].parameters, []
        for name, p in fit.parameters.items():
            if not p.free or (asked.channels == 2 and name == "g3"):
                continue
            free += 1
            if p.sem:
                away.append((p.value - truth[name]) / p.sem)
            if p.verdict == "identified":
                claimed += 1
                hit = p.ci95[0] <= truth[name] <= p.ci95[1]
                true += hit
                if not hit:
                    misses[name] += 1
                    said.append(f"{name} {(p.value - truth[name]) / p.sem:+.1f}")
        if asked.again:
            other = fitted(trials_of(seed, asked, again=True), asked)
            apart = differences(fit, other, weights=asked.again == "same")
            repeats += apart.values()
            said += [f"{name} not repeated" for name, by in apart.items() if abs(by) > 1.0]
        grades[str(fit.adequacy.grade)] += 1
        family = fit.result.family
        groups = family.candidates[0].groups if family else ()
        count = sum(p.verdict == "identified" for p in fit.parameters.values())
        print(seed, fit.result.problem.spec.name, ",".join(groups), fit.adequacy.grade,
              f"r2 {fit.adequacy.r2:.2f}", count, "false:", *said, flush=True)  # fmt: skip
    print(
        f"{asked.legs} legs of set {asked.set}: {100 * claimed / free:.1f} % identified, "
        f"{100 * true / max(claimed, 1):.1f} % of these true ({true} of {claimed}); "
        f"errors {np.sqrt(np.mean(np.square(away))):.2f} times what is told "
        f"(median {np.median(np.abs(away)):.2f}); {dict(grades)}; "
        f"{np.mean(seconds):.1f} s of processor each; missed: {dict(misses)}"
    )
    if repeats:
        held = int(np.sum(np.abs(repeats) <= 1.0))
        print(f"repeatable: {100 * held / len(repeats):.1f} % repeated ({held} of {len(repeats)})")


if __name__ == "__main__":
    main()
