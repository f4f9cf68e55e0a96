"""What muscles are in other simulators, fitted to those of a leg.

There a muscle runs along its path: its moment arm is the derivative of the length, which of the
printed geometry it is not. Lengths are therefore those along the path, longer than ours by the
ratio of arm to slope. What a fibre's length is in anatomy is held where a format has a width of the
force-length curve beside it, which is then scaled instead.
"""

from collections.abc import Callable, Sequence
from dataclasses import dataclass, replace
from typing import TypeVar

import numpy as np
from scipy.optimize import least_squares

from surae.base.units import FloatArray
from surae.model.contraction import FECC, MVSH

#: Length of a path at 0 rad, or of its straight part [m]: long enough for muscle and tendon.
_LENGTH = 0.5
#: Degree of the polynomial of an arm by the angle.
_DEGREE = 5
#: What is left on the cylinder where the path is shortest [rad]; from there to the insertion [m].
_WRAPPED = 0.3
_END = 0.01
#: Curves of De Groote et al. (2016) as OpenSim has them: three bells of force over length, force
#: over velocity and its slope at rest, scale of the tendon's.
_FL = (
    (0.8150671134243542, 1.055033428970575, 0.162384573599574, 0.063303448465465),
    (0.433004984392647, 0.716775413397760, -0.029947116970696, 0.200356847296188),
    (0.1, 1.0, 0.5 * 0.5**0.5, 0.0),
)
_FV = (-0.3211346127989808, -8.149, -0.374, 0.8825327733249912)
_FV_SLOPE = _FV[0] * _FV[1] / (1.0 + _FV[2] ** 2) ** 0.5
_TENDON = 0.2
#: Growth of passive force there, the strain at which it is the largest active one, and the length
#: at which it is none.
_PASSIVE = 4.0
_PASSIVE_STRAIN = 0.6
_SHORTEST = 0.2
#: Shortest and longest fibre of OpenSim, with room, where the tendon stretches as it does in the
#: fit [optimal lengths]; where a path leaves no room for both, the shortest holds.
_FIBRE = (0.25, 1.75)
#: What a slanting fibre reaches along the tendon at least [optimal lengths].
_REACH = 0.02
#: Halvings in which force balance is found; 40 leave 1e-12 of the largest force.
_HALVINGS = 40
M = TypeVar("M", "DeGrooteMuscle", "MujocoMuscle")
#: Ends of what is fitted of a muscle: optimum [optimal lengths from where it is assumed], widths.
_SHIFT = 3.0
_WIDE = 4.0
_WIDTH = 10.0
#: Widths that the search begins at, in those of a path that is the arm's.
_WIDTHS = (1.0, 2.0)
#: What is fitted of a muscle, and how near to an end of its range one is said to lie there.
_NUMBERS = ("optimum", "peak force", "width", "tendon strain")
_AT_LIMIT = 1e-3


@dataclass(frozen=True, slots=True)
class PolynomialPath:
    """A path whose length is a polynomial of the angle, as ``FunctionBasedPath`` of OpenSim."""

    coefficients: tuple[float, ...]  #: Of the length [m, m/rad, …], the constant first.

    @classmethod
    def through(cls, angle: FloatArray, arm: FloatArray) -> "PolynomialPath":
        """The path whose arm is nearest to these [m], signed as torque is."""
        fit = np.polynomial.Polynomial.fit(angle, arm, _DEGREE).convert()
        return cls(tuple(fit.integ(k=_LENGTH).coef.tolist()))

    def length(self, angle: FloatArray) -> FloatArray:
        """Length at angles of the ankle [m]."""
        return np.asarray(np.polynomial.Polynomial(self.coefficients)(angle))

    def arm(self, angle: FloatArray) -> FloatArray:
        """Its derivative by the angle, the signed moment arm [m]."""
        return np.asarray(np.polynomial.Polynomial(self.coefficients).deriv()(angle))


@dataclass(frozen=True, slots=True)
class WrappedPath:
    """A straight line from the shank, round a cylinder of the foot, to the foot.

    A cylinder about the axis has a constant arm; beside the axis it has one that changes with the
    angle, nearly straight.
    """

    sign: float  #: 1 behind the ankle, where dorsiflexion lengthens it; −1 before it.
    radius: float  #: Of the cylinder [m].
    #: `forward`, `up`: its middle at 0 rad, from the ankle's axis [m].
    forward: float
    up: float
    last: float  #: Where it leaves the cylinder, turned from behind (or before) down [rad].

    @classmethod
    def through(cls, angle: FloatArray, arm: FloatArray) -> "WrappedPath":
        """The path whose arm is nearest to these [m], signed as torque is."""
        sign = 1.0 if float(np.mean(arm)) > 0 else -1.0
        mean = float(np.mean(np.abs(arm)))
        last = float(np.max(-sign * angle)) + _WRAPPED

        def of(at: FloatArray) -> WrappedPath:
            radius, forward, up = at.tolist()
            return cls(sign, radius, forward, up, last)

        def missing(at: FloatArray) -> FloatArray:
            return (of(at).arm(angle) - arm) / mean

        bounds = ([0.2 * mean, -mean, -mean], [3.0 * mean, mean, mean])
        fit = least_squares(missing, (mean, 0.0, 0.0), bounds=bounds, x_scale=mean)
        return of(fit.x)

    def length(self, angle: FloatArray) -> FloatArray:
        """Length at angles of the ankle [m]."""
        away, toward = self._seen(angle)
        turned = self.last + self.sign * angle + toward - np.arccos(self.radius / away)
        return np.asarray(np.sqrt(away**2 - self.radius**2) + self.radius * turned + _END)

    def arm(self, angle: FloatArray) -> FloatArray:
        """Its derivative by the angle, the line's signed distance from the axis [m]."""
        away, _ = self._seen(angle)
        across, along = self._middle(angle)
        free = np.sqrt(away**2 - self.radius**2)
        # the line from the origin is that to the middle, turned by asin(R/away)
        below = _LENGTH - along
        arm: FloatArray = _LENGTH * (self.radius * below + free * across) / away**2
        return self.sign * arm

    def _middle(self, angle: FloatArray) -> tuple[FloatArray, FloatArray]:
        """Middle of the cylinder: towards the path's side, and up [m]."""
        cos = np.cos(angle)
        sin = np.sin(angle)
        forward = self.forward * cos - self.up * sin
        up = self.forward * sin + self.up * cos
        return -self.sign * forward, up

    def _seen(self, angle: FloatArray) -> tuple[FloatArray, FloatArray]:
        """Distance of the origin from the middle, and its direction there, from the side [rad]."""
        across, up = self._middle(angle)
        return np.hypot(across, _LENGTH - up), np.arctan2(_LENGTH - up, -across)

    @property
    def origin(self) -> float:
        """Where it begins, straight above the ankle's axis [m]."""
        return _LENGTH

    @property
    def side(self) -> tuple[float, float]:
        """A point on the path's side of the cylinder at 0 rad, forward and up [m]."""
        return self.forward - self.sign * 1.5 * self.radius, self.up

    @property
    def insertion(self) -> tuple[float, float]:
        """Where it ends at 0 rad, forward and up of the axis [m]."""
        # from the side, turned down, and on along the tangent
        cos = np.cos(self.last)
        sin = np.sin(self.last)
        radius = self.radius
        outward = radius * cos - _END * sin
        down = radius * sin + _END * cos
        return float(self.forward - self.sign * outward), float(self.up - down)


@dataclass(frozen=True, slots=True)
class HeldMuscle:
    """A muscle group of a leg that holds still, along its path."""

    length: FloatArray  #: Of the path [m], shape (n,).
    tissue: FloatArray  #: Force of relaxed tissue [N], shape (n,).
    states: FloatArray  #: Active states α [N], shape (k,).
    active: FloatArray  #: What each adds to the force [N], shape (k, n).
    optimum: float  #: Length of the path at which the muscle is about as long as optimal [m].
    optimal: float  #: Optimal length along the path [m].
    peak: float  #: The largest active state that there is [N].
    speed: float  #: Largest speed of shortening [optimal lengths/s].
    lag: float  #: Time by which the active state is later than the excitation [s].
    stretch: float  #: Of the tendon at `peak`, along the path [m]; 0 of a rigid one.
    fibre: float  #: Optimal length of the fibre [m].
    pennation: float = 0.0  #: Angle of the fibre to the tendon at its optimal length [rad].
    weight: FloatArray | None = None  #: What each active force counts, shape (k, n); None: alike.
    #: Stretch of the tendon at the largest force that is met [m]; None: `stretch`.
    met: float | None = None

    def nearest(
        self,
        of: "Callable[[FloatArray], M]",
        starts: Sequence[Sequence[float]],
        *bounds: Sequence[float],
    ) -> "M":
        """The muscle of numbers between bounds whose active force is nearest to this one's."""
        still = np.zeros_like(self.length)
        shares = self.states / self.peak
        scale = float(np.abs(self.active).max())

        def missing(at: FloatArray) -> FloatArray:
            muscle = of(at)
            forces = [muscle.force(self.length, still, share + still) for share in shares]
            apart = (forces - self.active) / scale
            return np.concatenate(apart if self.weight is None else apart * self.weight)

        ends = [least_squares(missing, start, bounds=bounds) for start in starts]
        numbers = min(ends, key=lambda end: float(end.cost)).x
        muscle = of(numbers)
        if not isinstance(muscle, DeGrooteMuscle):
            return muscle
        used = muscle.strain > 0.0
        at_limit = tuple(
            name
            for name, at, low, high in zip(_NUMBERS, numbers, *bounds, strict=True)
            if min(at - low, high - at) < _AT_LIMIT * (high - low) and (used or name != _NUMBERS[3])
        )
        return replace(muscle, at_limit=at_limit)


@dataclass(frozen=True, slots=True)
class DeGrooteMuscle:
    """``DeGrooteFregly2016Muscle`` of OpenSim.

    Its passive fibre stands on the optimal length and is left out.

    F. De Groote, A. L. Kinney, A. V. Rao, B. J. Fregly (2016). Evaluation of direct collocation
    optimal control problem formulations for solving the muscle redundancy problem. Annals of
    Biomedical Engineering 44(10):2922-2936.
    """

    peak: float  #: Force at activation 1 and optimal length [N].
    optimal: float  #: Optimal fibre length [m].
    slack: float  #: Slack length of the tendon [m].
    strain: float  #: Of the tendon at `peak`; 0 where it is rigid.
    speed: float  #: Largest speed of shortening [optimal lengths/s].
    lag: float  #: Time constant of activation and deactivation [s].
    width: float = 1.0  #: By how much its force-length curve is wider than the standard one.
    pennation: float = 0.0  #: Angle of the fibre to the tendon at its optimal length [rad].
    at_limit: tuple[str, ...] = ()  #: What of it lies at an end of what is looked through.

    @classmethod
    def fitted(cls, held: HeldMuscle) -> "DeGrooteMuscle":
        """The muscle of this fibre whose active force, held still, is nearest."""
        fibre = held.fibre * float(np.cos(held.pennation))  # as far as it reaches along the tendon
        along = held.optimal / held.fibre  # what the fibre travels there for what it does here
        # both curves of speed fall alike at rest
        speed = float(held.speed * along * _FV_SLOPE / (1.0 + 1.0 / MVSH))

        def of(at: FloatArray) -> DeGrooteMuscle:
            peak = float(at[1] * held.peak)
            slack = float(held.optimum + at[0] * held.optimal) - fibre
            strain = float(at[3] * held.stretch / slack)
            width = float(at[2])
            return cls(
                peak, held.fibre, slack, strain, speed, held.lag, width, pennation=held.pennation
            )

        # muscle and tendon fill the path, and the fibre stays as long as OpenSim knows fibres: a
        # slanting one is never shorter than the muscle is thick
        thick = float(np.sin(held.pennation))
        least = max(_FIBRE[0] ** 2 - thick**2, _REACH**2) ** 0.5
        stretch = held.stretch if held.met is None else held.met
        room = _FIBRE[1], least + stretch / held.fibre
        shortest, longest = (
            float(end - by * held.fibre + fibre - held.optimum) / held.optimal
            for end, by in zip((held.length.max(), held.length.min()), room, strict=True)
        )
        least = max(min(shortest, longest), -1.0)
        most = max(min(longest, _SHIFT), least + _AT_LIMIT)
        low = [least, 0.5, 1.0, 0.1]
        high = [most, 2.0, max(_WIDTH, 2.0 * along), 10.0]
        widths = (min(max(by * along, 1.0), high[2]) for by in _WIDTHS)
        start = min(max(0.0, least + 0.01 * (most - least)), most - 0.01 * (most - least))
        return held.nearest(of, [(start, 1.0, width, 1.0) for width in widths], low, high)

    def force(self, length: FloatArray, speed: FloatArray, activation: FloatArray) -> FloatArray:
        """Force [N] where the path is so long [m] and lengthens so fast [m/s].

        Muscle and tendon are in balance, at the speed of the path.
        """
        if self.strain == 0.0:
            held = self._active(length - self.slack, speed, activation)
            return self.peak * np.clip(held, 0.0, FECC)
        low = np.zeros_like(length)
        high = np.full_like(length, FECC)
        for _ in range(_HALVINGS):
            middle = 0.5 * (low + high)
            stretch = tendon_strain(middle, self.strain)
            along = length - self.slack * (1.0 + stretch)
            more = self._active(along, speed, activation) > middle
            low = np.where(more, middle, low)
            high = np.where(more, high, middle)
        return self.peak * 0.5 * (low + high)

    def _active(self, along: FloatArray, speed: FloatArray, activation: FloatArray) -> FloatArray:
        """Active force along the tendon, of the largest, by the fibre's reach along it [m]."""
        reach = along / self.optimal
        fibre = np.hypot(reach, np.sin(self.pennation)) if self.pennation else reach
        slant = reach / fibre if self.pennation else np.ones_like(reach)
        bent = _FV[1] * slant * speed / (self.speed * self.optimal) + _FV[2]
        moving = activation * (_FV[0] * np.arcsinh(bent) + _FV[3])
        return np.asarray(moving * self._held(fibre) * slant)

    def _held(self, fibre: FloatArray) -> FloatArray:
        """Force-length curve, scaled about its optimum."""
        fibre = 1.0 + (fibre - 1.0) / self.width
        bells = (
            b1 * np.exp(-0.5 * ((fibre - b2) / (b3 + b4 * fibre)) ** 2) for b1, b2, b3, b4 in _FL
        )
        return np.asarray(sum(bells, start=np.zeros_like(fibre)))


def tendon_strain(force: FloatArray, strain: float) -> FloatArray:
    """Strain of OpenSim's tendon at a force in parts of the largest, where it is `strain`.

    De Groote et al. (2016), the curve's inverse with its offset at rest left out.
    """
    return np.asarray(strain * np.log1p(np.maximum(force, 0.0) / _TENDON) / np.log1p(1.0 / _TENDON))


def tendon_share(force: float) -> float:
    """The strain of OpenSim's tendon at a force, both in parts of the largest."""
    return float(tendon_strain(np.array(force), 1.0))


def passive_fibre(length: FloatArray) -> FloatArray:
    """Passive force of OpenSim's fibre, of the largest, at a length [optimal lengths].

    De Groote et al. (2016) as OpenSim has it: none at a fifth of the optimal length, the largest
    active one at 1.6.
    """
    none = np.exp(_PASSIVE * (_SHORTEST - 1.0) / _PASSIVE_STRAIN)
    grown = np.exp(_PASSIVE * (length - 1.0) / _PASSIVE_STRAIN)
    return np.asarray(np.maximum(grown - none, 0.0) / (np.exp(_PASSIVE) - none))


@dataclass(frozen=True, slots=True)
class MujocoMuscle:
    """``muscle`` of MuJoCo, on a tendon that is rigid there; its activation filter is linear.

    Its passive force stands on the same optimal length and is left out.
    """

    peak: float  #: Force at activation 1 and optimal length [N].
    optimal: float  #: L0 [m].
    slack: float  #: LT [m].
    lmin: float  #: Shortest and longest length with an active force [L0].
    lmax: float
    speed: float  #: Largest speed of shortening [L0/s].
    lag: float  #: Time constant of the activation [s].

    @classmethod
    def fitted(cls, held: HeldMuscle) -> "MujocoMuscle":
        """The muscle whose active force, held still, is nearest."""
        # both curves of speed fall alike at rest: ours by 1 + 1/mvsh, that of MuJoCo by 2
        speed = held.speed * 2.0 / (1.0 + 1.0 / MVSH)

        def of(at: FloatArray) -> MujocoMuscle:
            slack = float(held.optimum + (at[0] - 1.0) * held.optimal)
            low = float(1.0 - at[2])
            high = float(1.0 + at[3])
            peak = float(at[1] * held.peak)
            return cls(peak, held.optimal, slack, low, high, speed, held.lag)

        start = 0.5 * held.stretch / held.optimal, 1.0, 0.6, 0.6
        return held.nearest(of, [start], [-_SHIFT, 0.5, 0.1, 0.1], [_SHIFT, 2.0, _WIDE, _WIDE])

    def force(self, length: FloatArray, speed: FloatArray, activation: FloatArray) -> FloatArray:
        """Force [N] where the path is so long [m] and lengthens so fast [m/s]."""
        fibre = (length - self.slack) / self.optimal
        along = speed / (self.optimal * self.speed)
        # a bump of four parabolas between lmin, 1 and lmax
        side = np.where(fibre < 1.0, 1.0 - self.lmin, self.lmax - 1.0)
        away = np.abs(fibre - 1.0) / side
        bump = np.where(away < 0.5, 1.0 - 2.0 * away**2, 2.0 * np.maximum(1.0 - away, 0.0) ** 2)
        most = FECC - 1.0
        shorter = (np.clip(along, -1.0, 0.0) + 1.0) ** 2
        longer = FECC - (most - np.clip(along, 0.0, most)) ** 2 / most
        return self.peak * activation * bump * np.where(along < 0.0, shorter, longer)
