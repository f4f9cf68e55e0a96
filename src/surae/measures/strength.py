"""Strength: the largest torque of maximal efforts, and whether it differs between two visits.

No model is in it. Repeats of a visit say how far efforts differ; how far a person's best does from
day to day is assumed.
"""

import math
from collections.abc import Mapping, Sequence
from dataclasses import dataclass, replace

from surae.base.normal import NORMAL
from surae.base.words import Message
from surae.trials.strength import Effort

#: Names of strength, and of the group that pulls.
STRENGTH = {"voluntary_torque_tri": "tri", "voluntary_torque_tib": "tib"}
_MEANINGS = {
    "tri": "Largest torque of the calf in a maximal effort, held still: mean over half a second, "
    "less the torque at rest.",
    "tib": "Largest torque of the tibialis in a maximal effort, held still: mean over half a "
    "second, less the torque at rest.",
}
#: How far a person's best effort differs from day to day, the foot mounted anew: a part of it, one
#: standard deviation (assumed).
_DAYS = 0.05
#: How far efforts of one visit differ before any is seen, a part of them, worth so many of them;
#: and of a single one, which may not have been the best.
_REPEATS = 0.05
_BELIEVED = 2
_SINGLE = 0.10
#: Standard deviation of the largest of n draws from a normal distribution, that of one being 1
#: (H. L. Harter, 1961, Biometrika 48:151-165); of more as of the last.
_LARGEST_OF = (1.0, 0.826, 0.748, 0.701, 0.669, 0.645)
#: Holds further apart are of another length of the muscles [deg].
_APART = 6.0


@dataclass(frozen=True, slots=True)
class Strength:
    """The best effort of one group at one visit."""

    torque: float  #: [Nm].
    sd: float  #: Between such visits of an unchanged leg, one visit's part [Nm].
    angle: float  #: Where the ankle was held [deg].
    efforts: int  #: How many there were at this angle.


@dataclass(frozen=True, slots=True)
class StrengthDifference:
    """Strength at two visits, and its difference."""

    name: str
    unit: str
    meaning: str
    before: float | None
    after: float | None
    difference: float | None  #: After minus before; None where it cannot be compared.
    ci95: tuple[float, float] | None
    sd: float | None  #: Standard deviation of the difference.
    missing: str = ""  #: Why there is none.


def strength_meaning(group: str) -> str:
    """What the strength of a group is, in a sentence."""
    return _MEANINGS[group]


def strength_of(efforts: Sequence[Effort], group: str) -> Strength | None:
    """The best effort of a group, and how far another visit's would differ; None without any.

    Parameters
    ----------
    efforts : sequence of Effort
        Of one visit.
    group : str
        ``"tri"`` or ``"tib"``.

    Returns
    -------
    Strength or None
        Of efforts near the best one's angle. Its variance is that from day to day, and that of the
        largest of so many efforts: s²·c(n), s their scatter, shrunk towards what efforts have.
    """
    of_group = [each for each in efforts if each.group == group]
    if not of_group:
        return None
    best = max(of_group, key=lambda each: each.torque)
    near = [each.torque for each in of_group if abs(each.angle - best.angle) <= _APART]
    n = len(near)
    if n == 1:
        return Strength(best.torque, best.torque * math.hypot(_DAYS, _SINGLE), best.angle, 1)
    mean = sum(near) / n
    squares = sum((each / mean - 1.0) ** 2 for each in near)
    scatter = math.sqrt((_BELIEVED * _REPEATS**2 + squares) / (_BELIEVED + n - 1))
    of_best = _LARGEST_OF[min(n, len(_LARGEST_OF)) - 1] * scatter
    return Strength(best.torque, best.torque * math.hypot(_DAYS, of_best), best.angle, n)


def strength_change(
    before: Sequence[Effort], after: Sequence[Effort]
) -> Mapping[str, StrengthDifference]:
    """Strength of both groups at two visits, or of two legs, by name; empty where neither has any.

    Parameters
    ----------
    before, after : sequence of Effort
        Of trials of maximal effort alone.
    """
    if not before and not after:
        return {}
    return {name: _difference(name, group, before, after) for name, group in STRENGTH.items()}


def _difference(
    name: str, group: str, before: Sequence[Effort], after: Sequence[Effort]
) -> StrengthDifference:
    first, second = (strength_of(side, group) for side in (before, after))
    bare = StrengthDifference(
        name,
        "Nm",
        _MEANINGS[group],
        None if first is None else first.torque,
        None if second is None else second.torque,
        None,
        None,
        None,
    )
    if first is None or second is None:
        return replace(bare, missing=Message("change/no-maximal"))
    if abs(first.angle - second.angle) > _APART:
        why = Message("change/held-apart", first=first.angle, second=second.angle)
        return replace(bare, missing=why)
    difference = second.torque - first.torque
    sd = math.hypot(first.sd, second.sd)
    ci95 = difference - NORMAL * sd, difference + NORMAL * sd
    return replace(bare, difference=difference, ci95=ci95, sd=sd)
