"""What came of the fits of the cohort, to be asked by model and protocol."""

from collections.abc import Iterable, Iterator, Mapping
from dataclasses import dataclass
from typing import Any

import numpy as np

from surae.units import FloatArray
from surae_thesis import legs
from surae_thesis.cohort import members, trials, work
from surae_thesis.cohort.members import (
    ACTIVE_PROTOCOL,
    FAST_PROTOCOL,
    GAIN,
    PASSIVE_PROTOCOL,
    REPETITIONS,
    SUBJECTS,
    CohortSubject,
    make_cohort,
)
from surae_thesis.section import Context

#: One outcome of `work.member_job`.
Fit = Mapping[str, Any]
#: What generates the recordings and fits them.
MADE_BY = (members, trials, legs)


@dataclass(frozen=True, slots=True)
class Size:
    """How much is computed: subjects whose gain wanders, of a constant gain, and joint fits."""

    seed: int
    subjects: int = SUBJECTS
    constant: int = SUBJECTS
    joint: int = 5
    repetitions: int = REPETITIONS
    baseline: int = 6

    @classmethod
    def of(cls, context: Context) -> "Size":
        """Make the size of the whole cohort, or of fewer fits that check every claim."""
        return cls(context.seed, 2, 2, 1, 2, 2) if context.quick else cls(context.seed)


@dataclass(frozen=True, slots=True)
class Point:
    """A number of one recording."""

    subject: str
    repetition: int
    value: float


@dataclass(frozen=True, slots=True)
class Fits:
    """The thesis's fits of a cohort, of one recording each, by model, protocol and repetition.

    `single` has them by subject and label; the baselines are mean standard errors of simulations.
    """

    members: tuple[CohortSubject, ...]
    single: Mapping[str, Mapping[str, Fit]]
    baselines: Mapping[str, Mapping[str, float]]

    def of(self, model: str, protocol: str) -> Iterator[tuple[str, int, Fit]]:
        """Subject, repetition and fit of every recording of a protocol."""
        for subject, fits in self.single.items():
            for label, fit in fits.items():
                of_model, of_protocol, repetition = label.split()
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

    def onto_passive(self, model: str, _: str = "") -> list[Point]:
        """The ramp and hold as predicted from repetition 1 of the multiple holds."""
        return self.predicted(model, target=PASSIVE_PROTOCOL)

    def snsem(self, model: str, protocol: str) -> dict[str, list[float]]:
        """Standard errors over the mean one of the simulations, by free parameter."""
        baseline = self.baselines[f"{model} {protocol}"]
        ratios: dict[str, list[float]] = {}
        for _, _, fit in self.of(model, protocol):
            for name, p in fit["parameters"].items():
                of_name = ratios.setdefault(name, [])
                if p["sem"] is not None and name in baseline:
                    of_name.append(p["sem"] / baseline[name])
        return ratios


@dataclass(frozen=True, slots=True)
class Ways:
    """Fits of the cohort whose gain wanders and of the one whose does not, and by the thesis.

    The latter with the thesis's integrator and optimiser; `wide` has its VAF of model 2.0 on the
    multiple holds with finite differences that look past the chatter, by subject.
    """

    wandering: Fits
    constant: Fits
    explicit: Fits
    wide: Mapping[str, float]


def thesis_fits(context: Context) -> Ways:
    """Fit as the thesis did: every model to every recording alone."""
    size = Size.of(context)
    jobs = {
        f"{m} {p}": {"seed": size.seed, "protocol": p, "model": m, "subjects": size.baseline}
        for p in (ACTIVE_PROTOCOL, FAST_PROTOCOL)
        for m in work.MODELS
        if p == ACTIVE_PROTOCOL or m in ("1.0", "2.0")
    }
    baselines = context.calls("cohort-baselines", work.baseline_job, jobs, also=MADE_BY)
    kept = {"seed": size.seed, "repetitions": size.repetitions}
    made = context.calls(
        "cohort-fits",
        work.member_job,
        {
            f"{name} {n}": {**kept, "member": n, "gain": gain, "explicit": gain > 0.0}
            for name, gain, count in (
                ("wandering", GAIN, size.subjects), ("constant", 0.0, size.constant),
            )
            for n in range(count)
        },
        also=MADE_BY,
    )  # fmt: skip

    def fits(cohort: str, way: str, gain: float, count: int) -> Fits:
        those = make_cohort(size.seed, count, gain)
        single = {
            who.id: {
                label.removeprefix(f"{way} "): fit
                for label, fit in made[f"{cohort} {number}"].items()
                if label.startswith(way)
            }
            for number, who in enumerate(those)
        }
        return Fits(those, single, baselines)

    wandering = fits("wandering", "implicit", GAIN, size.subjects)
    explicit = fits("wandering", "explicit", GAIN, size.subjects)
    rigid = {
        who: {k: f for k, f in of.items() if k.startswith("1.0 ")} | dict(explicit.single[who])
        for who, of in wandering.single.items()
    }
    wide = fits("wandering", "wide", GAIN, size.subjects).vaf("2.0")
    return Ways(
        wandering,
        fits("constant", "implicit", 0.0, size.constant),
        Fits(wandering.members, rigid, baselines),
        {point.subject: point.value for point in wide},
    )


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
