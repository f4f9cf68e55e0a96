"""A joint's geometry as data: lengths and moment arms of both muscle groups over the angle."""

import math
from dataclasses import dataclass, replace
from functools import lru_cache
from itertools import pairwise
from typing import TYPE_CHECKING

from surae.base.errors import InputError
from surae.base.file_form import filed

if TYPE_CHECKING:  # help reads options, which need no NumPy
    from scipy.interpolate import CubicSpline, RectBivariateSpline

    from surae.base.units import FloatArray
    from surae.signals import ModelInputs

#: A movement may leave a table by so much [rad]; beyond its ends lengths go on straight.
_BEYOND = math.radians(1.0)
#: Most by which an arm may differ from the slope of its length, where a file states nothing [m].
TOLERANCE = 0.005
#: Angles between the table's own at which its splines are checked.
_CHECKED = 400

#: Between the travel of the triceps by equation (9), 0.017, and by virtual work, 0.048 [m/rad].
_FAR = 0.029

#: Groups as files call them, and whether they lengthen or shorten as the angle rises.
_GROUPS = (("tri", 1.0), ("tib", -1.0))

Row = tuple[float, ...]


@filed(sparse=("second",))
@dataclass(frozen=True, slots=True)
class GeometryTable:
    """Lengths and moment arms that somebody measured, or a scaled model has.

    Raises
    ------
    InputError
        The numbers are no geometry: angles fall, or an arm is not the slope of its length.
    """

    name: str  #: The file it was read from.
    angle: Row  #: Joint angles, rising [rad].
    #: Of the triceps surae and the tibialis anterior, muscle and tendon together [m]; less the
    #: tendon's slack length where `slack` is known. With a second angle for each pair of both, the
    #: second running faster.
    length: tuple[Row, Row]
    #: Moment arms, signed as the torque: triceps positive, tibialis negative [m].
    arm: tuple[Row, Row]
    tolerance: float = TOLERANCE  #: Most by which an arm differs from the slope of its length [m].
    #: Whether the lengths are those of the muscle on a rigid tendon: less its slack length.
    slack: bool = False
    source: str = ""  #: Where the numbers are from.
    #: Angles, rising, of a second joint that the muscles cross too [rad]; empty without one.
    second: Row = ()

    def __post_init__(self) -> None:
        """Refuse what is no geometry."""
        n = len(self.angle)
        seconds = len(self.second)
        if n < 4 or 0 < seconds < 3:
            few = f" and {seconds} second ones" if seconds else ""
            raise InputError(
                f"{self.name}: {n} angles{few}; a spline needs at least 4, and 3 of a second joint"
            )
        if any(
            later <= before for of in (self.angle, self.second) for before, later in pairwise(of)
        ):
            raise InputError(f"{self.name}: angles must rise from row to row, each only once")
        if any(len(row) != n * (seconds or 1) for row in (*self.length, *self.arm)):
            raise InputError(f"{self.name}: not a length and an arm for each angle")
        numbers = (*self.angle, *self.second, *sum((*self.length, *self.arm), ()))
        if not all(map(math.isfinite, numbers)):
            raise InputError(f"{self.name}: a number is missing or not finite")
        self._check_slopes()

    @property
    def range(self) -> tuple[float, float]:
        """Smallest and largest angle [rad]."""
        return self.angle[0], self.angle[-1]

    def at(
        self, group: int, angle: "FloatArray", second: "FloatArray | None" = None
    ) -> tuple["FloatArray", ...]:
        """Length of a group, its two derivatives by the angle, arm and its derivative, by splines.

        Then the length's derivative by the second angle, and that of its slope: 0 without one.
        Where the table has one that is not given, it is in the middle. Beyond the ends arms stay
        and lengths go on straight.
        """
        table = self.at_second() if second is None else self
        inside = angle.clip(*self.range)
        beyond = angle - inside
        within = beyond == 0.0
        if not table.second:
            length, arm = _splines(table, group)
            slope = length(inside, 1)
            nothing = 0.0 * beyond
            return (
                length(inside) + slope * beyond,
                slope,
                within * length(inside, 2),
                arm(inside),
                within * arm(inside, 1),
                nothing,
                nothing,
            )
        assert second is not None
        length, arm = _surfaces(table, group)
        kept = second.clip(self.second[0], self.second[-1])
        slope, across, turn = (length.ev(inside, kept, *by) for by in ((1, 0), (0, 1), (1, 1)))
        across = (kept == second) * across
        turn = (kept == second) * turn
        return (
            length.ev(inside, kept) + slope * beyond,
            slope,
            within * length.ev(inside, kept, 2, 0),
            arm.ev(inside, kept),
            within * arm.ev(inside, kept, 1, 0),
            across + turn * beyond,
            turn,
        )

    def at_second(self, second: float | None = None) -> "GeometryTable":
        """The table with the second joint still at an angle [rad], by default the middle one."""
        if not self.second:
            return self
        return _at_second(
            self, 0.5 * (self.second[0] + self.second[-1]) if second is None else second
        )

    def rest(self, group: int) -> float:
        """Length at 0 rad, about [m]."""
        import numpy as np

        return float(np.interp(0.0, self.angle, self.at_second().length[group]))

    @property
    def arms_mm(self) -> tuple[float, float]:
        """Size of both arms at 0 rad [mm]."""
        import numpy as np

        tri, tib = (1e3 * abs(float(self.at(group, np.zeros(1))[3][0])) for group in (0, 1))
        return tri, tib

    @property
    def travels_far(self) -> bool:
        """Whether the triceps travels as by virtual work, not as little as equation (9) says."""
        length = self.at_second().length[0]
        (low, high) = self.range
        travel = sum(abs(b - a) for a, b in pairwise(length))
        return travel > _FAR * (high - low)

    def _check_slopes(self) -> None:
        """Arms are the slopes of lengths that rise or fall somewhere as they have to."""
        import numpy as np

        angle = np.linspace(*self.range, _CHECKED)
        for second in self.second or (None,):
            at = None if second is None else np.full(_CHECKED, second)
            for group, (name, sign) in enumerate(_GROUPS):
                _, slopes, _, arms, *_ = self.at(group, angle, at)
                for values, what in ((slopes, "length"), (arms, "arm")):
                    if not (sign * values > 0.0).any():
                        raise InputError(
                            f"{self.name}: {what}_{name} has the wrong direction everywhere: turn "
                            "the sign of the angle"
                        )
                apart = np.abs(arms - slopes)
                worst = int(np.argmax(apart))
                if apart[worst] > self.tolerance:
                    raise InputError(
                        f"{self.name}: arm_{name} is {1e3 * apart[worst]:.3g} mm off the slope of "
                        f"length_{name} at {math.degrees(angle[worst]):.3g}°, more than "
                        f"{1e3 * self.tolerance:.3g} mm (lengths change by "
                        f"{float(np.sum(slopes * arms) / np.sum(arms**2)):.2g} times the arm); "
                        "correct it, or state '# tolerance_mm = …'"
                    )

    def check_covers(self, inputs: "ModelInputs") -> None:
        """Refuse a recording that moves where the table has no angles, or a path turns round.

        Raises
        ------
        InputError
            It moves farther, or has no second angle where the table has one.
        """
        moves = [("joint", inputs.angle, self.range)]
        if self.second:
            if not inputs.second:
                raise InputError(
                    f"{inputs.where}: the geometry of {self.name} is over a second angle, which "
                    "the recording has not; add its channel second_angle, or state '# "
                    "second_angle_deg = …' in the geometry's file, where that joint held still"
                )
            moves += [("second joint", inputs.second[0], (self.second[0], self.second[-1]))]
        counted = [angle[inputs.counts] for _, angle, _ in moves]
        for (joint, _, known), angle in zip(moves, counted, strict=True):
            low = float(angle.min())
            high = float(angle.max())
            if low < known[0] - _BEYOND or high > known[1] + _BEYOND:
                moved, has = (
                    "{:.3g}° to {:.3g}°".format(*map(math.degrees, ends))
                    for ends in ((low, high), known)
                )
                raise InputError(
                    f"{inputs.where}: the {joint} moves from {moved}, the geometry of {self.name} "
                    f"is known from {has}; give a table that covers the movement"
                )
        angle, *second = counted
        for group, (name, sign) in enumerate(_GROUPS):
            turned = sign * self.at(group, angle.clip(*self.range), *second)[3] <= 0.0
            if turned.any():
                raise InputError(
                    f"{self.name}: arm_{name} turns round at "
                    f"{math.degrees(angle[turned].max()):.3g}°, within the movement; leave these "
                    "angles out of the fit"
                )


@lru_cache(maxsize=16)
def _splines(table: GeometryTable, group: int) -> tuple["CubicSpline", "CubicSpline"]:
    """Of the lengths and of the arms of a group."""
    from scipy.interpolate import CubicSpline

    length, arm = (CubicSpline(table.angle, row[group]) for row in (table.length, table.arm))
    return length, arm


@lru_cache(maxsize=16)
def _surfaces(
    table: GeometryTable, group: int
) -> tuple["RectBivariateSpline", "RectBivariateSpline"]:
    """The same over both angles."""
    import numpy as np
    from scipy.interpolate import RectBivariateSpline

    shape = len(table.angle), len(table.second)
    length, arm = (
        RectBivariateSpline(
            table.angle, table.second, np.reshape(row[group], shape), ky=min(3, shape[1] - 1)
        )
        for row in (table.length, table.arm)
    )
    return length, arm


@lru_cache(maxsize=16)
def _at_second(table: GeometryTable, second: float) -> GeometryTable:
    import numpy as np

    angle = np.array(table.angle)
    tri, tib = (table.at(group, angle, np.full_like(angle, second)) for group in (0, 1))
    length, arm = ((tuple(tri[k].tolist()), tuple(tib[k].tolist())) for k in (0, 3))
    return replace(table, length=length, arm=arm, second=())
