"""A designed protocol as few numbers: ramps between holds, small perturbations, bursts of effort.

θ(t) = low + (high − low − 2a)·f(t) + a + Σ Aₖ·wₖ(t)·sin φₖ(t),   a(t) = Σ Aₖ·wₖ(t)

f goes from 0 to 1 by ramps at constant speed with minimum-jerk ends; a perturbation is a chirp
under a window. The base makes room for the perturbations, so the angle cannot leave its range,
whatever the numbers; what they may add to velocity and acceleration is bounded sample by sample by
what the base leaves of the limits, so these hold too (`Limits`).
"""

from collections.abc import Sequence
from dataclasses import dataclass, replace
from typing import Any, NamedTuple, TypeVar

import numpy as np

from surae.base.errors import InputError
from surae.base.units import FloatArray
from surae.planning.kernels import plan_motion
from surae.protocol import Device, Given, Trajectory, allowed_range
from surae.protocol.adaptation import Motion
from surae.protocol.effort import Burst, burst_effort
from surae.protocol.profiles import Ramp

#: What has bursts, and can be asked for with less effort.
_Plan = TypeVar("_Plan", bound=Any)
#: The movement is checked against its limits at this rate at least [Hz].
_FINE_RATE = 256.0
#: Rounding must not make a limit exceeded.
EXACT = 1.0 - 1e-9
#: Velocity [rad/s], acceleration [rad/s²] and frequency [Hz] that are not exceeded where a device's
#: own limit is not known.
UNKNOWN = (1.5, 100.0, 8.0)


class Limits(NamedTuple):
    """What a movement must keep: its range [rad], velocity [rad/s] and acceleration [rad/s²]."""

    low: float
    high: float
    velocity: float
    acceleration: float


def limits_of(device: Device | None, angle_range: tuple[float, float]) -> Limits:
    """What a movement over this range must keep on a device."""
    low, high = allowed_range(device, angle_range)
    if high - low < 0.05:
        raise InputError(f"range {low:g} … {high:g} rad is too narrow to move in; widen it")
    velocity, acceleration, _ = UNKNOWN
    if device is not None:
        velocity = device.max_velocity if np.isfinite(device.max_velocity) else velocity
        limit = device.acceleration_limit
        acceleration = min(limit, 1e6) if np.isfinite(limit) else acceleration
    inside = (1.0 - EXACT) * (high - low)
    return Limits(low + inside, high - inside, velocity * EXACT, acceleration * EXACT)


def highest_hz(device: Device | None) -> float:
    """Highest frequency of a perturbation [Hz]."""
    return UNKNOWN[2] if device is None else min(device.bandwidth, UNKNOWN[2])


class Shake(NamedTuple):
    """A small perturbation."""

    #: `onset`, `length`: when it begins, and how long it lasts [s].
    onset: float
    length: float
    amplitude: float  #: At most [rad].
    #: `first_hz`, `last_hz`: its frequency goes linearly from one to the other.
    first_hz: float
    last_hz: float


@dataclass(frozen=True, slots=True)
class Plan:
    """A designed protocol."""

    name: str  #: What it is called.
    seconds: float  #: Duration [s].
    origin: float  #: Where it begins, as a part of the range of motion.
    blend: float  #: Time in which a ramp gains or loses its speed [s].
    ramps: tuple[Ramp, ...]  #: Speeds in ranges of motion per second.
    shakes: tuple[Shake, ...]  #: Perturbations.
    bursts: tuple[Burst, ...]  #: The subject's efforts.

    def motion(self, t: FloatArray, limits: Sequence[float]) -> Motion:
        """Angle, velocity and acceleration at increasing times `t`; they keep the limits there."""
        low, high, fastest, sharpest = limits
        angle, velocity, acceleration = plan_motion(
            t,
            _rows(self.ramps, 3),
            (self.origin, self.blend),
            _rows(self.shakes, 5),
            (low, high, fastest, sharpest),
        )
        return angle, velocity, acceleration

    def trajectory(
        self,
        limits: Sequence[float],
        rate_hz: float,
        *,
        device: Device | None = None,
        legs: str = "muscle",
        fine_hz: float = _FINE_RATE,
    ) -> Trajectory:
        """The protocol sampled at a rate; `limits` (`Limits`) are kept at `fine_hz` at least.

        `legs` names the model of the virtual legs by which its torque is judged.

        Raises
        ------
        InputError
            The rate gives fewer than three samples.
        """
        if not self.seconds * rate_hz >= 2.0:
            raise InputError(f"rate {rate_hz:g} Hz: use one that gives three samples or more")
        times = max(int(np.ceil(fine_hz / rate_hz - 1e-9)), 1)
        n = int(self.seconds * rate_hz + 1e-9) + 1
        fine = np.arange((n - 1) * times + 1) / (rate_hz * times)
        angle, velocity, acceleration = (x[::times] for x in self.motion(fine, limits))
        time = np.arange(n) / rate_hz
        task = "designed" if self.bursts else "passive"
        settings = Given(
            profile=self.name,
            task=task,
            angle_range=(limits[0], limits[1]),
            rate_hz=rate_hz,
            device=device,
            legs=legs,
        )
        effort = burst_effort(time, self.bursts)
        return Trajectory(settings, time, angle, velocity, acceleration, effort)


def eased(plan: _Plan, part: float) -> _Plan:
    """A plan with all effort times `part`."""
    bursts = (burst._replace(level=part * burst.level) for burst in plan.bursts)
    return replace(plan, bursts=tuple(bursts))


def _rows(items: Sequence[Ramp | Shake], width: int) -> FloatArray:
    return np.array(items, dtype=np.float64).reshape(len(items), width)
