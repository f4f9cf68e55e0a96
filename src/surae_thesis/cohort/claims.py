"""The claims on the thesis's subjects, a row each, and how ours is computed (3.2, 4.2)."""

from collections.abc import Callable, Iterator, Mapping, Sequence
from dataclasses import dataclass, replace
from statistics import fmean, median

import numpy as np

from surae.units import FloatArray
from surae_thesis.claims import INTEGRATOR, Claim, NotThereError, Ruling
from surae_thesis.cohort.members import ACTIVE_PROTOCOL, FAST_PROTOCOL, PASSIVE_PROTOCOL
from surae_thesis.cohort.results import (
    Fit,
    Fits,
    Point,
    clearly_lower,
    paired,
    values,
)
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
#: Views that a claim is judged under: that of model 1.0 is one; of models with tendons the
#: readings of ε0 and the thesis's integrator; of standard errors the reading that has a baseline.
ONE_VIEW = (METRES,)
TENDON_VIEWS = (METRES, STRAIN, INTEGRATOR)


@dataclass(frozen=True, slots=True)
class Evidence:
    """All fits that findings and their reasons rest on.

    Attributes
    ----------
    fits : Fits
        Those that are judged: the thesis's ways.
    spared : mapping of str to Fit
        Without one imperfection.
    strengths : mapping of str to mapping
        Largest torque of the multiple holds by subject [Nm]; see `work.strength_job`.
    apart : tuple of float
        Mean absolute difference of the spectra of each pair of repetitions [dB].
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


def _costs(model: str, protocol: str) -> Callable[[Evidence], str]:
    """What keeps the VAF of this cohort from 100 %, by refits without one imperfection."""

    def why(evidence: Evidence) -> str:
        changes = gains(evidence, model, protocol)
        if not changes:
            return ""
        every = changes.pop("all", 0.0)
        named = sorted(((g, n) for n, g in changes.items() if abs(g) >= _NAMED), reverse=True)
        several = "; ".join(f"{REMOVABLE[name]} {gain:+.2f}" for gain, name in named)
        return (
            f"Refits of the {PROTOCOLS[protocol]} spared one imperfection at a time change the "
            f"mean VAF by (points): {several or 'less than 0.05 each'}; spared all, {every:+.2f}."
        )

    return why


def described(points: Sequence[Point], digits: int = 1) -> str:
    """Mean, median and lowest of numbers in percent, and how many."""
    if not points:
        raise NotThereError("No such fit is there.")
    v = values(points)
    return (
        f"{v.mean():.{digits}f} % (median {np.median(v):.{digits}f}, lowest "
        f"{v.min():.{digits}f}, n = {len(v)})"
    )


# Means


@dataclass(frozen=True, slots=True)
class Level:
    """A mean VAF of the thesis [%] of ``"fit"``, ``"validation"`` or ``"onto"``; it holds within.

    The last is the ramp and hold, predicted from the multiple holds.
    """

    kind: str
    model: str
    protocol: str
    mean: float
    more: str
    source: str

    @property
    def figure(self) -> str:
        """Name of the figure."""
        return f"figure-{self.source.split('Figure ')[1]}"

    @property
    def within(self) -> float:
        """By how much a mean may differ [points]."""
        return 5.0 if self.kind != "fit" else 0.5 if self.protocol == PASSIVE_PROTOCOL else 3.0

    def points(self, fits: Fits) -> list[Point]:
        """Ours."""
        if self.kind == "onto":
            return fits.onto_passive(self.model)
        return {"fit": fits.vaf, "validation": fits.predicted}[self.kind](self.model, self.protocol)


LEVELS = (
    Level("fit", "1.0", PASSIVE_PROTOCOL, 99.9, "", "3.2.1, Figure 17"),
    Level("fit", "1.0", ACTIVE_PROTOCOL, 95.0, "; ≥ 90", "3.2.1, Figure 17"),
    Level("fit", "1.0", FAST_PROTOCOL, 93.0, "; down to 85", "3.2.1, Figure 17"),
    Level("fit", "2.0", PASSIVE_PROTOCOL, 99.6, "; all > 99", "3.2.2, Figure 23"),
    Level("fit", "2.0", ACTIVE_PROTOCOL, 90.0, "; down to 76", "3.2.2, Figure 23"),
    Level("fit", "2.0", FAST_PROTOCOL, 93.0, "; down to 87", "3.2.2, Figure 23"),
    Level("fit", "2.1", ACTIVE_PROTOCOL, 94.3, "", "3.2.4, Figure 32"),
    Level("fit", "2.2", ACTIVE_PROTOCOL, 91.7, "", "3.2.5, Figure 32"),
    Level("validation", "1.0", ACTIVE_PROTOCOL, 90.4, "; lowest 68", "3.2.3, Figure 29"),
    Level("validation", "1.0", FAST_PROTOCOL, 83.1, "; lowest 50", "3.2.3, Figure 29"),
    Level("validation", "2.0", ACTIVE_PROTOCOL, 82.6, "; lowest 59", "3.2.3, Figure 29"),
    Level("validation", "2.0", FAST_PROTOCOL, 82.0, "; lowest 51", "3.2.3, Figure 29"),
    Level("validation", "2.1", ACTIVE_PROTOCOL, 88.5, "; lowest 70", "3.2.4, Figure 35"),
    Level("validation", "2.2", ACTIVE_PROTOCOL, 85.4, "; lowest 55", "3.2.5, Figure 35"),
    Level("onto", "1.0", PASSIVE_PROTOCOL, 94.0, "", "3.2.3, Figure 30"),
    Level("onto", "2.0", PASSIVE_PROTOCOL, 90.0, "", "3.2.3, Figure 30"),
)
_LEVEL_TEXT = {
    "fit": "VAF of model {0} on the {1}.",
    "validation": "VAF of repetitions 2 and 3 of the {1}, predicted by model {0} from 1.",
    "onto": "VAF of the {1} predicted by model {0} from the multiple holds.",
}


def thesis_mean(kind: str, model: str, protocol: str) -> float | None:
    """The thesis's mean VAF; None if it has none."""
    where = (kind, model, protocol)
    return next((x.mean for x in LEVELS if (x.kind, x.model, x.protocol) == where), None)


def _level(level: Level) -> Claim[Evidence]:
    def ours(evidence: Evidence) -> Ruling:
        points = level.points(evidence.fits)
        text = described(points)
        return Ruling(abs(float(values(points).mean()) - level.mean) <= level.within, text)

    return Claim(
        id=f"{level.kind}-{level.model.replace('.', '-')}-{level.protocol}",
        source=level.source,
        statement=_LEVEL_TEXT[level.kind].format(level.model, PROTOCOLS[level.protocol]),
        number=f"mean {level.mean:g} %{level.more}",
        rule=f"The cohort's mean lies within {level.within:g} points of {level.mean:g} %.",
        ours=ours,
        why=_costs("1.0" if level.model == "1.0" else "2.0",
                   ACTIVE_PROTOCOL if level.protocol == FAST_PROTOCOL else level.protocol),
        figure=level.figure,
        views=ONE_VIEW if level.model == "1.0" else TENDON_VIEWS,
    )  # fmt: skip


# Orders

#: Points of two models or protocols, the second compared with the first.
_Points = Callable[[Fits], list[Point]]


def _fit(model: str, protocol: str = ACTIVE_PROTOCOL) -> _Points:
    return lambda fits: fits.vaf(model, protocol)


def _held(model: str, protocol: str = ACTIVE_PROTOCOL) -> _Points:
    return lambda fits: fits.predicted(model, protocol)


def _change(
    first: _Points, second: _Points, holds: Callable[[float], bool]
) -> Callable[[Evidence], Ruling]:
    """A rule on the median change from the first to the second, of the same recordings."""

    def ours(evidence: Evidence) -> Ruling:
        change = paired(first(evidence.fits), second(evidence.fits))
        if not len(change):
            raise NotThereError("No such fit is there.")
        middle = float(np.median(change))
        text = (
            f"{middle:+.2f} points (median), {change.mean():+.2f} (mean); negative in "
            f"{100 * float(np.mean(change < 0.0)):.0f} % of {len(change)}"
        )
        return Ruling(holds(middle), text)

    return ours


def _ordered(rule: Callable[..., bool], *points: _Points) -> Callable[[Evidence], Ruling]:
    """A rule on several groups of numbers."""

    def ours(evidence: Evidence) -> Ruling:
        groups = [of(evidence.fits) for of in points]
        text = " against ".join(described(group) for group in groups)
        return Ruling(bool(rule(*groups)), text)

    return ours


def _mean(points: Sequence[Point]) -> float:
    return float(values(points).mean())


def _remarked(evidence: Evidence) -> Ruling:
    """Whether low VAFs are those of subjects with a remark."""
    noted = {member.id for member in evidence.fits.members if member.remarks}
    points = evidence.fits.vaf("1.0", ACTIVE_PROTOCOL)
    groups = [[p for p in points if (p.subject in noted) == is_noted] for is_noted in (True, False)]
    text = " against ".join(described(group, 2) for group in groups)
    return Ruling(clearly_lower(*groups), text)


# Standard errors, parts of the torque, dependencies


def _medians(fits: Fits, model: str) -> dict[str, float]:
    """Median snSEM over the recordings of the multiple holds, by parameter."""
    snsem = fits.snsem(model, ACTIVE_PROTOCOL)
    medians = {name: median(several) for name, several in snsem.items() if several}
    if not medians:
        raise NotThereError("No such fit is there.")
    return medians


def _left(model: str) -> Callable[[Evidence], str]:
    """What a fit leaves of the torque, for comparison with the simulations' noise."""

    def why(evidence: Evidence) -> str:
        rest = median([100.0 - p.value for p in evidence.fits.vaf(model, ACTIVE_PROTOCOL)])
        return (
            "A standard error scales with what the fit leaves: the simulations 5 % noise, these "
            f"fits {10.0 * float(np.sqrt(rest)):.1f} % of the torque's root mean square."
        )

    return why


def _one_to_ten(evidence: Evidence) -> Ruling:
    several = _medians(evidence.fits, "1.0")
    inside = sum(1.0 <= value <= 10.0 for value in several.values())
    ends = f"{min(several.values()):.2g} to {max(several.values()):.2g}"
    return Ruling(inside > len(several) / 2, f"{inside} of {len(several)}; from {ends}")


def _group(
    group: Sequence[str], holds: Callable[[float, float], bool]
) -> Callable[[Evidence], Ruling]:
    def ours(evidence: Evidence) -> Ruling:
        several = _medians(evidence.fits, "1.0")
        some = [several[n] for n in group if n in several]
        others = [value for n, value in several.items() if n not in group]
        if not some or not others:
            raise NotThereError("No fit gives these standard errors.")
        text = f"{median(some):.2g} against {median(others):.2g}"
        return Ruling(holds(median(some), median(others)), text)

    return ours


def _about_one(evidence: Evidence) -> Ruling:
    middle = median(_medians(evidence.fits, "2.0").values())
    return Ruling(0.5 <= middle <= 2.0, f"{middle:.2g}")


def _below_muscle(evidence: Evidence) -> Ruling:
    a, b = (median(_medians(evidence.fits, model).values()) for model in ("2.0", "1.0"))
    return Ruling(a < b, f"{a:.2g} against {b:.2g}")


def _ratio(model: str, holds: Callable[[float, float], bool]) -> Callable[[Evidence], Ruling]:
    """A rule on the median ratio to the snSEM of 2.0, and on the share of those that are higher."""

    def ours(evidence: Evidence) -> Ruling:
        some, tendon = (_medians(evidence.fits, name) for name in (model, "2.0"))
        both = [some[name] / tendon[name] for name in tendon if name in some]
        share = fmean(ratio > 1.0 for ratio in both)
        text = f"median ratio {median(both):.2g}, higher in {100 * share:.0f} %"
        return Ruling(holds(median(both), share), text)

    return ours


def _mass_highest(model: str) -> Callable[[Evidence], Ruling]:
    def ours(evidence: Evidence) -> Ruling:
        several = _medians(evidence.fits, model)
        if "m" not in several:
            raise NotThereError("No fit tells the mass's standard error.")
        value, name = max((value, name) for name, value in several.items() if name != "m")
        return Ruling(several["m"] > value, f"{several['m']:.1f}; next {name} with {value:.1f}")

    return ours


def _sizes(evidence: Evidence, part: str, model: str = "1.0") -> list[float]:
    fits = [fit["sizes"] for _, _, fit in evidence.fits.of(model, ACTIVE_PROTOCOL)]
    return [sizes[part] for sizes in fits if sizes[part] is not None]


def _largest(part: str, low: float, high: float) -> Callable[[Evidence], Ruling]:
    def ours(evidence: Evidence) -> Ruling:
        most = max(_sizes(evidence, part))
        return Ruling(low <= most <= high, f"{most:.1f} Nm")

    return ours


def strength(evidence: Evidence) -> str:
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


def _inertia(evidence: Evidence) -> Ruling:
    pairs = zip(_sizes(evidence, "inertial"), _sizes(evidence, "neural"), strict=True)
    ratio = [a / b for a, b in pairs if b]
    return Ruling(
        max(ratio) < 0.1, f"{100 * max(ratio):.1f} % at most, {100 * median(ratio):.1f} % (median)"
    )


def _short(model: str) -> Callable[[Evidence], Ruling]:
    def ours(evidence: Evidence) -> Ruling:
        short = _sizes(evidence, "short_at_peaks", model)
        share = fmean(value > 0.0 for value in short)
        text = f"short in {100 * share:.0f} % of {len(short)}, by {100 * fmean(short):.1f} % (mean)"
        return Ruling(share > 0.5, text)

    return ours


def _mass(evidence: Evidence) -> Ruling:
    bound = {
        p: fmean(fit["parameters"]["m"]["at_bound"] for _, _, fit in evidence.fits.of("1.0", p))
        for p in (ACTIVE_PROTOCOL, PASSIVE_PROTOCOL)
    }
    active, passive = bound.values()
    text = f"{100 * active:.0f} % of the multiple holds, {100 * passive:.0f} % of the ramp and hold"
    return Ruling(active > 0.5, text)


def _mass_why(evidence: Evidence) -> str:
    masses = [fit["parameters"]["m"] for _, _, fit in evidence.fits.of("1.0", ACTIVE_PROTOCOL)]
    off = median([abs(m["value"] / m["true"] - 1.0) for m in masses if m["value"] is not None])
    return (
        "In the cohort gravity tells the mass: the foot's weight at the ankle is part of the "
        f"model, equation (7), and true of the legs; the estimate is {100 * off:.0f} % off "
        "(median). What the thesis's bounds put in doubt is that equation (7) describes the foot."
    )


def _pairs(evidence: Evidence) -> Iterator[tuple[list[str], FloatArray]]:
    for _, _, fit in evidence.fits.of("2.0", ACTIVE_PROTOCOL):
        yield fit["correlation"]["names"], np.abs(np.array(fit["correlation"]["matrix"]))


def _block(evidence: Evidence) -> Ruling:
    largest = []
    for names, matrix in _pairs(evidence):
        rows, columns = ([names.index(n) for n in g if n in names] for g in (PASSIVE, ACTIVE))
        if rows and columns:
            largest.append(float(matrix[np.ix_(rows, columns)].max()))
    if not largest:
        raise NotThereError("No fit has both kinds of parameters off their bounds.")
    return Ruling(
        fmean(value > 0.5 for value in largest) > 0.5,
        f"{median(largest):.2f} (median), {min(largest):.2f} to {max(largest):.2f}",
    )


def _lengths(evidence: Evidence) -> Ruling:
    pairs = [("l0_tri", "k_tri"), ("l0_tri", "x0_tri"), ("l0_tib", "k_tib"), ("l0_tib", "x0_tib")]
    said: dict[str, list[float]] = {}
    for names, matrix in _pairs(evidence):
        for a, b in pairs:
            if a in names and b in names:
                said.setdefault(f"{a}–{b}", []).append(matrix[names.index(a), names.index(b)])
    if not said:
        raise NotThereError("No fit has both parameters off their bounds.")
    middle = {pair: median(several) for pair, several in said.items()}
    text = ", ".join(f"{pair} {value:.2f}" for pair, value in middle.items())
    return Ruling(max(middle.values()) > 0.5, text)


def _spectra(evidence: Evidence) -> Ruling:
    apart = fmean(evidence.apart)
    return Ruling(apart > 1.0, f"{apart:.1f} dB (mean of {len(evidence.apart)} pairs)")


_H = "Multiple holds: "
_MEDIAN = "The median over recordings of {} is {}."
_PREDICTED = "The median over predictions of {} is {}."
_SE = "by more than twice the standard error"

_ORDERS: tuple[Claim[Evidence], ...] = (
    Claim("passive-followed-best", "3.2.1, Figure 17",
        "Model 1.0 follows the passive ramp and hold better than the active protocols.",
        "99.9 % over 95 and 93 %", "The mean VAF of the ramp and hold is the highest of the three.",
        _ordered(lambda a, b, c: _mean(a) > max(_mean(b), _mean(c)), _fit("1.0", PASSIVE_PROTOCOL),
                 _fit("1.0"), _fit("1.0", FAST_PROTOCOL)),
        _costs("1.0", PASSIVE_PROTOCOL), "figure-17", views=ONE_VIEW),
    Claim("tendon-fits-worse", "3.2.2, Figures 17 and 23",
        "With set tendon parameters, model 2.0 follows the multiple holds less well than 1.0.",
        "90 % against 95 %", _MEDIAN.format("VAF(2.0) − VAF(1.0)", "negative"),
        _change(_fit("1.0"), _fit("2.0"), lambda d: d < 0.0), "", "figure-23", views=TENDON_VIEWS),
    Claim("tendon-same-on-multi-sine", "3.2.2, 4.2, Figures 17 and 23",
        "On the multi-sine with holds, models 1.0 and 2.0 are similar.", "93 % both",
        _MEDIAN.format("VAF(2.0) − VAF(1.0)", "within ±1 point"),
        _change(_fit("1.0", FAST_PROTOCOL), _fit("2.0", FAST_PROTOCOL), lambda d: abs(d) <= 1.0),
        "", "figure-23", views=TENDON_VIEWS),
    Claim("free-strain-fits-better", "3.2.4, 3.2.5, Figure 32",
        "Freeing the tendon's strain raises the VAF on the multiple holds.",
        "94.3 % against 90 %", _MEDIAN.format("VAF(2.1) − VAF(2.0)", "positive"),
        _change(_fit("2.0"), _fit("2.1"), lambda d: d > 0.0), "", "figure-32", views=TENDON_VIEWS),
    Claim("free-toe-force-fits-better", "3.2.4, 3.2.5, Figure 32",
        "Freeing the tendon's toe force raises the VAF on the multiple holds.",
        "91.7 % against 90 %", _MEDIAN.format("VAF(2.2) − VAF(2.0)", "positive"),
        _change(_fit("2.0"), _fit("2.2"), lambda d: d > 0.0), "", "figure-32", views=TENDON_VIEWS),
    Claim("strain-over-toe", "4.2.2, Figure 32",
        "Freeing the strain fits better than freeing the toe force.", "94.3 % against 91.7 %",
        _MEDIAN.format("VAF(2.1) − VAF(2.2)", "positive"),
        _change(_fit("2.2"), _fit("2.1"), lambda d: d > 0.0), "", "figure-32", views=TENDON_VIEWS),
    Claim("strain-equals-muscle", "4.2.2, Figures 17 and 32",
        "Model 2.1 follows the multiple holds as well as model 1.0.", "94.3 % against 95 %",
        _MEDIAN.format("VAF(2.1) − VAF(1.0)", "within ±1 point"),
        _change(_fit("1.0"), _fit("2.1"), lambda d: abs(d) <= 1.0), "", "figure-32",
        views=TENDON_VIEWS),
    Claim("outliers-are-misaligned-or-twisted", "4.2.1, Figure 17",
        "Low VAFs are of subjects whose knee moved or whose ankle was misaligned.",
        "the outliers of Figure 17",
        f"Model 1.0, multiple holds: the mean VAF of these subjects is below the others', {_SE} of "
        "the difference.", _remarked, _costs("1.0", ACTIVE_PROTOCOL), "figure-17", views=ONE_VIEW),
    Claim("prediction-below-fit", "3.2.3, Figure 29",
        "Predicted repetitions have a lower VAF than fitted ones.", "90.4 % against 95 % (1.0)",
        "Model 1.0, multiple holds: the mean VAF of predictions is below that of fits.",
        _ordered(lambda a, b: _mean(a) < _mean(b), _held("1.0"), _fit("1.0")), "", "figure-29",
        views=ONE_VIEW),
    Claim("muscle-predicts-better", "3.2.3, Figure 29",
        "Model 1.0 predicts the other repetitions of the multiple holds better than 2.0.",
        "90.4 % against 82.6 %", _PREDICTED.format("VAF(2.0) − VAF(1.0)", "negative"),
        _change(_held("1.0"), _held("2.0"), lambda d: d < 0.0), "", "figure-29",
        views=TENDON_VIEWS),
    Claim("multi-sine-predicted-worse", "3.2.3, Figure 29",
        "Model 1.0 predicts the multi-sine with holds less well than the multiple holds.",
        "83.1 % against 90.4 %", f"The mean VAF of predictions is lower, {_SE}.",
        _ordered(clearly_lower, _held("1.0", FAST_PROTOCOL), _held("1.0")), "", "figure-29",
        views=ONE_VIEW),
    Claim("free-strain-predicts-better", "4.2, Figures 29 and 35",
        "Freeing the tendon's strain makes predictions better.", "88.5 % against 82.6 %",
        _PREDICTED.format("VAF(2.1) − VAF(2.0)", "positive"),
        _change(_held("2.0"), _held("2.1"), lambda d: d > 0.0), "", "figure-35",
        views=TENDON_VIEWS),
    Claim("free-toe-force-predicts-better", "4.2, Figures 29 and 35",
        "Freeing the tendon's toe force makes predictions better.", "85.4 % against 82.6 %",
        _PREDICTED.format("VAF(2.2) − VAF(2.0)", "positive"),
        _change(_held("2.0"), _held("2.2"), lambda d: d > 0.0), "", "figure-35",
        views=TENDON_VIEWS),
    Claim("muscle-predicts-passive-better", "3.2.3, Figure 30",
        "From the multiple holds, model 1.0 predicts the ramp and hold better than 2.0.",
        "94 % against 90 %", _PREDICTED.format("VAF(2.0) − VAF(1.0)", "negative"),
        _change(lambda f: f.onto_passive("1.0"), lambda f: f.onto_passive("2.0"),
                lambda d: d < 0.0), "", "figure-30", views=TENDON_VIEWS),
)  # fmt: skip

_OTHERS: tuple[Claim[Evidence], ...] = (
    Claim("snsem-muscle-one-to-ten", "3.2.1, 4.2.1, Figure 21",
        "Most snSEM of model 1.0 lie between 1 and 10.", "1 … 10",
        f"{_H}the medians of more than half of the parameters lie in 1 … 10.",
        _one_to_ten, _left("1.0"), "figure-21", views=ONE_VIEW),
    Claim("snsem-muscle-weights-high", "3.2.1, Figure 21",
        "In model 1.0 the EMG weights have the highest snSEM.", "up to 150",
        "The median of the medians of g1 … g4 is above that of the other parameters.",
        _group(("g1", "g2", "g3", "g4"), lambda a, b: a > b), _left("1.0"), "figure-21",
        views=ONE_VIEW),
    Claim("snsem-muscle-filter-low", "3.2.1, Figure 21",
        "In model 1.0 f0 and beta have the lowest snSEM.", "below 1",
        "The median of the medians of f0 and beta is below that of the other parameters.",
        _group(("f0", "beta"), lambda a, b: a < b), _left("1.0"), "figure-21", views=ONE_VIEW),
    Claim("snsem-tendon-about-one", "3.2.2, 4.2.2, Figure 26",
        "The snSEM of model 2.0 are about 1.", "about 1",
        f"{_H}the median of the parameters' medians lies in 0.5 … 2.", _about_one, _left("2.0"),
        "figure-26", views=ONE_VIEW),
    Claim("snsem-tendon-below-muscle", "3.2.2, Figures 21 and 26",
        "The snSEM of model 2.0 are lower than those of 1.0.", "a lot lower",
        f"{_H}the median of the parameters' medians is lower.", _below_muscle,
        "Each is divided by its own model's simulations.", "figure-26", views=ONE_VIEW),
    Claim("snsem-strain-higher", "3.2.4, Figure 33",
        "The snSEM of model 2.1 are generally higher than those of 2.0.",
        "higher, but for the weights", "More than half of the fifteen medians are higher.",
        _ratio("2.1", lambda _, share: share > 0.5), _left("2.1"), "figure-33", views=ONE_VIEW),
    Claim("snsem-toe-similar", "3.2.5, Figure 34",
        "The snSEM of model 2.2 are similar to those of 2.0.", "very similar",
        "The median ratio of the fifteen medians lies in 0.5 … 2.",
        _ratio("2.2", lambda ratio, _: 0.5 <= ratio <= 2.0), _left("2.2"), "figure-34",
        views=ONE_VIEW),
    Claim("snsem-mass-highest-2-1", "3.2.4, Figure 33",
        "Of the snSEM of model 2.1, that of the mass is the highest.", "5.9 (2.1)",
        f"{_H}its median is the highest.", _mass_highest("2.1"), _left("2.1"), "figure-33",
        views=ONE_VIEW),
    Claim("snsem-mass-highest-2-2", "3.2.5, Figure 34",
        "Of the snSEM of model 2.2, that of the mass is the highest.", "5.9 (2.1)",
        f"{_H}its median is the highest.", _mass_highest("2.2"), _left("2.2"), "figure-34",
        views=ONE_VIEW),
    Claim("active-up-to-80", "3.2.1, Figures 18 to 20", "Active torque reaches about 80 Nm.",
        "80 Nm", "Model 1.0, multiple holds: the largest is 60 to 100 Nm.",
        _largest("neural", 60.0, 100.0), strength, "figure-19", views=ONE_VIEW),
    Claim("passive-up-to-10", "3.2.1, Figures 18 to 20", "Passive torque reaches about 10 Nm.",
        "10 Nm", "Model 1.0, multiple holds: the largest is 5 to 15 Nm.",
        _largest("tissue", 5.0, 15.0), "", "figure-19", views=ONE_VIEW),
    Claim("inertia-small", "3.2.1, Figures 18 to 20", "The inertial torque is very small.",
        "hardly visible",
        "Model 1.0, multiple holds: its largest is below 10 % of the active torque's.",
        _inertia, "", "figure-19", views=ONE_VIEW),
    Claim("peaks-not-reached-1-0", "3.2.1, 3.2.2, Figure 19",
        "The torque of model 1.0 does not reach the measured peaks.", "visible at the peaks",
        f"{_H}over the largest 5 % of the torque, it falls short in more than half of the "
        "recordings.", _short("1.0"), _costs("1.0", ACTIVE_PROTOCOL), "figure-19", views=ONE_VIEW),
    Claim("peaks-not-reached-2-0", "3.2.1, 3.2.2, Figure 25",
        "The torque of model 2.0 does not reach the measured peaks.", "visible at the peaks",
        f"{_H}over the largest 5 % of the torque, it falls short in more than half of the "
        "recordings.", _short("2.0"), _costs("2.0", ACTIVE_PROTOCOL), "figure-25",
        views=TENDON_VIEWS),
    Claim("mass-at-bounds", "4.2.1", "The mass ends at its bound in almost all subjects.",
        "almost all",
        "Model 1.0, multiple holds: at its bound in more than half of the recordings.",
        _mass, _mass_why, "figure-19", views=ONE_VIEW),
    Claim("passive-active-covariances", "3.2.2, Figure 28",
        "Some covariances between passive and active parameters are high.", "high in the red box",
        "Model 2.0, multiple holds: the largest |correlation| of the block exceeds 0.5 in more "
        "than half of the recordings.", _block, "", "figure-28", views=TENDON_VIEWS),
    Claim("optimal-lengths-depend", "3.2.2, 4.2.2, Figure 28",
        "Optimal lengths depend on the stiffness and slack length of their muscle.", "high",
        "Model 2.0, multiple holds: the median |correlation| of one of the pairs exceeds 0.5.",
        _lengths, "", "figure-28", views=TENDON_VIEWS),
    Claim("spectra-of-repetitions-differ", "4.4, Figure 40",
        "The torque's power spectra of a subject's repetitions differ.",
        "three curves, several dB apart",
        "The mean absolute difference of two repetitions, 0.25 to 5 Hz, exceeds 1 dB.", _spectra,
        "Here the effort was made to differ by repetition: this shows no more than that it "
        "suffices.", "figure-40", views=ONE_VIEW),
)  # fmt: skip

#: Every claim.
CLAIMS: tuple[Claim[Evidence], ...] = (
    *map(_level, LEVELS),
    *_ORDERS,
    *_OTHERS,
)
