"""What changed of a relaxed leg between two visits: differences of possible legs, pair by pair.

Both visits are one estimate (`surae.inference.relaxed.pair`): what the leg shares is drawn once and
cancels, zero, foot and noise are anew. Stiffness and angle at a torque, and the rise over a range,
ask for no zero of the angle.
"""

import math
from collections.abc import Iterable, Mapping, Sequence
from dataclasses import dataclass, replace
from typing import Any

import numpy as np

from surae.base.frozen import FrozenDict
from surae.base.normal import NORMAL
from surae.base.units import FloatArray
from surae.base.words import Message
from surae.inference import Grade
from surae.inference.relaxed.aligned import (
    SHIFTS,
    SIZES,
    Alignment,
    Remounting,
    laid_pairs,
    quantiles_of,
)
from surae.inference.relaxed.curve import RelaxedCurve
from surae.inference.relaxed.pair import REMOUNTED, LegPairs, paired_legs, remounted_by
from surae.measures.measure import Measure
from surae.measures.reliability import reliability_of
from surae.measures.rest.judged import values_of_rest

#: Part of the pairs that has to have a value.
_ENOUGH = 0.95
#: How well a shift has to be known to be told [deg].
_KNOWN_SHIFT = 0.7
SHIFT = "curve_shift"
SIZE = "curve_size"
#: Ends of 95 % and the middle.
_QUANTILES = np.array([0.025, 0.5, 0.975])
#: What makes a curve doubtful, and of which kind it is. Plate and nerve are the same at both
#: visits, and then cancel; the joint posterior says how likely they are not, and from where on
#: none is judged.
_KINDS = {
    "relaxed/noisy": "noisy",
    "relaxed/short": "short",
    "relaxed/plate": "plate",
    "relaxed/heavy": "plate",
    "relaxed/reflex": "reflex",
    "relaxed/less": "reflex",
}
_SHARED = ("plate", "reflex")
#: Probability that one visit has it and the other not, above which it does not cancel.
_UNLIKE = 0.1
#: Times by which an electrode may show more at one visit than at the other, of rest that is only
#: declared: amplifiers and skin differ by less, a tone of a Nm shows more; assumed.
_AS_LOUD = 1.5


@dataclass(frozen=True, slots=True)
class RestDifference:
    """A measure of rest at two visits of a leg, and its difference."""

    name: str
    unit: str
    meaning: str
    before: float | None  #: By the device, as of its visit.
    #: At the same angles of the ankle, as both curves tell the mounting: before and `difference`.
    after: float | None
    difference: float | None  #: After minus before; None where it cannot be compared.
    ci95: tuple[float, float] | None  #: Of the difference, at the ankle's own angle.
    #: Of what differs at one angle of the device, which an unchanged leg that is mounted otherwise
    #: does too: it need not hold `difference`. None of what is at no stated angle.
    ci95_device: tuple[float, float] | None
    sd: float | None  #: Of the difference, towards none: of a normal distribution with its p.
    missing: str = ""  #: Why there is none.
    from_deg: float | None = None
    to_deg: float | None = None


@dataclass(frozen=True, slots=True)
class RestChange:
    """What rest says of two visits."""

    differences: Mapping[str, RestDifference]  #: By the measure's name.
    doubt: str  #: Why none of them is judged; empty where they are.
    alike: float  #: Probability that the tissue relaxes as before; 0 of two legs.


def rest_change(
    before: RelaxedCurve,
    after: RelaxedCurve,
    angles: Sequence[float],
    *,
    legs: bool = False,
    remounted: float = REMOUNTED,
) -> RestChange:
    """What changed of the relaxed leg, by one estimate of both visits.

    Parameters
    ----------
    before, after : RelaxedCurve
        Of each visit.
    angles : sequence of float
        Where torque and stiffness are compared [deg], of the ankle's own.
    legs : bool
        Whether they are two legs, which share nothing but the device.
    remounted : float
        By how much a foot is turned as it is mounted anew [deg]: `remounting` learns it.

    Returns
    -------
    RestChange
        Differences over the range that both moved through.
    """
    if legs:
        pairs = paired_legs(before, after, one_leg=False)
        made = _differences(before, after, pairs, angles)
    else:
        pairs, alignment = laid_pairs(before, after, remounted=remounted)
        mounting = Remounting.of(before, after, remounted)
        made = {SIZE: _size(alignment, mounting), **_differences(before, after, pairs, angles)}
        made[SHIFT] = _shift(alignment, mounting)
    return RestChange(FrozenDict(made), _doubt(before, after, pairs), pairs.alike)


def _differences(
    before: RelaxedCurve, after: RelaxedCurve, pairs: LegPairs, angles: Sequence[float]
) -> dict[str, RestDifference]:
    """What changed of each measure of rest, over the range that both moved through."""
    low, high = (
        end(curve.moved[k] + curve.zero_deg for curve in (before, after))
        for k, end in enumerate((max, min))
    )
    sides = []
    for curve, possible in ((before, pairs.before), (after, pairs.after)):
        common = replace(curve, moved=(low - curve.zero_deg, high - curve.zero_deg))
        sides.append({each.name: each for each in values_of_rest(common, possible, angles)})
    return {name: _difference(sides[0][name], sides[1][name]) for name in sides[0]}


def remounting(first: RelaxedCurve, others: Sequence[RelaxedCurve]) -> float:
    """By how much a foot is turned as it is mounted anew [deg], as visits without a change show.

    Parameters
    ----------
    first : RelaxedCurve
        Of one visit.
    others : sequence of RelaxedCurve
        Of further visits before anything changed; without any it is as assumed.

    Returns
    -------
    float
        One standard deviation. A leg that has not changed has its curve elsewhere on the device
        for nothing but its mounting.
    """
    shifts_of = []
    for other in others:
        alignment = laid_pairs(first, other)[1]
        if alignment is not None and alignment.is_one_form:
            density = alignment.shifts(sized=False)
            mean = float(density @ SHIFTS)
            shifts_of.append((mean, float(density @ (SHIFTS - mean) ** 2)))
    return remounted_by([each for each, _ in shifts_of], [each for _, each in shifts_of])


def with_detectable_changes(
    measures: Iterable[Measure],
    curve: RelaxedCurve,
    angles: Sequence[float],
    *,
    laid: bool = True,
) -> tuple[Measure, ...]:
    """Measures of rest with SDC and ICC: of a second visit like this one, the leg unchanged.

    Not `laid` upon each other, curves leave the whole of a mounting in what is read at an angle.
    """
    pairs = laid_pairs(curve, curve)[0] if laid else paired_legs(curve, curve)
    again = _differences(curve, curve, pairs, angles)
    made = []
    for m in measures:
        d = again.get(m.name)
        if m.value is None or d is None or d.ci95 is None:
            note = m.note or Message("measure/no-interval")
            made.append(replace(m, sdc_note=note))
            continue
        sdc = 0.5 * (d.ci95[1] - d.ci95[0])
        sem = sdc / (NORMAL * math.sqrt(2.0))
        made.append(replace(m, sdc=sdc, reliability=reliability_of(m.name, m.unit, sem)))
    return tuple(made)


def doubt_between(before: RelaxedCurve, after: RelaxedCurve) -> str:
    """Why no difference of these visits is judged; empty where they are."""
    return _doubt(before, after, paired_legs(before, after))


def _doubt(before: RelaxedCurve, after: RelaxedCurve, pairs: LegPairs) -> str:
    """Why none is judged: a doubt that both visits do not share, so that it does not cancel."""
    unlike = dict(zip(_SHARED, pairs.unlike, strict=True))
    for place, curve in zip(("before", "after"), (before, after), strict=True):
        for kind, reason in _doubts(curve).items():
            if unlike.get(kind, 1.0) > _UNLIKE:
                return Message(f"change/doubtful/rest/{place}", reason=reason)
    return _louder(before, after)


def _louder(before: RelaxedCurve, after: RelaxedCurve) -> str:
    """Why rest that no effort is seen beside may not be alike at both visits; empty where it may.

    A muscle that never lets go shows a steady EMG, as an electrode's noise is: at one visit they
    are alike, and a tone that comes or goes is a change of the electrode's level.
    """
    if not (before.is_declared or after.is_declared):
        return ""
    levels = [curve.levels for curve in (before, after)]
    both = [m for m in levels[0] if m in levels[1] and max(level[m] for level in levels) > 0.0]
    if not both:
        return ""
    ratios = {m: levels[1][m] / levels[0][m] if levels[0][m] > 0.0 else math.inf for m in both}
    muscle = max(both, key=lambda m: abs(math.log(max(ratios[m], 1e-9))))
    ratio = max(ratios[muscle], 1.0 / max(ratios[muscle], 1e-9))
    if ratio < _AS_LOUD:
        return ""
    return Message("change/doubtful/rest/louder", muscle=muscle.upper(), ratio=ratio)


def _doubts(curve: RelaxedCurve) -> dict[str, str]:
    """What makes a curve doubtful, by its kind."""
    if curve.grade is Grade.ADEQUATE:
        return {}
    codes = {getattr(each, "code", ""): each for each in curve.findings}
    made = {kind: codes[code] for code, kind in _KINDS.items() if code in codes}
    return made or {"": curve.findings[0]}


def _difference(first: Any, second: Any) -> RestDifference:
    """A difference of two measures' values, pair by pair."""
    bare = RestDifference(first.name, first.unit, first.meaning, None, None, None, None, None, None)
    if first.span is not None:
        bare = replace(bare, from_deg=first.span[0], to_deg=first.span[1])
    lacking = first.missing or second.missing
    if lacking:
        if not (first.missing and second.missing):
            side = "after" if second.missing else "before"
            lacking = Message(f"change/only/{side}", why=lacking)
        return _one_sided(replace(bare, missing=lacking), first, second)
    there = np.isfinite(first.ankle) & np.isfinite(second.ankle)
    if there.mean() < _ENOUGH:
        return replace(bare, missing=Message("measure/lacking"))
    made = bare
    ankle = (second.ankle - first.ankle)[there]
    device = (second.device - first.device)[there]
    value = float(np.median(first.device[there]))
    low, difference, high = map(float, np.quantile(ankle, _QUANTILES))
    return replace(
        made,
        before=value,
        after=value + difference,
        difference=difference,
        ci95=(low, high),
        ci95_device=_ends(device) if first.at_angle else None,
        sd=_towards_none(difference, (low, high)),
    )


def _one_sided(bare: RestDifference, first: Any, second: Any) -> RestDifference:
    """With the value of the side that has one."""
    before, after = (
        None if side.device is None else float(np.nanmedian(side.device))
        for side in (first, second)
    )
    return replace(bare, before=before, after=after)


def _ends(values: FloatArray) -> tuple[float, float]:
    low, high = np.quantile(values, [0.025, 0.975])
    return float(low), float(high)


def _towards_none(difference: float, ci95: tuple[float, float]) -> float:
    """Standard error of which the interval's half on the side of no change is 95 %'s."""
    half = difference - ci95[0] if difference > 0.0 else ci95[1] - difference
    return max(half / NORMAL, 1e-12)


def _size(alignment: Alignment | None, mounting: Remounting) -> RestDifference:
    """By how much the curve is larger, wherever it lies."""
    bare = RestDifference(
        SIZE,
        "%",
        "By how much the torque of the relaxed ankle has grown all over its curve, wherever the "
        "curve lies: how the foot is mounted and where tissue begins are not in it.",
        *(None,) * 6,
    )
    if alignment is None or not alignment.is_one_form:
        return replace(bare, missing=_unlaid(alignment))
    density = alignment.sizes(mounting)
    logs = quantiles_of(SIZES, density, _QUANTILES)
    low, middle, high = (100.0 * math.expm1(each) for each in logs)
    known = _towards_none(float(logs[1]), (float(logs[0]), float(logs[2])))
    beyond = max(abs(float(logs[1])) / known, 1e-9)  # standard errors, of a logarithm
    # what has no change in it has its own width
    error = abs(middle) / beyond if abs(middle) > 1e-6 else (high - low) / (2.0 * NORMAL)
    return replace(bare, difference=middle, ci95=(low, high), sd=error)


def _shift(alignment: Alignment | None, mounting: Remounting) -> RestDifference:
    """By how much the curve lies further towards dorsiflexion; None where the device's is unsure.

    A curve that is shifted and one that is weaker look alike but for a toe, a capsule or a
    tibialis' side. On the device an unchanged leg is shifted by its mounting.
    """
    bare = RestDifference(
        SHIFT,
        "deg",
        "By how much the curve of the relaxed ankle lies further towards dorsiflexion, whatever "
        "its size.",
        *(None,) * 6,
    )
    if alignment is None or not alignment.is_one_form:
        return replace(bare, missing=_unlaid(alignment))
    density = alignment.shifts()
    mean = float(density @ SHIFTS)
    spread = math.sqrt(float(density @ (SHIFTS - mean) ** 2))
    if spread >= _KNOWN_SHIFT:
        return replace(bare, missing=Message("change/no-shift", degrees=_KNOWN_SHIFT))
    low, middle, high = map(float, quantiles_of(SHIFTS, density, _QUANTILES))
    anew = NORMAL * math.hypot(spread, mounting.sd)
    middle -= mounting.expected
    ends = middle - anew, middle + anew
    return replace(
        bare,
        difference=middle,
        ci95=ends,
        ci95_device=(low, high),
        sd=_towards_none(middle, ends),
    )


def _unlaid(alignment: Alignment | None) -> Message:
    """Why neither size nor shift is told."""
    return Message("change/no-overlap" if alignment is None else "change/no-form")
