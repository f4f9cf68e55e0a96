"""Why the cohort differs from the thesis's subjects: what refits without one thing say."""

from collections.abc import Mapping
from dataclasses import dataclass
from statistics import fmean

import numpy as np

from surae.reproduction.cohort.results import (
    Fit,
    Fits,
    Point,
    onto_passive,
    paired,
    validation,
    values,
)
from surae.studies.cohort import ACTIVE_PROTOCOL, PASSIVE_PROTOCOL
from surae.studies.cohort_trials import REMOVABLE

#: Smallest change of a mean VAF that is named [percentage points].
_NAMED = 0.05
_WORDS = {PASSIVE_PROTOCOL: "ramp and hold", ACTIVE_PROTOCOL: "multiple holds"}


@dataclass(frozen=True, slots=True)
class Evidence:
    """All fits that findings and their reasons rest on.

    Attributes
    ----------
    fits : Fits
        As the thesis fitted.
    spared : mapping of str to Fit
        Without one imperfection.
    explicit : Fits
        With the thesis's integrator.
    strengths : mapping of str to mapping
        Largest torque of the multiple holds by subject: as measured, and on rigid tendons [Nm].
    replayed : mapping of str to float
        VAF of the thesis's integrator with the parameters of our fits of model 2.0, by subject [%].
    """

    fits: Fits
    spared: Mapping[str, Fit]
    explicit: Fits
    strengths: Mapping[str, Mapping[str, float]]
    replayed: Mapping[str, float]

    def without(self, model: str, protocol: str, name: str) -> dict[str, float]:
        """VAF of repetition 1 by subject, spared an imperfection, or ``"all"`` of them [%]."""
        found = {}
        for member in self.fits.members:
            fit = self.spared.get(f"{model} {member.id} {protocol} without {name}")
            if fit is not None and fit["vaf"] is not None:
                found[member.id] = float(fit["vaf"])
        return found

    def first(self, model: str, protocol: str) -> dict[str, float]:
        """VAF of repetition 1 by subject [%]."""
        return {p.subject: p.value for p in self.fits.vaf(model, protocol) if p.repetition == 1}

    def gains(self, model: str, protocol: str) -> dict[str, float]:
        """Mean change of the VAF of repetition 1, spared each in turn [percentage points]."""
        before = self.first(model, protocol)
        changes = {}
        for name in (*REMOVABLE, "all"):
            after = self.without(model, protocol, name)
            both = [after[subject] - before[subject] for subject in after if subject in before]
            if both:
                changes[name] = fmean(both)
        return changes


def costs(evidence: Evidence, model: str, protocol: str) -> str:
    """What keeps the VAF of this cohort from 100 %, by refits without one imperfection."""
    gains = evidence.gains(model, protocol)
    before = evidence.first(model, protocol)
    if not gains or not before:
        return ""
    every = gains.pop("all", 0.0)
    named = sorted(((g, n) for n, g in gains.items() if abs(g) >= _NAMED), reverse=True)
    several = "; ".join(f"{REMOVABLE[name]} {gain:+.2f}" for gain, name in named)
    mean = fmean(before.values())
    return (
        f"Refits of the {_WORDS[protocol]} spared one imperfection at a time change the mean VAF "
        f"of {mean:.2f} % by (points): {several or 'less than 0.05 each'}; spared all, it is "
        f"{mean + every:.2f} %."
    )


def higher(evidence: Evidence, model: str, protocol: str) -> str:
    """Why a VAF of the cohort lies above the thesis's."""
    known = protocol if protocol in _WORDS else ACTIVE_PROTOCOL
    text = costs(evidence, "1.0" if model == "1.0" else "2.0", known)
    if not text:
        return ""
    return (
        f"{text} All that the cohort has costs only this much: the thesis's recordings hold more "
        "that its models do not describe, and only they could say what."
    )


def integrator(evidence: Evidence, model: str = "2.0") -> str:
    """What the explicit integrator of the thesis does to a muscle-tendon model."""
    ours = evidence.fits.vaf(model, ACTIVE_PROTOCOL)
    theirs = evidence.explicit.vaf(model, ACTIVE_PROTOCOL)
    change = paired(ours, theirs)
    if not len(change):
        return ""
    rigid = paired(evidence.fits.vaf("1.0", ACTIVE_PROTOCOL), theirs)
    held = paired(
        validation(evidence.fits, model, ACTIVE_PROTOCOL),
        validation(evidence.explicit, model, ACTIVE_PROTOCOL),
    )
    text = (
        "The thesis's tendon is integrated explicitly. Fitted to the same recordings in that way "
        f"at 1000 Hz, model {model} has a VAF of {values(theirs).mean():.1f} % on the multiple "
        f"holds ({change.mean():+.1f} points against the implicit integrator, {rigid.mean():+.1f} "
        "against model 1.0)"
    )
    if len(held):
        text += (
            f", and its predictions of the other repetitions change by {held.mean():+.1f} points"
        )
    if not evidence.replayed:
        return f"{text}."
    replayed = fmean(evidence.replayed.values())
    why = cause(replayed, float(values(theirs).mean()), float(values(ours).mean()))
    return (
        f"{text}. The same scheme with the parameters that the implicit fits of 2.0 found has "
        f"{replayed:.1f} %: {why}"
    )


def cause(replayed: float, explicit: float, implicit: float) -> str:
    """What makes explicit fits worse: the search, or the scheme itself.

    Parameters
    ----------
    replayed : float
        VAF of the explicit scheme with the parameters of implicit fits [%].
    explicit, implicit : float
        VAF of fits with either scheme [%].
    """
    if explicit >= implicit:
        return "the explicit scheme costs the fit nothing here."
    if replayed - explicit > 0.5 * (implicit - explicit):
        return (
            "neither the tendon nor the scheme's error costs the fit, but the search over a torque "
            "that is not smooth, which stops in another minimum. The thesis suspects as much "
            "(4.2.2); its own optimiser may stop elsewhere."
        )
    return "the scheme's own error costs the fit, whichever parameters are found."


def explicit_numbers(evidence: Evidence, model: str, protocol: str) -> str:
    """VAF with the thesis's integrator, in a few words; empty where there is none."""
    found = evidence.explicit.vaf(model, protocol)
    if not found:
        return ""
    return f"Fitted with the thesis's explicit integrator at 1000 Hz it is {described(found)}."


def onto_explicit(evidence: Evidence, model: str) -> str:
    """The prediction of the ramp and hold with the thesis's integrator."""
    found = onto_passive(evidence.explicit, model)
    if not found:
        return ""
    return f"With the thesis's explicit integrator the prediction's VAF is {described(found)}."


def described(points: list[Point], digits: int = 1) -> str:
    """Mean, median and lowest of numbers in percent, and how many."""
    all_of_them = values(points)
    if not len(all_of_them):
        return "none"
    return (
        f"{all_of_them.mean():.{digits}f} % (median {np.median(all_of_them):.{digits}f}, lowest "
        f"{all_of_them.min():.{digits}f}, n = {len(all_of_them)})"
    )
