"""How often the 95 % intervals hold the truth: Markdown tables for white and correlated noise.

One virtual subject; the EMG is free of noise, so that the Cramér–Rao bound is that of the torque's
noise alone.
"""

import argparse
import time
from collections.abc import Callable, Mapping, Sequence
from dataclasses import dataclass, replace

import numpy as np
from scipy.signal import lfilter

import surae
from surae import ModelInputs
from surae.assessment import Verdict, half_width
from surae.frozen import read_only
from surae.protocol import Protocol, generate
from surae.studies import virtual_subject, virtual_trial
from surae.units import FloatArray

#: Makes n samples of torque noise [Nm].
Noise = Callable[[np.random.Generator, int], FloatArray]
#: Removes the noise's correlation and scales it to variance 1, along the last axis; the bound of
#: Cramér and Rao is that of white noise afterwards.
Whiten = Callable[[FloatArray], FloatArray]


@dataclass(frozen=True, slots=True)
class CoverageRow:
    """One parameter over all realisations; errors are parts of the truth.

    Attributes
    ----------
    name : str
        The parameter.
    n : int
        Realisations in which it has an interval; the shares of covered ones are of these.
    bias, rmse : float
        Mean and root mean square of the error over all realisations.
    bound : float
        Least possible standard deviation of an unbiased estimate (Cramér–Rao).
    thesis, default : float
        Share of the intervals that hold the truth: those of equation (34), and `ci95`.
    identified : float
        Share of the realisations in which it is judged identified.
    """

    name: str
    n: int
    bias: float
    rmse: float
    bound: float
    thesis: float
    default: float
    identified: float

    @property
    def is_identified(self) -> bool:
        """Whether it is judged identified in most realisations."""
        return self.identified >= 0.5


@dataclass(frozen=True, slots=True)
class Coverage:
    """All parameters, and the share of the realisations whose intervals were robust ones."""

    realisations: int
    robust: float
    rows: tuple[CoverageRow, ...]


def coverage(
    clean: ModelInputs,
    truth: Mapping[str, float],
    noise: Noise,
    whiten: Whiten,
    *,
    realisations: int,
    seed: int = 0,
    starts: int = 1,
) -> Coverage:
    """Fit model 1.0 to one trial under many realisations of its torque's noise.

    Parameters
    ----------
    clean : ModelInputs
        A trial without noise.
    truth : mapping of str to float
        The parameters it was simulated with.
    noise, whiten : callable
        The noise, and what makes it white.
    realisations : int
        How many; each has its own stream of random numbers.
    seed : int
        Seed of all of them.
    starts : int
        Starts of each fit, the first from the default.
    """
    assert clean.torque is not None
    names = tuple(truth)
    values = np.array([truth[name] for name in names])
    _, sensitivity = surae.simulate("muscle", truth, clean, jacobian=True)
    bound = _bound(whiten(sensitivity.T))
    errors = np.empty((realisations, len(names)))
    held: list[list[tuple[bool, bool]]] = [[] for _ in names]
    identified, robust = np.zeros(len(names)), 0
    for number in range(realisations):
        rng = np.random.default_rng([seed, number])
        trial = replace(clean, torque=read_only(clean.torque + noise(rng, clean.n)))
        fit = surae.fit(trial, "muscle", starts=starts, quality=())
        robust += fit.assessment.interval == "robust"
        for j, name in enumerate(names):
            p = fit.parameters[name]
            errors[number, j] = p.value - truth[name]
            identified[j] += p.verdict is Verdict.IDENTIFIED
            if p.ci95 is not None and p.sem is not None:
                thesis = abs(errors[number, j]) <= half_width(p.sem, fit.covariance.dof)
                held[j].append((thesis, p.ci95[0] <= truth[name] <= p.ci95[1]))
    rows = []
    for j, name in enumerate(names):
        shares = np.mean(held[j], axis=0) if held[j] else np.full(2, np.nan)
        rows.append(
            CoverageRow(
                name=name,
                n=len(held[j]),
                bias=float(errors[:, j].mean() / values[j]),
                rmse=float(np.sqrt(np.mean(errors[:, j] ** 2)) / values[j]),
                bound=float(bound[j] / values[j]),
                thesis=float(shares[0]),
                default=float(shares[1]),
                identified=float(identified[j] / realisations),
            )
        )
    return Coverage(realisations, robust / realisations, tuple(rows))


def _bound(rows: FloatArray) -> FloatArray:
    """Standard deviations √diag (JᵀJ)⁻¹ from whitened rows of J, shape (p, n)."""
    scale = np.linalg.norm(rows, axis=1)
    inverse = np.linalg.inv((rows / scale[:, None]) @ (rows / scale[:, None]).T)
    return np.asarray(np.sqrt(np.diag(inverse)) / scale)


def markdown(rows: Sequence[CoverageRow]) -> str:
    """The rows as a Markdown table, in percent of the truth."""
    lines = [
        "| parameter | identified | bias % | RMSE % | RMSE / bound | thesis SEM (34) | default |",
        "|---|--:|--:|--:|--:|--:|--:|",
    ]
    lines += [
        f"| {r.name} | {100 * r.identified:.0f} % | {100 * r.bias:+.2f} | {100 * r.rmse:.2f} "
        f"| {r.rmse / r.bound:.2f} | {100 * r.thesis:.1f} % | {100 * r.default:.1f} % |"
        for r in rows
    ]
    return "\n".join(lines)


def main() -> None:
    parser = argparse.ArgumentParser(description=__doc__)
    parser.add_argument("--realisations", type=int, default=1000)
    parser.add_argument("--subject", type=int, default=1)
    parser.add_argument("--noise", type=float, default=0.05, help="part of the mean torque")
    parser.add_argument("--rate", type=float, default=125.0)
    parser.add_argument("--rho", type=float, nargs="+", default=[0.0, 0.9, 0.98])
    given = parser.parse_args()
    subject = virtual_subject(given.subject)
    protocol = Protocol(
        profile="multiple-holds",
        task="part-passive",
        chirp_amplitude=0.2,
        chirp_rate=0.5,
        rate_hz=given.rate,
    )
    clean = virtual_trial(subject, generate(protocol), noise=0.0)
    sd = given.noise * np.abs(clean.torque).mean()
    print(
        f"Subject {given.subject}, multiple holds, chirp 0.2 rad, 0.5 Hz/s, part-passive, "
        f"{given.rate:g} Hz, {clean.n} samples; torque noise {sd:.2f} Nm, no EMG noise; "
        f"{given.realisations} realisations.\n"
    )
    for rho in given.rho:
        # Noise of the same variance for every ρ.
        drive = sd * np.sqrt(1 - rho**2)

        def noise(rng, n, rho=rho, drive=drive):
            first = rng.standard_normal() * sd
            return lfilter([1], [1, -rho], drive * rng.standard_normal(n), zi=[rho * first])[0]

        def whiten(rows, rho=rho, drive=drive):
            later = (rows[..., 1:] - rho * rows[..., :-1]) / drive
            return np.concatenate([rows[..., :1] / sd, later], axis=-1)

        begin = time.perf_counter()
        result = coverage(clean, subject.parameters, noise, whiten, realisations=given.realisations)
        seconds = time.perf_counter() - begin
        title = "White noise" if rho == 0 else f"AR(1) noise, ρ = {rho:g}"
        print(
            f"## {title}\n\nRobust intervals in {100 * result.robust:.0f} % of the fits; "
            f"{1e3 * seconds / given.realisations:.0f} ms a realisation.\n"
        )
        print(markdown(result.rows) + "\n", flush=True)


if __name__ == "__main__":
    main()
