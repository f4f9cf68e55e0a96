"""What a trial asks of its device, limit by limit."""

from dataclasses import dataclass

import numpy as np

from surae.planning.information import model_inputs
from surae.planning.legs import population_legs
from surae.protocol import Trajectory

#: Virtual legs that the torque is looked at of.
_LEGS = 20


@dataclass(frozen=True, slots=True)
class AskedLimit:
    """One limit of a device, and what a trial asks.

    Attributes
    ----------
    text : str
        Both in words.
    value, limit : float
        What is asked at most, and what the device can do.
    exceeded : bool
        Whether the first is more than the second.
    """

    text: str
    value: float
    limit: float
    exceeded: bool


def asked_limits(
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
    torque = 0.0
    if device.max_torque is not None:
        legs = population_legs(model, population, _LEGS)
        inputs = model_inputs(trajectory, legs)
        simulator = legs.spec.simulator(inputs, legs.options)
        felt = np.array([simulator.torque(values) for values in legs.values])
        torque = float(np.abs(felt).max())
    asked = [
        ("velocity", float(np.abs(trajectory.velocity).max()), device.max_velocity, "rad/s"),
        ("acceleration", float(np.abs(trajectory.acceleration).max()),
         device.max_acceleration, "rad/s²"),
        ("torque of virtual legs", torque, device.max_torque, "Nm"),
    ]  # fmt: skip
    if device.range_of_motion is not None:
        for end, sign in zip(device.range_of_motion, (-1.0, 1.0), strict=True):
            reached = float((sign * trajectory.angle).max())
            asked.append(("plantarflexion" if sign < 0 else "dorsiflexion", reached,
                          sign * end, "rad"))  # fmt: skip
    made = []
    for what, value, limit, unit in asked:
        if limit is None:
            continue
        exceeded = value > limit * (1.0 + 1e-9)
        relation = "beyond" if exceeded else "within"
        text = f"{what} {value:.3g} {unit}, {relation} the {limit:.3g} {unit} of {device.name}"
        made.append(AskedLimit(text, value, limit, exceeded))
    return tuple(made)
