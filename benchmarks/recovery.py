"""How well the fit finds the parameters of virtual subjects: a Markdown table per protocol.

Bias, spread and honesty of the intervals.
"""

import argparse
import time
from collections.abc import Iterable, Sequence
from dataclasses import dataclass

import numpy as np

import surae
from surae.estimators import STARTS
from surae.inference import Verdict
from surae.protocol import PROFILES, TASKS, Protocol, generate
from surae.studies import POPULATIONS, virtual_subject, virtual_trial

#: An estimate counts as right when it lies within this part of the truth.
CLOSE = 0.10


@dataclass(frozen=True, slots=True)
class Estimate:
    """One parameter of one virtual subject: truth, estimate and what the fit says of it."""

    name: str
    truth: float
    value: float
    sem: float | None
    identified: bool
    covered: bool | None

    @property
    def error(self) -> float:
        """Relative error."""
        return (self.value - self.truth) / self.truth


@dataclass(frozen=True, slots=True)
class Recovery:
    """Fit of one virtual subject: goodness [%], status and every parameter."""

    seed: int
    vaf: float
    status: str
    agreeing: int
    estimates: tuple[Estimate, ...]


@dataclass(frozen=True, slots=True)
class RecoveryRow:
    """One parameter over many subjects; errors and standard errors are parts of the truth."""

    name: str
    n: int  #: Estimates with a standard error; all but the two shares are over these.
    bias: float  #: Mean of the error, and its standard deviation.
    spread: float
    sem: float  #: Root mean square of the standard errors.
    covered: float  #: Share whose 95 % interval holds the truth.
    #: Share judged identified, and share within `CLOSE` of the truth, of all subjects.
    identified: float
    close: float


def recover(
    seed: int,
    protocol: Protocol,
    *,
    population: str = "healthy",
    model: str = "muscle",
    noise: float = 0.05,
    starts: int = STARTS,
) -> Recovery:
    """Simulate a trial of a virtual subject and fit it from the default settings."""
    subject = virtual_subject(seed, population)
    trial = virtual_trial(subject, generate(protocol), model=model, noise=noise)
    fit = surae.fit(trial, model, starts=starts, quality=())
    estimates = []
    for name, truth in subject.parameters.items():
        p = fit.parameters[name]
        covered = None if p.ci95 is None else p.ci95[0] <= truth <= p.ci95[1]
        identified = p.verdict is Verdict.IDENTIFIED
        estimates.append(Estimate(name, truth, p.value, p.trusted_sem, identified, covered))
    return Recovery(seed, fit.vaf, fit.status, fit.result.solution.agreeing, tuple(estimates))


def summarise(recoveries: Iterable[Recovery]) -> list[RecoveryRow]:
    """One row for each parameter."""
    by_name: dict[str, list[Estimate]] = {}
    for recovery in recoveries:
        for estimate in recovery.estimates:
            by_name.setdefault(estimate.name, []).append(estimate)
    return [_row(name, estimates) for name, estimates in by_name.items()]


def _row(name: str, estimates: Sequence[Estimate]) -> RecoveryRow:
    known = [(e.error, e.sem / e.truth, e.covered) for e in estimates if e.sem is not None]
    errors, sems, covered = np.array(known, dtype=float).reshape(-1, 3).T
    some, several = len(known) > 0, len(known) > 1
    return RecoveryRow(
        name=name,
        n=len(known),
        bias=float(errors.mean()) if some else np.nan,
        spread=float(errors.std(ddof=1)) if several else np.nan,
        sem=float(np.sqrt(np.mean(sems**2))) if some else np.nan,
        covered=float(covered.mean()) if some else np.nan,
        identified=float(np.mean([e.identified for e in estimates])),
        close=float(np.mean([abs(e.error) <= CLOSE for e in estimates])),
    )


def markdown(rows: Sequence[RecoveryRow]) -> str:
    """The rows as a Markdown table, in percent of the truth."""
    lines = [
        "| parameter | n | bias % | spread % | SEM % | spread / SEM | in 95 % interval "
        "| identified | within 10 % |",
        "|---|--:|--:|--:|--:|--:|--:|--:|--:|",
    ]
    lines += [
        f"| {r.name} | {r.n} | {100 * r.bias:+.2f} | {100 * r.spread:.2f} | {100 * r.sem:.2f} "
        f"| {r.spread / r.sem:.2f} | {100 * r.covered:.0f} % | {100 * r.identified:.0f} % "
        f"| {100 * r.close:.0f} % |"
        for r in rows
    ]
    return "\n".join(lines)


def main() -> None:
    parser = argparse.ArgumentParser(description=__doc__)
    parser.add_argument("--subjects", type=int, default=50)
    parser.add_argument("--starts", type=int, default=STARTS)
    parser.add_argument("--noise", type=float, default=0.05)
    parser.add_argument("--model", default="muscle")
    parser.add_argument("--population", choices=POPULATIONS, default="healthy")
    parser.add_argument("--task", choices=TASKS, default="part-passive")
    parser.add_argument(
        "--profile", choices=PROFILES, nargs="+", default=["multiple-holds", "multi-sine-holds"]
    )
    parser.add_argument("--rate", type=float, default=256.0)
    given = parser.parse_args()
    for profile in given.profile:
        protocol = Protocol(
            profile=profile,
            task=given.task,
            chirp_amplitude=0.2,
            chirp_rate=0.5,
            rate_hz=given.rate,
        )
        begin = time.perf_counter()
        asked = {name: getattr(given, name) for name in ("population", "model", "noise", "starts")}
        recoveries = [recover(seed, protocol, **asked) for seed in range(given.subjects)]
        seconds = time.perf_counter() - begin
        status = [recovery.status for recovery in recoveries]
        vaf = np.array([recovery.vaf for recovery in recoveries])
        identified = [e for recovery in recoveries for e in recovery.estimates if e.identified]
        close = np.mean([abs(e.error) <= 0.1 for e in identified])
        agreeing = np.mean([recovery.agreeing for recovery in recoveries])
        print(f"## {profile}, chirp 0.2 rad, 0.5 Hz/s, {given.task}, {given.rate:g} Hz\n")
        print(
            f"{given.subjects} {given.population} subjects, model {given.model}, "
            f"{100 * given.noise:g} % noise on EMG and torque, {given.starts} starts "
            f"({agreeing:.1f} agree on average), {seconds / given.subjects:.2f} s per subject.\n"
            f"VAF median {np.median(vaf):.3f} %, lowest {vaf.min():.3f} %; "
            f"{status.count('converged')} converged, "
            f"{status.count('at-bounds')} with a parameter at a bound.\n"
            f"Of {len(identified)} parameters judged identified, {100 * close:.1f} % lie within "
            "10 % of the truth.\n"
        )
        print(markdown(summarise(recoveries)) + "\n")


if __name__ == "__main__":
    main()
