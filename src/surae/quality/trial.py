"""A recording as the checks look at it: every signal once, on one coarse time axis."""

from collections.abc import Mapping
from dataclasses import dataclass, fields
from functools import lru_cache
from typing import Literal

import numpy as np

from surae.base.frozen import read_only
from surae.base.units import FloatArray
from surae.base.words import Message
from surae.model.joint import ANKLE, Joint
from surae.protocol.effort import effort, named_task
from surae.quality.commanded import Commanded, recognised
from surae.quality.electrodes import SLOW, Electrodes, electrodes_of
from surae.quality.numeric import BoolArray, correlation, smooth, span_of
from surae.quality.torque_model import TorqueModel, torque_model
from surae.recording import MUSCLES, Channel, Recording
from surae.recording.corrections import stated_unit
from surae.recording.emg_kind import emg_contradictions

#: Rate at which signals are compared [Hz]: fine enough for a reflex's 25 ms.
RATE = 100.0
#: Raw EMG is freed of all below about 40 Hz, as the preparation's high-pass does, by a moving
#: average of this length [s], whose first zero lies there.
_DETREND = 0.025
#: An angle beyond this [rad] is in degrees: no ankle turns by 115°.
IMPOSSIBLE_ANGLE = 2.0
#: Step at which the effort of a task is made [s]: bursts rise over a tenth of a second and more.
_STEP = 0.04
#: A burst pattern correlated with the EMG by more than this is the task that was shown. Of 400
#: virtual trials, the right task has 0.75 to 0.99, another one at most 0.45.
_RECOGNISED = 0.6
#: The same where only few bursts, of less than `_FEW` seconds, are compared: there, chance has
#: reached 0.8.
_FEW = 12.0
_RECOGNISED_FEW = 0.88


@dataclass(frozen=True, slots=True)
class Signals:
    """A recording's signals on one axis."""

    #: What the EMG's values say it is, whatever the recording says.
    emg_kind: Literal["raw", "envelope"]
    time: FloatArray  #: Uniform axis over the span that all channels share [s], shape (n,).
    rate_hz: float  #: Its rate: `RATE`, or that of the slowest channel where this is lower.
    angle: FloatArray  #: [rad], degrees under the name of radians undone, shape (n,).
    torque: FloatArray | None  #: [Nm], shape (n,).
    fast: dict[str, FloatArray]  #: Envelopes by muscle, averaged over one step, shape (n,).


@dataclass(frozen=True, slots=True, kw_only=True)
class CheckedTrial(Signals):
    """What the checks share."""

    recording: Recording  #: As it was read; checks of single samples look at its channels.
    velocity: FloatArray  #: [rad/s], shape (n,).
    slow: dict[str, FloatArray]  #: Envelopes by muscle, averaged over `SLOW`, shape (n,).
    commanded: Commanded | None  #: The motion that the device was to follow, given or recognised.
    effort: FloatArray | None  #: The requested effort, given or recognised, shape (n, 4).
    #: What torque, angle and EMG have to do with each other; None without torque.
    model: TorqueModel | None
    electrodes: Electrodes  #: What all trials of the leg show of each electrode that varies here.
    joint: Joint = ANKLE  #: The joint, whose words findings have.

    @property
    def span(self) -> tuple[float, float]:
        """First and last instant [s]."""
        return span_of(self.time)

    @property
    def emg(self) -> dict[str, Channel]:
        """The EMG channels by muscle, those too that are constant."""
        channels = self.recording.channels
        return {m: channels[f"emg_{m}"] for m in MUSCLES if f"emg_{m}" in channels}

    @property
    def varying(self) -> dict[str, Channel]:
        """The EMG channels by muscle that are not constant."""
        return {muscle: channel for muscle, channel in self.emg.items() if muscle in self.slow}

    @property
    def names(self) -> Mapping[str, Message]:
        """What the muscles of the channels are called."""
        return dict(zip(MUSCLES, map(Message, self.joint.muscles), strict=True))

    @property
    def triceps(self) -> tuple[str, ...]:
        """The heads of the triceps surae that have EMG which is not constant."""
        return tuple(m for m in MUSCLES[1:] if m in self.slow)

    def group(self, name: Literal["triceps", "ta"], *, fast: bool = False) -> FloatArray | None:
        """Mean envelope of the triceps' heads, or that of TA; None without EMG of it."""
        source = self.fast if fast else self.slow
        muscles = self.triceps if name == "triceps" else ("ta",) if "ta" in source else ()
        if not muscles:
            return None
        return np.asarray(np.mean([source[m] for m in muscles], axis=0))


def trial_of(
    recording: Recording,
    commanded: Commanded | None = None,
    signals: Signals | None = None,
    joint: Joint = ANKLE,
    electrodes: Electrodes | None = None,
    *,
    modelled: bool = True,
) -> CheckedTrial:
    """Bring a recording's signals to what the checks compare.

    The channels share a span of time. A commanded profile that is not given is recognised from the
    angle where it can be. `electrodes` are what all trials of the leg show; without them the trial
    is judged against itself. What is not `modelled` has no model of its torque, no profile and no
    effort, which take long.
    """
    seen = signals or signals_of(recording)
    time = seen.time
    rate = seen.rate_hz
    torque = seen.torque
    slow = {muscle: smooth(e, round(SLOW * rate)) for muscle, e in seen.fast.items()}
    velocity = np.gradient(seen.angle, 1.0 / rate) if len(time) > 2 else np.zeros_like(time)
    known = electrodes_of(recording, seen.fast, rate)
    if electrodes is not None:
        known = Electrodes({**known.levels, **electrodes.levels}, electrodes.trials)
    model = None
    if modelled and torque is not None:
        model = torque_model(time, rate, seen.angle, torque, seen.fast)
    profile = commanded
    asked = None
    if modelled:
        profile = commanded or recognised(recording.channels["angle"])
        asked = _requested_effort(time, slow, commanded)
    return CheckedTrial(
        *(getattr(seen, field.name) for field in fields(seen)),
        recording=recording,
        velocity=velocity,
        slow=slow,
        model=model,
        electrodes=known,
        joint=joint,
        commanded=profile,
        effort=asked,
    )


def signals_of(recording: Recording) -> Signals:
    """Signals at the instants of one axis, averaged over its step."""
    channels = recording.signals
    rate = min(RATE, *(c.rate_hz for c in channels.values()))
    start, end = recording.shared
    time = start + np.arange(max(int((end - start) * rate), 1) + 1) / rate
    kind = emg_kind(recording)
    angle = to_radians(channels["angle"]) * sampled(channels["angle"], time, rate)
    torque = sampled(channels["torque"], time, rate) if "torque" in channels else None
    fast = {}
    for muscle in MUSCLES:
        channel = channels.get(f"emg_{muscle}")
        if channel is not None and float(np.ptp(values := channel.values)) > 0.0:
            if kind == "raw":
                values = np.abs(values - smooth(values, round(_DETREND * channel.rate_hz)))
            fast[muscle] = sampled(channel, time, rate, values)
    return Signals(kind, time, rate, angle, torque, fast)


def emg_kind(recording: Recording) -> Literal["raw", "envelope"]:
    """Whether EMG is raw or an envelope: as it is declared, unless most of it looks otherwise."""
    emg = [c for role, c in recording.channels.items() if role.startswith("emg_")]
    alive = [c for c in emg if float(np.ptp(c.values)) > 0.0]
    if 2 * len(emg_contradictions(recording)) <= len(alive):
        return recording.emg
    return "envelope" if recording.emg == "raw" else "raw"


def to_radians(angle: Channel) -> float:
    """The factor of an angle that may be in degrees under the name of radians."""
    far = float(np.abs(angle.values).max()) > IMPOSSIBLE_ANGLE
    return np.pi / 180.0 if far and stated_unit(angle) == "rad" else 1.0


def sampled(
    channel: Channel, time: FloatArray, rate: float, values: FloatArray | None = None
) -> FloatArray:
    """A channel (or what was made of it) at the instants of `time`, averaged between them."""
    values = channel.values if values is None else values
    averaged = smooth(values, round(channel.rate_hz / rate))
    return np.interp(time, channel.time, averaged)


def _requested_effort(
    time: FloatArray, slow: dict[str, FloatArray], commanded: Commanded | None
) -> FloatArray | None:
    """The requested effort: as given, else the task whose bursts the EMG shows."""
    if commanded is not None and commanded.effort is not None:
        columns = [np.interp(time, commanded.time, column) for column in commanded.effort.T]
        return np.column_stack(columns)
    since = time - time[0]
    if not slow or since[-1] < named_task("part-passive").passive_until + 3.0:
        return None
    # Both tasks are judged where both ask for effort.
    late = since > named_task("part-passive").passive_until
    few = float(late.sum()) < _FEW * (len(time) - 1) / float(since[-1])
    best = _RECOGNISED_FEW if few else _RECOGNISED
    recognised_effort = None
    for name in ("part-passive", "active"):
        few_times, efforts = _sparse_effort(name, int(since[-1] / _STEP))
        requested = np.column_stack([np.interp(since, few_times, each) for each in efforts])
        alike = match(requested, slow, late)
        if alike > best:
            best = alike
            recognised_effort = requested
    return recognised_effort


@lru_cache(8)
def _sparse_effort(task: str, steps: int) -> tuple[FloatArray, FloatArray]:
    """The effort of a task at few instants, made once for trials of one length."""
    few = _STEP * np.arange(steps + 1.0)
    return read_only(few), read_only(effort(few, named_task(task)).T.copy())


def match(requested: FloatArray, slow: dict[str, FloatArray], where: BoolArray) -> float:
    """Mean correlation of the requested effort with the envelopes."""
    alike = [correlation(requested[where, MUSCLES.index(m)], e[where]) for m, e in slow.items()]
    return float(np.mean(alike))
