"""A joint's geometry as data: lengths and moment arms of both muscle groups over the angle."""

import math
from dataclasses import dataclass
from functools import lru_cache
from itertools import pairwise
from typing import TYPE_CHECKING

from surae.errors import InputError

if TYPE_CHECKING:  # help reads options, which need no NumPy
    from scipy.interpolate import CubicSpline

    from surae.signals import ModelInputs
    from surae.units import FloatArray

#: A movement may leave a table by so much [rad]; beyond its ends lengths go on straight.
_BEYOND = math.radians(1.0)
#: Most by which an arm may differ from the slope of its length, where a file states nothing [m].
TOLERANCE = 0.005
#: Angles between the table's own at which its splines are checked.
_CHECKED = 400

#: Between the travel of the triceps by equation (9), 0.017, and by virtual work, 0.048 [m/rad].
_FAR = 0.029

Row = tuple[float, ...]


@dataclass(frozen=True, slots=True)
class GeometryTable:
    """Lengths and moment arms that somebody measured, or a scaled model has.

    Attributes
    ----------
    name : str
        The file it was read from.
    angle : tuple of float
        Joint angles, rising [rad].
    length : tuple of two tuples of float
        Of the triceps surae and the tibialis anterior, muscle and tendon together [m]; less the
        tendon's slack length where `slack` is known.
    arm : tuple of two tuples of float
        Moment arms, signed as the torque: triceps positive, tibialis negative [m].
    tolerance : float
        Most by which an arm differs from the slope of its length [m].
    slack : bool
        Whether the lengths are those of the muscle on a rigid tendon: less its slack length.
    source : str
        Where the numbers are from.

    Raises
    ------
    InputError
        The numbers are no geometry: angles fall, or an arm is not the slope of its length.
    """

    name: str
    angle: Row
    length: tuple[Row, Row]
    arm: tuple[Row, Row]
    tolerance: float = TOLERANCE
    slack: bool = False
    source: str = ""

    def __post_init__(self) -> None:
        """Refuse what is no geometry."""
        n = len(self.angle)
        if n < 4:
            raise InputError(f"{self.name}: {n} angles; a spline needs at least 4")
        if any(later <= before for before, later in zip(self.angle, self.angle[1:], strict=False)):
            raise InputError(f"{self.name}: angles must rise from row to row, each only once")
        if any(len(row) != n for row in (*self.length, *self.arm)):
            raise InputError(f"{self.name}: not a length and an arm for each angle")
        if not all(map(math.isfinite, (*self.angle, *sum((*self.length, *self.arm), ())))):
            raise InputError(f"{self.name}: a number is missing or not finite")
        self._check_slopes()

    @property
    def range(self) -> tuple[float, float]:
        """Smallest and largest angle [rad]."""
        return self.angle[0], self.angle[-1]

    def at(self, group: int, angle: "FloatArray") -> tuple["FloatArray", ...]:
        """Length of a group, its two derivatives by the angle, arm and its derivative, by splines.

        Beyond the ends arms stay and lengths go on straight.
        """
        length, arm = _splines(self, group)
        inside = angle.clip(*self.range)
        beyond = angle - inside
        slope, within = length(inside, 1), beyond == 0.0
        return (
            length(inside) + slope * beyond, slope, within * length(inside, 2), arm(inside),
            within * arm(inside, 1),
        )  # fmt: skip

    def rest(self, group: int) -> float:
        """Length at 0 rad, about [m]."""
        import numpy as np

        return float(np.interp(0.0, self.angle, self.length[group]))

    @property
    def travels_far(self) -> bool:
        """Whether the triceps travels as by virtual work, not as little as equation (9) says."""
        length, (low, high) = self.length[0], self.range
        travel = sum(abs(b - a) for a, b in pairwise(length))
        return travel > _FAR * (high - low)

    def _check_slopes(self) -> None:
        """Arms are the slopes of lengths that rise or fall somewhere as they have to."""
        import numpy as np

        self._check_turns(*self.range, everywhere=True)
        angle = np.linspace(*self.range, _CHECKED)
        for group, muscle in enumerate(("triceps", "tibialis")):
            _, slopes, _, arms, _ = self.at(group, angle)
            apart = np.abs(arms - slopes)
            worst = int(np.argmax(apart))
            if apart[worst] > self.tolerance:
                raise InputError(
                    f"{self.name}: the moment arm of the {muscle} is {1e3 * apart[worst]:.3g} mm "
                    f"off the slope of its length at {math.degrees(angle[worst]):.3g}°, more than "
                    f"{1e3 * self.tolerance:.3g} mm; correct it, or state '# tolerance_mm = …'"
                )

    def _check_turns(self, low: float, high: float, *, everywhere: bool = False) -> None:
        """Lengths rise or fall between two angles, and arms do not turn; or not everywhere."""
        import numpy as np

        angle = np.linspace(low, high, _CHECKED)
        for group, (sign, muscle) in enumerate(((1.0, "triceps"), (-1.0, "tibialis"))):
            _, slopes, _, arms, _ = self.at(group, angle)
            for values, what in ((slopes, "length"), (arms, "moment arm")):
                wrong = np.flatnonzero(sign * values <= 0.0)
                if wrong.size == len(angle) or (wrong.size and not everywhere):
                    at = f"at {math.degrees(angle[wrong[0]]):.3g}°"
                    does = "rise" if sign > 0 else "fall"
                    rule = f"does not {does} with the angle" if what == "length" else "turns round"
                    where = f"{at}, within the movement; leave these angles out of the fit"
                    if everywhere:
                        where = "everywhere: turn the sign of the angle"
                    raise InputError(f"{self.name}: the {what} of the {muscle} {rule} {where}")

    def check_covers(self, inputs: "ModelInputs") -> None:
        """Refuse a recording that moves where the table has no angles, or a path turns round.

        Raises
        ------
        InputError
            It moves farther.
        """
        counted = inputs.angle if inputs.weight is None else inputs.angle[inputs.weight > 0]
        low, high = float(counted.min()), float(counted.max())
        if low < self.range[0] - _BEYOND or high > self.range[1] + _BEYOND:
            moved, known = (
                "{:.3g}° to {:.3g}°".format(*map(math.degrees, ends))
                for ends in ((low, high), self.range)
            )
            raise InputError(
                f"{inputs.where}: the joint moves from {moved}, the geometry of {self.name} is "
                f"known from {known}; give a table that covers the movement"
            )
        self._check_turns(max(low, self.range[0]), min(high, self.range[1]))


@lru_cache(maxsize=16)
def _splines(table: GeometryTable, group: int) -> tuple["CubicSpline", "CubicSpline"]:
    """Of the lengths and of the arms of a group."""
    from scipy.interpolate import CubicSpline

    length, arm = (CubicSpline(table.angle, row[group]) for row in (table.length, table.arm))
    return length, arm
