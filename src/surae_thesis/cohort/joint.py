"""The cohort fitted our way: recordings of a subject together, tendons freed, against the truth."""

from collections.abc import Iterator, Mapping, Sequence
from dataclasses import dataclass

import numpy as np

from surae.assessment import half_width
from surae.units import FloatArray
from surae_thesis.cohort import plan
from surae_thesis.cohort.members import ACTIVE_PROTOCOL
from surae_thesis.cohort.results import Fit, Fits, fitted
from surae_thesis.section import Context

#: Ways to fit together, by name: model, and what it frees beside its own parameters.
JOINT: Mapping[str, tuple[str, tuple[str, ...]]] = {
    "joint 1.0": ("1.0", ()),
    "joint 2.0": ("2.0", ()),
    "joint + ε0": ("2.0", ("dlt_tri",)),
    "joint + tendons": ("2.0", ("dlt_tri", "dlt_tib", "pt_tri")),
}
#: The thesis's ways, of one recording of the multiple holds.
SINGLE = {"1.0 alone": "1.0", "2.0 alone": "2.0", "2.1 alone": "2.1"}


@dataclass(frozen=True, slots=True)
class JointEstimate:
    """One parameter of one subject beside the truth, with its standard error, equation (34).

    `white` and `trusted` say whether the truth lies in the 95 % interval of that equation, and in
    ours. None where there is none, as at a bound.
    """

    name: str
    value: float
    true: float
    sem: float | None
    white: bool | None
    trusted: bool | None

    @property
    def error(self) -> float:
        """Size of the relative error."""
        return abs(self.value / self.true - 1.0)


@dataclass(frozen=True, slots=True)
class Way:
    """One way to fit, over all subjects.

    It has the estimates of the parameters whose truth is known; subject and VAF [%] of the last
    repetition, predicted, by protocol; the share of fits whose default start found the best
    minimum; and the VAF of the fitted recordings [%].
    """

    name: str
    estimates: tuple[JointEstimate, ...]
    held_out: Mapping[str, tuple[tuple[str, float], ...]]
    first_start: float
    vaf: tuple[float, ...]

    def errors(self, names: Sequence[str]) -> FloatArray:
        """Relative errors of some parameters, sizes only."""
        return np.array([e.error for e in self.estimates if e.name in names])

    def covered(self, kind: str) -> tuple[float, int]:
        """Share of ``"white"`` or ``"trusted"`` intervals that hold the truth, and their number."""
        known = [holds for e in self.estimates if (holds := getattr(e, kind)) is not None]
        return (float(np.mean(known)) if known else float("nan")), len(known)


def joint_jobs(size: plan.Size) -> dict[str, plan.Settings]:
    """All but the last repetition of all protocols of a subject, which predict the last one."""
    last = size.repetitions
    return {
        f"{name}|{member.id}": plan.fit_settings(
            size, number, [(p, r) for p in member.completed for r in range(1, last)], model,
            free=list(free), predicted=[[p, last] for p in member.completed],
            starts=2,  # one would always be the best of them
        )
        for number, member in enumerate(size.members)
        for name, (model, free) in JOINT.items()
    }  # fmt: skip


def ways(context: Context, fits: Fits) -> dict[str, Way]:
    """Every way to fit, the thesis's first, by name."""
    joint = fitted(context, "joint", joint_jobs(fits.size))
    by_subject = {
        name: {subject: fit for subject, r, fit in fits.of(model, ACTIVE_PROTOCOL) if r == 1}
        for name, model in SINGLE.items()
    } | {name: {m.id: joint[f"{name}|{m.id}"] for m in fits.members} for name in JOINT}
    return {
        name: _way(name, several, fits.size.repetitions)
        for name, several in by_subject.items()
        if several
    }


def _way(name: str, by_subject: Mapping[str, Fit], last: int) -> Way:
    held_out: dict[str, list[tuple[str, float]]] = {}
    for subject, fit in by_subject.items():
        for prediction in fit["predicted"]:
            if prediction["repetition"] == last and prediction["vaf"] is not None:
                held_out.setdefault(prediction["protocol"], []).append((subject, prediction["vaf"]))
    return Way(
        name,
        tuple(estimate for fit in by_subject.values() for estimate in _estimates(fit)),
        {protocol: tuple(several) for protocol, several in held_out.items()},
        float(np.mean([fit["first_start"] for fit in by_subject.values()])),
        tuple(fit["vaf"] for fit in by_subject.values() if fit["vaf"] is not None),
    )


def _estimates(fit: Fit) -> Iterator[JointEstimate]:
    for name, p in fit["parameters"].items():
        if p["free"] and p["true"] is not None and p["value"] is not None:
            white = trusted = None
            if p["sem"] is not None:
                white = abs(p["value"] - p["true"]) <= half_width(p["sem"], fit["n"])
            if p["ci95"] is not None:
                trusted = p["ci95"][0] <= p["true"] <= p["ci95"][1]
            yield JointEstimate(name, p["value"], p["true"], p["sem"], white, trusted)
