"""What came of the fits of the cohort, to be asked by model and protocol."""

import re
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
_LABEL = re.compile(r"(?P<model>\S+) (?P<subject>\S+) (?P<protocol>\S+) (?P<repetition>\d+)")


@dataclass(frozen=True, slots=True)
class Point:
    """A number of one recording."""

    subject: str
    repetition: int
    value: float


@dataclass(frozen=True, slots=True)
class Fits:
    """The thesis's fits of a cohort.

    Attributes
    ----------
    size : Size
        How many.
    members : tuple of CohortSubject
        The cohort.
    single : mapping of str to Fit
        Fits of one recording each, by label.
    baselines : mapping of str to mapping
        Mean standard errors of simulations, by label.
    """

    size: plan.Size
    members: tuple[CohortSubject, ...]
    single: Mapping[str, Fit]
    baselines: Mapping[str, Mapping[str, float]]

    def of(self, model: str, protocol: str) -> Iterator[tuple[str, int, Fit]]:
        """Subject, repetition and fit of every recording of a protocol."""
        for label, found in self.single.items():
            parts = _LABEL.fullmatch(label)
            if parts and parts["model"] == model and parts["protocol"] == protocol:
                yield parts["subject"], int(parts["repetition"]), found

    def vaf(self, model: str, protocol: str) -> list[Point]:
        """VAF of every recording [%]."""
        return [
            Point(subject, repetition, found["vaf"])
            for subject, repetition, found in self.of(model, protocol)
            if found["vaf"] is not None
        ]

    def predicted(self, model: str, protocol: str, target: str) -> list[Point]:
        """VAF of recordings of `target` that fits of repetition 1 of `protocol` predict [%]."""
        return [
            Point(subject, one["repetition"], one["vaf"])
            for subject, _, found in self.of(model, protocol)
            for one in found["predicted"]
            if one["protocol"] == target and one["vaf"] is not None
        ]

    def snsem(self, model: str, protocol: str) -> dict[str, list[float]]:
        """Standard errors over the mean one of the simulations, by free parameter."""
        baseline = self.baselines[f"{model} {protocol}"]
        found: dict[str, list[float]] = {}
        for _, _, fit in self.of(model, protocol):
            for name, p in fit["parameters"].items():
                if p["free"]:
                    of_name = found.setdefault(name, [])
                    if p["sem"] is not None and name in baseline:
                        of_name.append(p["sem"] / baseline[name])
        return found

    @property
    def failed(self) -> int:
        """Fits that reached no minimum."""
        return sum(found["status"] == "failed" for found in self.single.values())


def thesis_fits(context: Context) -> Fits:
    """Fit as the thesis did: every model to every recording alone."""
    size = plan.Size.of(context)
    return Fits(
        size,
        size.members,
        context.calls("cohort-fits", work.fit_job, plan.single_fits(size), also=MADE_BY),
        context.calls("cohort-baselines", work.baseline_job, plan.baselines(size), also=MADE_BY),
    )


def spared_fits(context: Context) -> Mapping[str, Fit]:
    """Fits to recordings that were spared an imperfection; see `plan.spared_fits`."""
    size = plan.Size.of(context)
    return context.calls("cohort-spared", work.fit_job, plan.spared_fits(size), also=MADE_BY)


def strengths(context: Context) -> Mapping[str, Mapping[str, float]]:
    """Largest torques by subject, measured and on rigid tendons; see `work.strength_job`."""
    jobs = plan.strengths(plan.Size.of(context))
    return context.calls("cohort-strengths", work.strength_job, jobs, also=MADE_BY)


def fair_fits(context: Context, fits: Fits) -> Mapping[str, Mapping[str, float | None]]:
    """What a fair optimiser makes of the explicit scheme, by subject; see `work.explicit_job`."""
    jobs = {}
    for number, member in enumerate(fits.members):
        fit = fits.single.get(f"2.0 {member.id} {ACTIVE_PROTOCOL} 1")
        if fit is not None and fit["status"] != "failed":
            jobs[member.id] = {
                "seed": fits.size.seed,
                "member": number,
                "protocol": ACTIVE_PROTOCOL,
                "rate_hz": plan.EXPLICIT_HZ,
                "implicit": {n: p["value"] for n, p in fit["parameters"].items() if p["free"]},
            }
    return context.calls("cohort-fair", work.explicit_job, jobs, also=MADE_BY)


def other_fits(context: Context, name: str) -> Fits:
    """The muscle-tendon fits of repetition 1 another way: ``"explicit"`` or ``"strain"``."""
    size = plan.Size.of(context)
    jobs = {"explicit": plan.explicit_fits, "strain": plan.strain_fits}[name](size)
    fits = context.calls(f"cohort-{name}", work.fit_job, jobs, also=MADE_BY)
    return Fits(size, size.members, fits, {})


#: What generates the recordings.
MADE_BY = (members, trials)


def values(points: Iterable[Point]) -> FloatArray:
    """The numbers alone."""
    return np.array([one.value for one in points], dtype=np.float64)


def paired(first: Iterable[Point], second: Iterable[Point]) -> FloatArray:
    """Second minus first, of the recordings that are in both."""
    left = {(one.subject, one.repetition): one.value for one in first}
    return np.array(
        [
            one.value - left[one.subject, one.repetition]
            for one in second
            if (one.subject, one.repetition) in left
        ],
        dtype=np.float64,
    )


def clearly_lower(first: Iterable[Point], second: Iterable[Point]) -> bool:
    """Whether the first mean lies below the second by more than twice the difference's error.

    Subjects count as independent, repetitions of one subject do not: its mean counts once.
    """
    means = [_by_subject(first), _by_subject(second)]
    if min(len(one) for one in means) < 2:
        return False
    error = np.sqrt(sum(one.var(ddof=1) / len(one) for one in means))
    return bool(means[0].mean() < means[1].mean() - 2.0 * error)


def _by_subject(points: Iterable[Point]) -> FloatArray:
    found: dict[str, list[float]] = {}
    for one in points:
        found.setdefault(one.subject, []).append(one.value)
    return np.array([np.mean(several) for several in found.values()], dtype=np.float64)


def validation(fits: Fits, model: str, protocol: str) -> list[Point]:
    """Repetitions 2 and 3 as predicted from repetition 1."""
    return fits.predicted(model, protocol, protocol)


def onto_passive(fits: Fits, model: str) -> list[Point]:
    """The ramp and hold as predicted from repetition 1 of the multiple holds."""
    return fits.predicted(model, ACTIVE_PROTOCOL, PASSIVE_PROTOCOL)
