"""What came of the fits of the cohort, to be asked by model and protocol."""

from collections.abc import Iterable, Iterator, Mapping
from dataclasses import dataclass
from typing import Any

import numpy as np

from surae.units import FloatArray
from surae_thesis.cohort import members, plan, trials, work
from surae_thesis.cohort.members import ACTIVE_PROTOCOL, PASSIVE_PROTOCOL, CohortSubject
from surae_thesis.section import Context

#: One outcome of `work.fit_job`.
Fit = Mapping[str, Any]


@dataclass(frozen=True, slots=True)
class Point:
    """A number of one recording."""

    subject: str
    repetition: int
    value: float


@dataclass(frozen=True, slots=True)
class Fits:
    """The thesis's fits of a cohort, of one recording each, by label.

    The baselines are mean standard errors of simulations, by label.
    """

    size: plan.Size
    members: tuple[CohortSubject, ...]
    single: Mapping[str, Fit]
    baselines: Mapping[str, Mapping[str, float]]

    def of(self, model: str, protocol: str) -> Iterator[tuple[str, int, Fit]]:
        """Subject, repetition and fit of every recording of a protocol."""
        for label, fit in self.single.items():
            of_model, subject, of_protocol, repetition = label.split()
            if (of_model, of_protocol) == (model, protocol):
                yield subject, int(repetition), fit

    def vaf(self, model: str, protocol: str = ACTIVE_PROTOCOL) -> list[Point]:
        """VAF of every recording [%]."""
        return [
            Point(subject, repetition, fit["vaf"])
            for subject, repetition, fit in self.of(model, protocol)
            if fit["vaf"] is not None
        ]

    def predicted(
        self, model: str, protocol: str = ACTIVE_PROTOCOL, target: str = ""
    ) -> list[Point]:
        """VAF [%] of the other repetitions, or of `target`, as repetition 1 predicts them."""
        return [
            Point(subject, prediction["repetition"], prediction["vaf"])
            for subject, _, fit in self.of(model, protocol)
            for prediction in fit["predicted"]
            if prediction["protocol"] == (target or protocol) and prediction["vaf"] is not None
        ]

    def onto_passive(self, model: str) -> list[Point]:
        """The ramp and hold as predicted from repetition 1 of the multiple holds."""
        return self.predicted(model, target=PASSIVE_PROTOCOL)

    def snsem(self, model: str, protocol: str) -> dict[str, list[float]]:
        """Standard errors over the mean one of the simulations, by free parameter."""
        baseline = self.baselines[f"{model} {protocol}"]
        ratios: dict[str, list[float]] = {}
        for _, _, fit in self.of(model, protocol):
            for name, p in fit["parameters"].items():
                if p["free"]:
                    of_name = ratios.setdefault(name, [])
                    if p["sem"] is not None and name in baseline:
                        of_name.append(p["sem"] / baseline[name])
        return ratios


#: What generates the recordings.
_MADE_BY = (members, trials)


def fitted(context: Context, name: str, jobs: Mapping[str, plan.Settings]) -> dict[str, Fit]:
    """What `work.fit_job` makes of jobs, kept under a name."""
    return context.calls(f"cohort-{name}", work.fit_job, jobs, also=_MADE_BY)


def thesis_fits(context: Context) -> Fits:
    """Fit as the thesis did: every model to every recording alone."""
    size = plan.Size.of(context)
    single = fitted(context, "fits", plan.single_fits(size))
    jobs = plan.baselines(size)
    baselines = context.calls("cohort-baselines", work.baseline_job, jobs, also=_MADE_BY)
    return Fits(size, size.members, single, baselines)


def strengths(context: Context) -> Mapping[str, Mapping[str, float]]:
    """Largest torques by subject, measured and on printed tendons; see `work.strength_job`."""
    jobs = plan.strengths(plan.Size.of(context))
    return context.calls("cohort-strengths", work.strength_job, jobs, also=_MADE_BY)


def fair_fits(context: Context, fits: Fits) -> Mapping[str, Mapping[str, float | None]]:
    """What a fair optimiser makes of the explicit scheme, by subject; see `work.explicit_job`."""
    jobs = {}
    for number, member in enumerate(fits.members[: fits.size.closer]):
        fit = fits.single[f"2.0 {member.id} {ACTIVE_PROTOCOL} 1"]
        if fit["status"] != "failed":
            jobs[member.id] = {
                "seed": fits.size.seed, "member": number, "protocol": ACTIVE_PROTOCOL,
                "rate_hz": plan.EXPLICIT_HZ,
                "implicit": {n: p["value"] for n, p in fit["parameters"].items() if p["free"]},
            }  # fmt: skip
    return context.calls("cohort-fair", work.explicit_job, jobs, also=_MADE_BY)


def values(points: Iterable[Point]) -> FloatArray:
    """The numbers alone."""
    return np.array([point.value for point in points], dtype=np.float64)


def paired(first: Iterable[Point], second: Iterable[Point]) -> FloatArray:
    """Second minus first, of the recordings that are in both."""
    left = {(point.subject, point.repetition): point.value for point in first}
    both = [point for point in second if (point.subject, point.repetition) in left]
    before = np.array([left[point.subject, point.repetition] for point in both])
    return np.asarray(values(both) - before)


def clearly_lower(first: Iterable[Point], second: Iterable[Point]) -> bool:
    """Whether the first mean lies below the second by more than twice the difference's error.

    Subjects count as independent, repetitions of one subject do not: its mean counts once.
    """
    means = [_by_subject(first), _by_subject(second)]
    if min(map(len, means)) < 2:
        return False
    error = np.sqrt(sum(several.var(ddof=1) / len(several) for several in means))
    return bool(means[0].mean() < means[1].mean() - 2.0 * error)


def _by_subject(points: Iterable[Point]) -> FloatArray:
    several: dict[str, list[float]] = {}
    for point in points:
        several.setdefault(point.subject, []).append(point.value)
    return np.array([np.mean(of_subject) for of_subject in several.values()], dtype=np.float64)
