"""The one judge: the verdict of a value, whatever it is of and whoever estimated it."""

import math
from dataclasses import dataclass
from enum import StrEnum

#: Half-width of the 95 % interval, as a part of the value, up to which a value is identified.
IDENTIFIED = 0.10
#: Part of the distance of its bounds from which on a half-width is that of the bounds.
AS_BOUNDS = 0.45
#: Part of the population's standard deviation below which an estimate is news.
_NARROWER = 0.5


class Verdict(StrEnum):
    """Judgement of one value."""

    IDENTIFIED = "identified"
    WEAK = "weak"
    UNDETERMINED = "undetermined"
    AT_BOUND = "at-bound"
    FIXED = "fixed"


@dataclass(frozen=True, slots=True)
class Kind:
    """What a value is, as far as its verdict goes."""

    identified: float = IDENTIFIED  #: The largest half-width of what is identified.
    weak: float = 1.0  #: The largest half-width of what is weak.
    is_relative: bool = True  #: Whether these are parts of the value, or in its unit.
    #: Whether it is ever claimed: on legs that its author did not make, what it was sure of held.
    is_claimed: bool = True


#: A value of which a part means something: parameters, stiffness, torque.
PART = Kind()
#: An angle, of which a part means nothing [deg].
ANGLE = Kind(identified=2.0, weak=20.0, is_relative=False)
#: What a reflex has: on legs of other kinds a gain, a share and three delays were falsely sure.
OF_REFLEX = Kind(is_claimed=False)
#: The angle at which a muscle begins to answer a stretch [deg], by a line that is assumed.
THRESHOLD = Kind(identified=2.0, weak=10.0, is_relative=False, is_claimed=False)


def is_news(narrowed: float) -> bool:
    """Whether an estimate, so wide beside the population, says more than was known before."""
    return narrowed <= _NARROWER


def verdict_of(
    value: float,
    half: float,
    kind: Kind = PART,
    *,
    room: float = math.inf,
    narrowed: float = 0.0,
    doubted: bool = False,
    assumed: bool = False,
) -> Verdict:
    """Judge a value by its interval, the population, the fit, and what it rests on.

    Parameters
    ----------
    value : float
        The estimate, in its unit.
    half : float
        Half-width of its 95 % interval, everything included, in its unit; of an interval that is
        not symmetric the longer side.
    kind : Kind
        What it is.
    room : float
        Distance of the bounds within which it was searched, in its unit.
    narrowed : float
        Its standard deviation over that of the population, or of the prior that was given.
    doubted : bool
        Whether something speaks against the fit that touches this value.
    assumed : bool
        Whether it rests on what was not measured: an angle beyond the range, a path whose zero is
        not known, a parameter at its bound, a prior that does not fit.

    Returns
    -------
    Verdict
        ``undetermined`` where the interval is wider than the value, or about as wide as the bounds,
        which then say what the data do not; ``identified`` where it is within a tenth of the value,
        and nothing stands against the claim; ``weak`` otherwise.

    Notes
    -----
    Five places decided this until 0.2, and differed. What is right of each:

    - What the bounds say is nothing that the data say, of any estimator: `room` was judged of auto
      alone, and not where narrow bounds made the interval a small part of the value.
    - A prior counts as known before, whoever weighs it: an estimate that is hardly narrower is
      never identified. Of a named model it was, by the prior alone.
    - A doubt takes a claim and widens nothing: a wide interval has the verdict that it has without.
    - Angles have no size of which 10 % mean something, of the muscles and of the nerve alike.
    """
    size = abs(value) if kind.is_relative else 1.0
    # of a value of 0 no half-width is a part
    if not (size > 0.0 and half <= kind.weak * size) or half >= AS_BOUNDS * room:
        return Verdict.UNDETERMINED
    claimable = kind.is_claimed and is_news(narrowed) and not (doubted or assumed)
    if half <= kind.identified * size and claimable:
        return Verdict.IDENTIFIED
    return Verdict.WEAK
