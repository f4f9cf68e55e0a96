"""How often the 95 % intervals hold the truth: Markdown tables for white and correlated noise.

One virtual subject and model 1.0; with --legs one realisation each of many subjects, and model
`auto` with and without the laboratory's nuisances beside it. The EMG is free of noise, so that the
Cramér–Rao bound is that of the torque's noise alone.
"""

import argparse
import sys
import time
from collections.abc import Callable, Mapping, Sequence
from dataclasses import dataclass, replace
from functools import partial

import numpy as np
from scipy.signal import lfilter

import surae
from surae import ModelInputs
from surae.base.frozen import read_only
from surae.base.units import FloatArray
from surae.inference import Verdict, half_width
from surae.protocol import Protocol, generate
from surae.studies import virtual_subject, virtual_trial

#: Makes n samples of torque noise [Nm].
Noise = Callable[[np.random.Generator, int], FloatArray]
#: Removes the noise's correlation and scales it to variance 1, along the last axis; the bound of
#: Cramér and Rao is that of white noise afterwards.
Whiten = Callable[[FloatArray], FloatArray]


@dataclass(frozen=True, slots=True)
class CoverageRow:
    """One parameter over all realisations; errors are parts of the truth."""

    name: str
    n: int  #: Realisations in which it has an interval; the shares of covered ones are of these.
    bias: float  #: Mean of the error over all realisations, and its root mean square.
    rmse: float
    bound: float  #: Least possible standard deviation of an unbiased estimate (Cramér–Rao).
    thesis: float  #: Share of the intervals of equation (34) that hold the truth.
    default: float  #: The same of `ci95`.
    identified: float  #: Share of the realisations in which it is judged identified.

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
    """Fit model 1.0 to one trial without noise under many realisations of its torque's noise."""
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
    bias, rmse = errors.mean(axis=0) / values, np.sqrt(np.mean(errors**2, axis=0)) / values
    rows = [
        CoverageRow(
            name,
            len(held[j]),
            *map(float, (bias[j], rmse[j], bound[j] / values[j])),
            *map(float, np.mean(held[j], axis=0) if held[j] else (np.nan, np.nan)),
            float(identified[j] / realisations),
        )
        for j, name in enumerate(names)
    ]
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


def correlated(rng: np.random.Generator, n: int, *, rho: float, sd: float) -> FloatArray:
    """AR(1) noise of standard deviation `sd`, the same for every ρ."""
    drive = sd * np.sqrt(1 - rho**2) * rng.standard_normal(n)
    return lfilter([1], [1, -rho], drive, zi=[rho * rng.standard_normal() * sd])[0]


def innovations(rows: FloatArray, *, rho: float, sd: float) -> FloatArray:
    """What is new at each sample of rows along the last axis, over its standard deviation."""
    later = (rows[..., 1:] - rho * rows[..., :-1]) / (sd * np.sqrt(1 - rho**2))
    return np.concatenate([rows[..., :1] / sd, later], axis=-1)


#: The fits of `of_legs`: what they are called, and how each is asked for.
ASKED: dict[str, dict[str, str]] = {
    "model 1.0": {"model": "muscle"},
    'auto, nuisances="none"': {"model": "auto", "nuisances": "none"},
    "auto": {"model": "auto"},
}


def of_legs(
    protocol: Protocol, legs: int, part: float, noise: Callable[..., FloatArray], whiten: Whiten
) -> str:
    """Fit many legs of model 1.0 once with each of `ASKED`; count, as a Markdown table.

    `part` is the noise's standard deviation as part of the mean torque; `noise` and `whiten` are of
    standard deviation 1. The table has intervals that are true, of all and of the identified;
    errors over the bound of Cramér and Rao and widths over those of model 1.0, of what that
    identifies.
    """
    motion = generate(protocol)
    true: dict[str, list[bool]] = {name: [] for name in ASKED}
    sure: dict[str, list[bool]] = {name: [] for name in ASKED}
    over: dict[str, list[float]] = {name: [] for name in ASKED}
    wide: dict[str, list[float]] = {name: [] for name in ASKED}
    for leg in range(legs):
        subject = virtual_subject(1000 + leg)
        clean = virtual_trial(subject, motion, noise=0.0)
        assert clean.torque is not None
        sd = part * np.abs(clean.torque).mean()
        rng = np.random.default_rng([leg, 5])
        trial = replace(clean, torque=read_only(clean.torque + sd * noise(rng, clean.n)))
        _, sensitivity = surae.simulate("muscle", subject.parameters, clean, jacobian=True)
        bounds = dict(zip(subject.parameters, _bound(whiten(sensitivity.T) / sd), strict=True))
        fits = {
            name: surae.fit(trial, quality=(), **asked).parameters for name, asked in ASKED.items()
        }
        for name, parameters in fits.items():
            for key, bound in bounds.items():
                p, plain = parameters[key], fits["model 1.0"][key]
                if p.ci95 is None:
                    continue
                true[name].append(p.ci95[0] <= subject.parameters[key] <= p.ci95[1])
                if p.verdict is Verdict.IDENTIFIED:
                    sure[name].append(true[name][-1])
                if plain.verdict is Verdict.IDENTIFIED and plain.ci95 is not None:
                    over[name].append((p.value - subject.parameters[key]) / bound)
                    wide[name].append(np.diff(p.ci95)[0] / np.diff(plain.ci95)[0])
        print(f"leg {leg} is fitted", file=sys.stderr, flush=True)
    lines = [
        "| fit | intervals true | identified true | RMS error / bound | median width / model 1.0 |",
        "|---|--:|--:|--:|--:|",
    ]
    lines += [
        f"| {name} | {np.mean(true[name]):.1%} of {len(true[name])} "
        f"| {np.mean(sure[name]):.1%} of {len(sure[name])} "
        f"| {np.sqrt(np.mean(np.square(over[name]))):.2f} | {np.median(wide[name]):.2f} |"
        for name in ASKED
    ]
    return "\n".join(lines)


def main() -> None:
    parser = argparse.ArgumentParser(description=__doc__)
    parser.add_argument("--legs", type=int, help="that many subjects, one realisation each")
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
    if given.legs is not None:
        for rho in given.rho:
            table = of_legs(
                protocol,
                given.legs,
                given.noise,
                partial(correlated, rho=rho, sd=1.0),
                partial(innovations, rho=rho, sd=1.0),
            )
            print(f"## ρ = {rho:g}, {given.legs} legs\n\n{table}\n", flush=True)
        return
    clean = virtual_trial(subject, generate(protocol), noise=0.0)
    sd = given.noise * np.abs(clean.torque).mean()
    print(
        f"Subject {given.subject}, multiple holds, chirp 0.2 rad, 0.5 Hz/s, part-passive, "
        f"{given.rate:g} Hz, {clean.n} samples; torque noise {sd:.2f} Nm, no EMG noise; "
        f"{given.realisations} realisations.\n"
    )
    for rho in given.rho:
        noise = partial(correlated, rho=rho, sd=sd)
        whiten = partial(innovations, rho=rho, sd=sd)
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
