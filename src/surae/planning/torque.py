"""Plans and protocols held to the torque of their device, whatever the leg asks of it.

Relaxed tissue cannot be asked for less: where stiff legs ask too much at an end of the range, the
range ends a little earlier, or the device is refused. Each burst of effort is then lowered as far
as its own torque asks for.
"""

import math
from dataclasses import dataclass, replace
from functools import lru_cache
from typing import TypeVar

import numpy as np

from surae.base.errors import InputError
from surae.base.units import FloatArray
from surae.base.words import Message
from surae.model.laboratory import richest
from surae.planning.information import model_inputs
from surae.planning.legs import Legs, population_legs
from surae.planning.plan import EXACT, Limits, Plan, eased
from surae.protocol import Device, Protocol, Trajectory, generate
from surae.protocol.effort import GAP, Burst, burst_effort, task_bursts

#: Part of the range that is given up without asking, and the steps in which it is looked for.
_GIVEN_UP = 0.12
_STEP = 0.01
#: Rate at which torques are looked at [Hz], how long a burst is felt after its end [s], and how
#: often bursts are lowered until the whole is.
_RATE = 100.0
_AFTER = 0.8
_ROUNDS = 6

#: One movement with its efforts lowered again and again is adapted to its device once.
_moved = lru_cache(maxsize=2)(generate)
#: Samples to each period of a chirp's last and fastest turn, at least.
_PER_PERIOD = 4.0


@dataclass(frozen=True, slots=True)
class ProfilePlan:
    """A protocol of the thesis, whose range and efforts can be given up."""

    settings: Protocol  #: What it is.
    bursts: tuple[Burst, ...]  #: The subject's efforts.

    def trajectory(self, limits: Limits, rate_hz: float) -> Trajectory:
        """The protocol over a range, at a multiple of a rate at which its chirp can be sampled."""
        settings = self.settings
        fastest = _PER_PERIOD * settings.chirp_rate * settings.seconds
        times = max(math.ceil(fastest / rate_hz), 1) if settings.chirp_amplitude > 0.0 else 1
        moved = _moved(replace(settings, angle_range=limits[:2], rate_hz=times * rate_hz))
        return replace(moved, effort=self.effort(moved.time))

    def effort(self, time: FloatArray) -> FloatArray:
        """The requested effort at increasing times [s], shape (n, 4)."""
        task = self.settings.effort_task
        return burst_effort(time, self.bursts, task.turns, task.rise)


#: What can be held to a torque: a designed protocol, or one of the thesis.
_Plan = TypeVar("_Plan", Plan, ProfilePlan)


def torques(
    plan: Plan | ProfilePlan, limits: Limits, legs: Legs, rate_hz: float = _RATE
) -> FloatArray:
    """Torque that each leg asks of the device, shape (n_legs, n) [Nm]; NaN where none is."""
    return _felt(plan.trajectory(limits, rate_hz), legs, rate_hz)


def _felt(trajectory: Trajectory, legs: Legs, rate_hz: float = _RATE) -> FloatArray:
    inputs = model_inputs(trajectory, legs, rate_hz)
    simulator = legs.spec.simulator(inputs, legs.options)
    with np.errstate(over="ignore", invalid="ignore"):
        return np.array([simulator.torque(values) for values in legs.values])


def within_torque(
    plan: _Plan, limits: Limits, legs: Legs, device: Device | None
) -> tuple[_Plan, Limits, tuple[Message, ...]]:
    """Plan and range with which no leg exceeds the torque, and their cost; or what to give up."""
    if device is None or math.isinf(device.max_torque):
        return plan, limits, ()
    limit = device.max_torque * EXACT
    notes = list[Message]()
    of = {"device": device.name, "limit": device.max_torque}
    narrowed = _narrowed(plan, limits, legs, device, limit)
    if narrowed != limits:
        (low, high) = narrowed[:2]
        (of_low, of_high) = limits[:2]
        ends = {"low": low, "high": high, "of_low": of_low, "of_high": of_high}
        notes.append(Message("plan/narrowed", **of, **ends))
    held = _eased(plan, narrowed, legs, limit)
    if held != plan:
        before, after = (sum(b.level * b.length for b in p.bursts) for p in (plan, held))
        notes.append(Message("plan/lowered", **of, percent=100 * (1 - after / before)))
    most = float(np.nanmax(np.abs(torques(held, narrowed, legs))))
    notes.append(Message("plan/most", **of, n=len(legs.values), most=most))
    return held, narrowed, tuple(notes)


def _narrowed(
    plan: Plan | ProfilePlan, limits: Limits, legs: Legs, device: Device, limit: float
) -> Limits:
    """The range over which relaxed legs ask no more than the limit."""
    relaxed = eased(plan, 0.0)
    span = limits.high - limits.low

    def narrower(lower: float, upper: float) -> Limits:
        return limits._replace(low=limits.low + lower * span, high=limits.high - upper * span)

    lower = upper = 0.0
    least = most = 0.0
    while lower + upper <= 0.7:
        torque = torques(relaxed, narrower(lower, upper), legs)
        least, most = (least, most) if most else (float(torque.min()), float(torque.max()))
        if max(float(torque.max()), -float(torque.min())) <= limit:
            break
        lower += _STEP if -float(torque.min()) > limit else 0.0
        upper += _STEP if float(torque.max()) > limit else 0.0
    if lower + upper <= _GIVEN_UP:
        return narrower(lower, upper) if lower + upper > 0.0 else limits
    advice = "choose a stronger device"
    if lower + upper <= 0.7:
        inner = narrower(lower, upper)
        advice = (
            f"give up the ends of the range (--range {inner.low:.2f}:{inner.high:.2f}), or {advice}"
        )
    raise InputError(
        f"{device.name} has {device.max_torque:g} Nm, but moving these legs over {limits.low:.2f} "
        f"… {limits.high:.2f} rad takes {max(most, -least):.3g} Nm even relaxed; {advice}"
    )


def _eased(plan: _Plan, limits: Limits, legs: Legs, limit: float) -> _Plan:
    """The plan with each burst as low as its own torque asks for."""
    if not plan.bursts:
        return plan
    relaxed = torques(eased(plan, 0.0), limits, legs)
    time = np.arange(relaxed.shape[1]) / _RATE
    for _ in range(_ROUNDS):
        needed = torques(plan, limits, legs)
        over = np.abs(needed) > limit
        if not over.any():
            return plan
        added = needed - relaxed
        left = np.where(added > 0.0, limit - relaxed, limit + relaxed)
        with np.errstate(divide="ignore", invalid="ignore"):
            part = np.where(over, np.clip(0.99 * left / np.abs(added), 0.0, 1.0), 1.0).min(axis=0)
        lowered = []
        for burst in plan.bursts:
            felt = (time >= burst.onset) & (time <= burst.onset + burst.length + GAP + _AFTER)
            lowered.append(burst._replace(level=burst.level * float(part[felt].min(initial=1.0))))
        plan = replace(plan, bursts=tuple(lowered))
    while np.abs(torques(plan, limits, legs)).max() > limit:
        plan = eased(plan, 0.9)
    return plan


#: Virtual legs that the torque is looked at of.
_LEGS = 20


@dataclass(frozen=True, slots=True)
class AskedLimit:
    """One limit of a device, and what a trial asks."""

    message: Message  #: Both in words, and when the first is asked for if it is too much.
    #: `value`, `limit`: what is asked at most, and what the device can do.
    value: float
    limit: float
    exceeded: bool  #: Whether the first is more than the second.


@dataclass(frozen=True, slots=True)
class Load:
    """What a movement asks of a device and of a leg in it: one number, whoever asks.

    Torque is that of `_LEGS` virtual legs, half of them patients', of the model that the movement
    was made for: about one leg in twenty asks for more (their 95th percentile).
    """

    angle: tuple[float, float]  #: Least and greatest angle [rad].
    speed: float  #: Highest speed [rad/s].
    acceleration: float  #: Highest acceleration [rad/s²].
    torque: tuple[float, float]  #: Least and greatest torque [Nm].

    @property
    def text(self) -> str:
        """It in words."""
        return self.message

    @property
    def message(self) -> Message:
        """It in words, and their parts."""
        low, high = self.torque
        return Message("plan/load", low=low, high=high, speed=math.degrees(self.speed))


def load_of(trajectory: Trajectory) -> Load:
    """What a movement asks of a device and of a leg in it."""
    torque = _of_population(trajectory)
    return Load(
        (float(trajectory.angle.min()), float(trajectory.angle.max())),
        float(np.abs(trajectory.velocity).max()),
        float(np.abs(trajectory.acceleration).max()),
        (float(torque.min()), float(torque.max())),
    )


def _of_population(trajectory: Trajectory) -> FloatArray:
    return _felt(trajectory, population_legs(richest(trajectory.settings.legs), None, _LEGS))


def requested_limits(trajectory: Trajectory) -> tuple[AskedLimit, ...]:
    """Every known limit of the trajectory's device, and what the trial asks of it (`Load`)."""
    device = trajectory.settings.device
    if device is None:
        return ()
    torque = np.zeros(1)
    if math.isfinite(device.max_torque):
        torque = np.abs(_of_population(trajectory)).max(axis=0)
    demands = [
        ("velocity", np.abs(trajectory.velocity), device.max_velocity, "rad/s"),
        ("acceleration", np.abs(trajectory.acceleration), device.max_acceleration, "rad/s²"),
        ("torque", torque, device.max_torque, "Nm"),
    ]
    if device.angle_range is not None:
        for end, sign in zip(device.angle_range, (-1.0, 1.0), strict=True):
            reached = sign * trajectory.angle
            way = "plantarflexion" if sign < 0 else "dorsiflexion"
            demands.append((way, reached, sign * end, "rad"))
    limits = []
    for name, values, limit, unit in demands:
        if math.isinf(limit):
            continue
        value = float(values.max())
        exceeded = value > limit * (1.0 + 1e-9)
        when = trajectory.time[-1] * int(values.argmax()) / max(len(values) - 1, 1)
        message = Message(
            "plan/beyond" if exceeded else "plan/within",
            what=Message(f"plan/asked/{name}"),
            value=value,
            limit=limit,
            unit=unit,
            device=device.name,
            when=when,
        )
        limits.append(AskedLimit(message, value, limit, exceeded))
    return tuple(limits)


def held_to_torque(settings: Protocol) -> tuple[Trajectory, tuple[Message, ...]]:
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
    bursts = task_bursts(settings.effort_task, float(trajectory.time[-1]))
    whole = ProfilePlan(settings, tuple(bursts))
    legs = population_legs("muscle", None, _LEGS)
    limits = Limits(*settings.angle_range, math.inf, math.inf)
    plan, limits_held, notes = within_torque(whole, limits, legs, settings.device)
    trajectory = generate(replace(settings, angle_range=limits_held[:2]))
    return replace(trajectory, effort=plan.effort(trajectory.time)), notes
