"""What a trial asks of its device, limit by limit."""

import math
from dataclasses import dataclass, replace

import numpy as np

from surae.protocol import Protocol, Trajectory, generate
from surae.protocol.planning.information import model_inputs
from surae.protocol.planning.legs import population_legs
from surae.protocol.planning.plan import Limits
from surae.protocol.planning.torque import ProfilePlan, within_torque

#: Virtual legs that the torque is looked at of.
_LEGS = 20


@dataclass(frozen=True, slots=True)
class AskedLimit:
    """One limit of a device, and what a trial asks."""

    text: str  #: Both in words, and when the first is asked where it is more than the second.
    #: `value`, `limit`: what is asked at most, and what the device can do.
    value: float
    limit: float
    exceeded: bool  #: Whether the first is more than the second.


def requested_limits(
    trajectory: Trajectory, model: str = "muscle", population: str | None = None
) -> tuple[AskedLimit, ...]:
    """Every known limit of the trajectory's device, and what the trial asks of it.

    Parameters
    ----------
    trajectory : Trajectory
        The trial; its torque is that of twenty virtual legs.
    model, population : str
        Theirs: those that the trial was made for. Tendons that give way ask less of a device.
    """
    device = trajectory.settings.device
    if device is None:
        return ()
    torque = np.zeros(1)
    if device.max_torque is not None:
        legs = population_legs(model, population, _LEGS)
        inputs = model_inputs(trajectory, legs)
        simulator = legs.spec.simulator(inputs, legs.options)
        felt = np.array([simulator.torque(values) for values in legs.values])
        torque = np.abs(felt).max(axis=0)
    demands = [
        ("velocity", np.abs(trajectory.velocity), device.max_velocity, "rad/s"),
        ("acceleration", np.abs(trajectory.acceleration), device.max_acceleration, "rad/s²"),
        ("torque of virtual legs", torque, device.max_torque, "Nm"),
    ]  # fmt: skip
    if device.range_of_motion is not None:
        for end, sign in zip(device.range_of_motion, (-1.0, 1.0), strict=True):
            reached = sign * trajectory.angle
            demands.append(("plantarflexion" if sign < 0 else "dorsiflexion", reached,
                          sign * end, "rad"))  # fmt: skip
    limits = []
    for name, values, limit, unit in demands:
        if limit is None:
            continue
        value = float(values.max())
        exceeded = value > limit * (1.0 + 1e-9)
        when = trajectory.time[-1] * int(values.argmax()) / max(len(values) - 1, 1)
        relation = f" at {when:.1f} s, beyond" if exceeded else ", within"
        text = f"{name} {value:.3g} {unit}{relation} the {limit:.3g} {unit} of {device.name}"
        limits.append(AskedLimit(text, value, limit, exceeded))
    return tuple(limits)


def held_to_torque(settings: Protocol) -> tuple[Trajectory, tuple[str, ...]]:
    """A protocol of the thesis with which no virtual leg exceeds its device's torque.

    Parameters
    ----------
    settings : Protocol
        The protocol; where it asks for no more than the device can do, it is as it was.

    Returns
    -------
    Trajectory, tuple of str
        The protocol, and what was given up, a sentence each.

    Raises
    ------
    InputError
        Even relaxed legs ask for more; the message says what to give up.
    """
    trajectory = generate(settings)
    if not any(limit.exceeded for limit in requested_limits(trajectory)):
        return trajectory, ()
    whole = ProfilePlan.of(settings)
    legs = population_legs("muscle", None, _LEGS)
    limits = Limits(*settings.range_of_motion, math.inf, math.inf)
    plan, limits_held, notes = within_torque(whole, limits, legs, settings.device)
    trajectory = generate(replace(settings, range_of_motion=limits_held[:2]))
    return replace(trajectory, effort=plan.effort(trajectory.time)), notes
