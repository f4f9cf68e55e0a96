"""How the claims on the thesis's subjects are computed and decided (3.2, 4.2), by their names.

Every rule takes the evidence and what its row gives, and returns a `Ruling`; what explains one
takes the evidence and the claim.
"""

from collections.abc import Iterator, Mapping, Sequence
from dataclasses import dataclass, replace
from functools import cache
from statistics import fmean, median

import numpy as np

from surae.units import FloatArray
from surae_thesis.claims import Claim, NotThereError, Ruling, read_claims
from surae_thesis.cohort.members import ACTIVE_PROTOCOL, FAST_PROTOCOL, PASSIVE_PROTOCOL
from surae_thesis.cohort.results import Fit, Fits, Point, clearly_lower, paired, values
from surae_thesis.cohort.trials import REMOVABLE

#: The two groups whose dependency the thesis looks at (4.2.2).
PASSIVE = ("k_tri", "k_tib", "x0_tri", "x0_tib", "tau_rel", "k_rel")
ACTIVE = ("g1", "g2", "g3", "g4", "l0_tri", "l0_tib", "f0", "beta")
PROTOCOLS = {
    PASSIVE_PROTOCOL: "ramp and hold",
    ACTIVE_PROTOCOL: "multiple holds",
    FAST_PROTOCOL: "multi-sine with holds",
}
#: Readings of Table 2's ε0 by the fitted models; the first is that of the printed equations.
METRES, STRAIN = "ε0 in metres", "ε0 as a strain"
#: Smallest change of a mean VAF that is named [percentage points].
_NAMED = 0.05


@dataclass(frozen=True, slots=True)
class Evidence:
    """All fits that findings and their reasons rest on.

    Those that are judged, the thesis's ways; those spared one imperfection; the largest torques of
    the multiple holds by subject, see `work.strength_job`; and the mean absolute difference of the
    spectra of each pair of repetitions [dB].
    """

    fits: Fits
    spared: Mapping[str, Fit]
    strengths: Mapping[str, Mapping[str, float]]
    apart: tuple[float, ...]

    def another_way(self, fits: Fits) -> "Evidence":
        """The same with other fits of the models with tendons."""
        rigid = {k: v for k, v in self.fits.single.items() if k.startswith("1.0 ")}
        return replace(self, fits=replace(self.fits, single={**rigid, **fits.single}))


def gains(evidence: Evidence, model: str, protocol: str) -> dict[str, float]:
    """Mean change of the VAF of repetition 1, spared each imperfection in turn [points]."""
    points = evidence.fits.vaf(model, protocol)
    before = {p.subject: p.value for p in points if p.repetition == 1}
    changes = {}
    for name in (*REMOVABLE, "all"):
        fits = {s: evidence.spared.get(f"{model} {s} {protocol} without {name}") for s in before}
        both = [
            fit["vaf"] - before[subject]
            for subject, fit in fits.items()
            if fit is not None and fit["vaf"] is not None
        ]
        if both:
            changes[name] = fmean(both)
    return changes


def costs(evidence: Evidence, claim: Claim, model: str, protocol: str) -> str:
    """What keeps the VAF of this cohort from 100 %, by refits without one imperfection."""
    changes, beginning = gains(evidence, model, protocol), ""
    if "mean" in claim.given:
        kind, *which = (claim.given[key] for key in ("kind", "model", "protocol"))
        ours, thesis = _mean(_points(evidence.fits, kind, *which)), claim.given["mean"]
        beginning = (
            f"The thesis's mean leaves {_rest(thesis):.1f} % of the torque's root mean square, "
            f"ours {_rest(ours):.1f} %. "
        )
    if not changes:
        return beginning.strip()
    every = changes.pop("all", 0.0)
    named = sorted(((g, n) for n, g in changes.items() if abs(g) >= _NAMED), reverse=True)
    several = "; ".join(f"{REMOVABLE[name]} {gain:+.2f}" for gain, name in named)
    subjects = sum(
        label.startswith(f"{model} ") and label.endswith(f"{protocol} without all")
        for label in evidence.spared
    )
    return (
        f"{beginning}Refits of the {PROTOCOLS[protocol]} of {subjects} subjects, spared one "
        "imperfection at a time, change the mean VAF by (points): "
        f"{several or 'less than 0.05 each'}; spared all, {every:+.2f}."
    )


def _rest(vaf: float) -> float:
    """What a VAF leaves of the torque's root mean square, both in percent."""
    return 10.0 * float(np.sqrt(100.0 - vaf))


def described(points: Sequence[Point], digits: int = 1) -> str:
    """Mean, median and lowest of numbers in percent, and how many."""
    if not points:
        raise NotThereError("No such fit is there.")
    v = values(points)
    return (
        f"{v.mean():.{digits}f} % (median {np.median(v):.{digits}f}, lowest "
        f"{v.min():.{digits}f}, n = {len(v)})"
    )


# Means and orders


@cache
def thesis_means() -> dict[tuple[str, str, str], float]:
    """The thesis's mean VAF [%] of ``"fit"``, ``"validation"`` or ``"onto"``, model, protocol.

    The last is the ramp and hold, predicted from the multiple holds.
    """
    return {
        (given["kind"], given["model"], given["protocol"]): given["mean"]
        for claim in read_claims("subjects", __name__)
        if "mean" in (given := claim.given)
    }


def _points(fits: Fits, kind: str, model: str, protocol: str = ACTIVE_PROTOCOL) -> list[Point]:
    """VAFs of a kind, see `thesis_means`."""
    if kind == "onto":
        return fits.onto_passive(model)
    return {"fit": fits.vaf, "validation": fits.predicted}[kind](model, protocol)


def vaf_level(
    evidence: Evidence, kind: str, model: str, protocol: str, mean: float, within: float
) -> Ruling:
    """How close the cohort's mean is to the thesis's."""
    points = _points(evidence.fits, kind, model, protocol)
    text = described(points)
    return Ruling(abs(_mean(points) - mean) <= within, text)


def _mean(points: Sequence[Point]) -> float:
    return float(values(points).mean())


def change(evidence: Evidence, first: str, second: str, sign: str) -> Ruling:
    """The median change from the first to the second, of the same recordings."""
    several = paired(*(_points(evidence.fits, *which.split()) for which in (first, second)))
    if not len(several):
        raise NotThereError("No such fit is there.")
    middle = float(np.median(several))
    text = (
        f"{middle:+.2f} points (median), {several.mean():+.2f} (mean); negative in "
        f"{100 * float(np.mean(several < 0.0)):.0f} % of {len(several)}"
    )
    holds = {"negative": middle < 0.0, "positive": middle > 0.0}
    return Ruling(holds.get(sign, abs(middle) <= 1.0), text)


def highest(evidence: Evidence, points: list[str]) -> Ruling:
    """Whether the first mean is the highest."""
    groups = [_points(evidence.fits, *which.split()) for which in points]
    text = " against ".join(map(described, groups))
    return Ruling(_mean(groups[0]) > max(map(_mean, groups[1:])), text)


def below(evidence: Evidence, points: list[str], clearly: bool) -> Ruling:
    """Whether the first mean lies below the second, clearly: by more than chance."""
    first, second = (_points(evidence.fits, *which.split()) for which in points)
    text = f"{described(first)} against {described(second)}"
    holds = clearly_lower(first, second) if clearly else _mean(first) < _mean(second)
    return Ruling(holds, text)


def remarked(evidence: Evidence) -> Ruling:
    """Whether low VAFs are those of subjects with a remark."""
    noted = {member.id for member in evidence.fits.members if member.remarks}
    points = evidence.fits.vaf("1.0", ACTIVE_PROTOCOL)
    groups = [[p for p in points if (p.subject in noted) == is_noted] for is_noted in (True, False)]
    text = " against ".join(described(group, 2) for group in groups)
    return Ruling(clearly_lower(*groups), text)


# Standard errors


def _medians(evidence: Evidence, model: str) -> dict[str, float]:
    """Median snSEM over the recordings of the multiple holds, by parameter."""
    snsem = evidence.fits.snsem(model, ACTIVE_PROTOCOL)
    medians = {name: median(several) for name, several in snsem.items() if several}
    if not medians:
        raise NotThereError("No such fit is there.")
    return medians


def residual(evidence: Evidence, _: Claim, model: str) -> str:
    """What a fit leaves of the torque, for comparison with the simulations' noise."""
    rest = median([100.0 - p.value for p in evidence.fits.vaf(model, ACTIVE_PROTOCOL)])
    return (
        "A standard error scales with what the fit leaves: the simulations 5 % noise, these "
        f"fits {_rest(100.0 - rest):.1f} % of the torque's root mean square."
    )


def one_to_ten(evidence: Evidence) -> Ruling:
    """How many snSEM of model 1.0 lie between 1 and 10."""
    several = _medians(evidence, "1.0")
    inside = sum(1.0 <= value <= 10.0 for value in several.values())
    ends = f"{min(several.values()):.2g} to {max(several.values()):.2g}"
    return Ruling(inside > len(several) / 2, f"{inside} of {len(several)}; from {ends}")


def apart_from_others(evidence: Evidence, names: list[str], side: str) -> Ruling:
    """Whether these snSEM of model 1.0 lie above or below the others."""
    several = _medians(evidence, "1.0")
    some = [several[n] for n in names if n in several]
    others = [value for n, value in several.items() if n not in names]
    if not some or not others:
        raise NotThereError("No fit gives these standard errors.")
    a, b = median(some), median(others)
    return Ruling(a > b if side == "above" else a < b, f"{a:.2g} against {b:.2g}")


def about_one(evidence: Evidence) -> Ruling:
    """The median snSEM of model 2.0."""
    middle = median(_medians(evidence, "2.0").values())
    return Ruling(0.5 <= middle <= 2.0, f"{middle:.2g}")


def below_muscle(evidence: Evidence) -> Ruling:
    """The median snSEM of model 2.0 against that of 1.0."""
    a, b = (median(_medians(evidence, model).values()) for model in ("2.0", "1.0"))
    return Ruling(a < b, f"{a:.2g} against {b:.2g}")


def over_tendon(evidence: Evidence, model: str, similar: bool) -> Ruling:
    """The snSEM of a model over those of 2.0: similar in the median, or most of them higher."""
    some, tendon = (_medians(evidence, name) for name in (model, "2.0"))
    both = [some[name] / tendon[name] for name in tendon if name in some]
    share = fmean(ratio > 1.0 for ratio in both)
    text = f"median ratio {median(both):.2g}, higher in {100 * share:.0f} %"
    return Ruling(0.5 <= median(both) <= 2.0 if similar else share > 0.5, text)


def mass_highest(evidence: Evidence, model: str) -> Ruling:
    """The snSEM of the mass against the next."""
    several = _medians(evidence, model)
    if "m" not in several:
        raise NotThereError("No fit tells the mass's standard error.")
    value, name = max((value, name) for name, value in several.items() if name != "m")
    return Ruling(several["m"] > value, f"{several['m']:.1f}; next {name} with {value:.1f}")


# Parts of the torque, the mass, dependencies, repetitions


def _sizes(evidence: Evidence, part: str, model: str = "1.0") -> list[float]:
    fits = [fit["sizes"] for _, _, fit in evidence.fits.of(model, ACTIVE_PROTOCOL)]
    return [sizes[part] for sizes in fits if sizes[part] is not None]


def largest(evidence: Evidence, part: str, low: float, high: float) -> Ruling:
    """The largest size of a part of model 1.0's torque."""
    most = max(_sizes(evidence, part))
    return Ruling(low <= most <= high, f"{most:.1f} Nm")


def strength(evidence: Evidence, _: Claim | None = None) -> str:
    """Which reading of ε0 lets the legs reach the thesis's torques."""
    measured, printed = (
        f"{min(v):.0f} to {max(v):.0f} Nm"
        for key in ("measured", "printed")
        for v in [[sizes[key] for sizes in evidence.strengths.values()]]
    )
    return (
        "Table 2 calls ε0 = 0.04 a strain, and only as a part of the slack length does it let legs "
        f"on compliant tendons reach the thesis's torques: the cohort {measured}, the same legs "
        f"and efforts with ε0 of 0.04 m, as the equations are printed, {printed}."
    )


def inertia(evidence: Evidence) -> Ruling:
    """The inertial torque over the active one."""
    pairs = zip(_sizes(evidence, "inertial"), _sizes(evidence, "neural"), strict=True)
    ratio = [a / b for a, b in pairs if b]
    return Ruling(
        max(ratio) < 0.1, f"{100 * max(ratio):.1f} % at most, {100 * median(ratio):.1f} % (median)"
    )


def peaks(evidence: Evidence, model: str) -> Ruling:
    """How far a model's torque falls short of the measured peaks."""
    short = _sizes(evidence, "short_at_peaks", model)
    share = fmean(value > 0.0 for value in short)
    text = f"short in {100 * share:.0f} % of {len(short)}, by {100 * fmean(short):.1f} % (mean)"
    return Ruling(share > 0.5, text)


def mass_at_bound(evidence: Evidence) -> Ruling:
    """Count the recordings in which the mass ends at its bound."""
    active, passive = (
        fmean(fit["parameters"]["m"]["at_bound"] for _, _, fit in evidence.fits.of("1.0", p))
        for p in (ACTIVE_PROTOCOL, PASSIVE_PROTOCOL)
    )
    text = f"{100 * active:.0f} % of the multiple holds, {100 * passive:.0f} % of the ramp and hold"
    return Ruling(active > 0.5, text)


def mass_by_gravity(evidence: Evidence, _: Claim) -> str:
    """What tells the mass, and what sends it to its bound."""
    bounds = {
        model: [f["parameters"]["m"]["at_bound"] for _, _, f in evidence.fits.of(model, p)]
        for model, p in (("2.0", ACTIVE_PROTOCOL), ("2.1", ACTIVE_PROTOCOL))
    }
    compliant, freed = (100 * fmean(several) if several else 0.0 for several in bounds.values())
    sent = (
        f" By model 2.0 it ends at its bound in {compliant:.0f} % of the multiple holds, "
        f"by 2.1, whose ε0 is free, in {freed:.0f} %: the tendon's strain sends it there."
    )
    masses = [fit["parameters"]["m"] for _, _, fit in evidence.fits.of("1.0", ACTIVE_PROTOCOL)]
    off = median([abs(m["value"] / m["true"] - 1.0) for m in masses if m["value"] is not None])
    return (
        "In the cohort gravity tells the mass: the foot's weight at the ankle is part of the "
        f"model, equation (7), and true of the legs; the estimate is {100 * off:.0f} % off "
        f"(median).{sent if compliant > 50.0 > 2.0 * freed else ''}"
    )


def _correlations(evidence: Evidence) -> Iterator[tuple[list[str], FloatArray]]:
    for _, _, fit in evidence.fits.of("2.0", ACTIVE_PROTOCOL):
        yield fit["correlation"]["names"], np.abs(np.array(fit["correlation"]["matrix"]))


def block(evidence: Evidence) -> Ruling:
    """The largest correlation of passive with active parameters."""
    most = []
    for names, matrix in _correlations(evidence):
        rows, columns = ([names.index(n) for n in g if n in names] for g in (PASSIVE, ACTIVE))
        if rows and columns:
            most.append(float(matrix[np.ix_(rows, columns)].max()))
    if not most:
        raise NotThereError("No fit has both kinds of parameters off their bounds.")
    return Ruling(
        fmean(value > 0.5 for value in most) > 0.5,
        f"{median(most):.2f} (median), {min(most):.2f} to {max(most):.2f}",
    )


def lengths(evidence: Evidence, pairs: list[list[str]]) -> Ruling:
    """The correlation of pairs of parameters."""
    by_pair: dict[str, list[float]] = {}
    for names, matrix in _correlations(evidence):
        for a, b in pairs:
            if a in names and b in names:
                by_pair.setdefault(f"{a}–{b}", []).append(matrix[names.index(a), names.index(b)])
    if not by_pair:
        raise NotThereError("No fit has both parameters off their bounds.")
    middle = {pair: median(several) for pair, several in by_pair.items()}
    text = ", ".join(f"{pair} {value:.2f}" for pair, value in middle.items())
    return Ruling(max(middle.values()) > 0.5, text)


def spectra(evidence: Evidence) -> Ruling:
    """How far the spectra of repetitions are apart."""
    apart = fmean(evidence.apart)
    return Ruling(apart > 1.0, f"{apart:.1f} dB (mean of {len(evidence.apart)} pairs)")
