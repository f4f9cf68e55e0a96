"""What came of the fits of the cohort, to be asked by model and protocol."""

from collections.abc import Iterator, Mapping
from dataclasses import dataclass, replace
from typing import Any

import numpy as np

from surae.base.units import FloatArray
from surae_thesis import legs
from surae_thesis.cohort import members, trials, work
from surae_thesis.cohort.members import (
    ACTIVE_PROTOCOL,
    FAST_PROTOCOL,
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
    """How much is computed: subjects, those whose cohort is made otherwise too, and joint fits."""

    seed: int
    subjects: int = SUBJECTS
    others: int = 5
    joint: int = 5
    repetitions: int = REPETITIONS
    baseline: int = 6

    @classmethod
    def of(cls, context: Context) -> "Size":
        """Make the size of the whole cohort, or of fewer fits that check every claim."""
        return cls(context.seed, 2, 1, 1, 2, 2) if context.quick else cls(context.seed)


#: Numbers of recordings, by subject and repetition.
Points = Mapping[tuple[str, int], float]


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

    def drawn(self, rng: np.random.Generator) -> "Fits":
        """As many subjects drawn again from these, with replacement, under numbers of their own."""
        places = rng.integers(len(self.members), size=len(self.members))
        several = [(f"{n}", self.members[place]) for n, place in enumerate(places)]
        single = {name: self.single[who.id] for name, who in several if who.id in self.single}
        members = tuple(replace(who, id=name) for name, who in several)
        return replace(self, members=members, single=single)

    def vaf(self, model: str, protocol: str = ACTIVE_PROTOCOL) -> Points:
        """VAF of every recording [%]."""
        return {(who, r): fit["vaf"] for who, r, fit in self.of(model, protocol) if fit["vaf"]}

    def predicted(self, model: str, protocol: str = ACTIVE_PROTOCOL, target: str = "") -> Points:
        """VAF [%] of the other repetitions, or of `target`, as repetition 1 predicts them."""
        return {
            (who, prediction["repetition"]): prediction["vaf"]
            for who, _, fit in self.of(model, protocol)
            for prediction in fit["predicted"]
            if prediction["protocol"] == (target or protocol) and prediction["vaf"] is not None
        }

    def onto_passive(self, model: str, _: str = "") -> Points:
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


#: How else the cohort may be made: what it was calibrated by, and the protocols.
OTHERWISE: Mapping[str, Mapping[str, Any]] = {
    "EMG gain constant": {"gain": 0.0},
    "usual torque noise": {"quiet": 1.0},
    "the simulations' protocols": {"measured": False},
}


@dataclass(frozen=True, slots=True)
class Ways:
    """Fits of the cohort, of the first subjects of one made otherwise, and by the thesis.

    `few` are the same subjects of the cohort as `otherwise` has. `strain` has the tendon models
    with ε0 as a strain, `explicit` the thesis's integrator and optimiser; `wide` its VAF of model
    2.0 on the multiple holds with finite differences that look past the chatter.
    """

    cohort: Fits
    few: Fits
    otherwise: Mapping[str, Fits]
    explicit: Fits
    wide: Points
    strain: Fits


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
    cohorts: dict[str, tuple[tuple[CohortSubject, ...], Mapping[str, Any]]]
    cohorts = {"": (make_cohort(size.seed, size.subjects), {})} | {
        name: (make_cohort(size.seed, size.others, **made), made)
        for name, made in OTHERWISE.items()
    }
    kept = {"seed": size.seed, "repetitions": size.repetitions}
    jobs = {
        f"{name} {n}": {**kept, "member": n, "made": dict(made), "explicit": not name}
        for name, (who, made) in cohorts.items()
        for n in range(len(who))
    }
    outcomes = context.calls("cohort-fits", work.member_job, jobs, also=MADE_BY)

    def fits(name: str, *ways: str, most: int = SUBJECTS) -> Fits:
        who = cohorts[name][0][:most]
        single = {
            one.id: {
                label.partition(" ")[2]: fit
                for label, fit in outcomes[f"{name} {number}"].items()
                if label.startswith(ways)
            }
            for number, one in enumerate(who)
        }
        return Fits(who, single, baselines)

    return Ways(
        cohort=fits("", "implicit"),
        few=fits("", "implicit", most=size.others),
        otherwise={name: fits(name, "implicit") for name in OTHERWISE},
        explicit=fits("", "explicit", "implicit 1.0"),
        wide=fits("", "wide").vaf("2.0"),
        strain=fits("", "strain", "implicit 1.0"),
    )


def values(points: Points) -> FloatArray:
    """The numbers alone."""
    return np.array(list(points.values()), dtype=np.float64)


def paired(first: Points, second: Points) -> FloatArray:
    """Second minus first, of the recordings that are in both."""
    return np.array([value - first[which] for which, value in second.items() if which in first])


def clearly_lower(first: Points, second: Points) -> bool:
    """Whether the first mean lies below the second by more than twice the difference's error.

    Subjects count as independent, repetitions of one subject do not: its mean counts once.
    """
    means = [_by_subject(first), _by_subject(second)]
    if min(map(len, means)) < 2:
        return False
    error = np.sqrt(sum(several.var(ddof=1) / len(several) for several in means))
    return bool(means[0].mean() < means[1].mean() - 2.0 * error)


def _by_subject(points: Points) -> FloatArray:
    several: dict[str, list[float]] = {}
    for (subject, _), value in points.items():
        several.setdefault(subject, []).append(value)
    return np.array([np.mean(of_subject) for of_subject in several.values()], dtype=np.float64)
