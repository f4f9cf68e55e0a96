"""What goes wrong while a trial runs: electrodes, torque, speed, effort, four times a second.

A fault is told once it fills a second, so within two of its begin, with what to do. What cannot be
known yet (the hum of an electrode that was never heard better) is told after the trial, if at all.
"""

import threading
from collections import deque
from collections.abc import Iterator
from dataclasses import dataclass, field
from typing import Any, NamedTuple

import numpy as np
import numpy.typing as npt

from surae.api import MUSCLE_NAMES, MUSCLES, Device
from surae.base.units import FloatArray
from surae.base.words import N_
from surae_workbench.live.showing import Roles
from surae_workbench.live.stream import Stream

#: Signals are looked at this often, over windows of this length [s].
EVERY = 0.25
_WINDOW = 1.0
#: Looks that a fault has to be there for, and to be gone for before it is told again.
_SEEN = 2
_GONE = 8
_AT_ONCE = ("torque-limit", "speed-limit", "angle-range")
#: Looks of which an effort is judged: a reaction to what is asked takes half a second.
_EFFORT_LOOKS = 6
#: What a signal usually is, is known after so many looks; so many are remembered.
_KNOWN = 8
_REMEMBERED = 480
#: Level of EMG below this part of what it is at rest: amplifiers' noise alone is more.
_SILENT = 0.05
#: Samples at the very end of the range, so many times as many as beside it, of so many different
#: values: a signal of a few steps of its converter is not clipped (`surae.quality.emg`).
_CLIPPED = 5
_EXCESS = 1.0
_VALUES = 50
#: Part of the power that is mains, in each half of the window, where there is no muscle; and how
#: many times what it was. Louder than the muscle ever was, the electrode is off.
_MAINS = (50.0, 60.0)
_SHARE = 0.5
_TIMES = 3.0
#: Steps of the mean, in the muscle's largest level and in its level of rest.
_OFFSET = 2.0
_OFFSET_REST = 20.0
#: Part of the device's limits from where on torque and speed are near them; and by how much a
#: speed exceeds the one that was asked for, which the device had agreed to.
_NEAR = 0.9
_FASTER = 1.05
#: The angle may be this far beyond the range that was agreed [rad].
_BEYOND = 0.035
#: A muscle has worked where its level was so many times that of rest; effort where none is asked
#: for, and none where some is, as a part of the largest so far.
_WORKED = 4.0
_TOO_MUCH = 0.3
_ASKED = 0.2
_NONE = 0.05
_SIDES = (("ta", ("ta",)), ("triceps", ("gl", "sol", "gm")))

_SILENCE = N_(
    "The electrode of the {muscle} is silent: look at its cable and the amplifier’s channel."
)
_CLIPPING = N_("The electrode of the {muscle} is clipped: lower the gain of its amplifier.")
_CAME_OFF = N_(
    "The electrode of the {muscle} picks up only mains hum ({mains} Hz): it seems to have come "
    "off. Stop, fix it, and begin again."
)
_HUMS = N_(
    "The electrode of the {muscle} hums at {mains} Hz: see whether it holds, look at the reference "
    "electrode, and keep its cable from the mains."
)
_LEFT_ZERO = N_("The electrode of the {muscle} has left its zero: look at its contact and cable.")
_RESTLESS = N_(
    "The leg should rest now, and the {muscle} works at {percent} % of its largest so far: ask the "
    "subject to relax."
)
_IDLE = {
    "triceps": N_(
        "The leg should work now, and the calf does not: ask the subject to push down; else look "
        "at its electrodes."
    ),
    "ta": N_(
        "The leg should work now, and the tibialis anterior does not: ask the subject to pull up; "
        "else look at its electrode."
    ),
}


class Alarm(NamedTuple):
    """What goes wrong now."""

    code: str
    role: str | None
    message: str  #: What, where, and what to do: one of the catalogue.
    given: dict[str, str]  #: What fills it in.

    @property
    def text(self) -> str:
        """It in English."""
        return self.message.format(**self.given)

    def shown(self) -> dict[str, Any]:
        """As pages and records have it, in English and by its parts."""
        return {**self._asdict(), "text": self.text}


@dataclass(slots=True)
class _Signal:
    """A channel's last second, and what it usually is."""

    rate_hz: float
    pieces: deque[tuple[float, FloatArray]] = field(default_factory=deque)  #: End [s], values.
    raw: bool = False  #: It goes both ways, as no envelope does.
    varied: bool = False
    #: Level, hum and mean of looks before, the newest apart: they may hold a fault.
    past: deque[tuple[float, float, float]] = field(
        default_factory=lambda: deque(maxlen=_REMEMBERED)
    )
    newest: deque[tuple[float, float, float]] = field(default_factory=deque)
    level: float = 0.0  #: Of the last half of the window.

    def take(self, time: float, values: FloatArray) -> None:
        self.pieces.append((time, values))
        while self.pieces[0][0] < time - _WINDOW:
            self.pieces.popleft()

    def window(self, now: float) -> FloatArray | None:
        """The last second, ours; None where that has not come."""
        kept = [values for time, values in self.pieces if time > now - _WINDOW - EVERY]
        window = np.concatenate(kept) if kept else np.empty(0)
        whole = self.rate_hz > 0 and len(window) >= 0.9 * _WINDOW * self.rate_hz
        return window if whole else None

    def keep(self, looked: tuple[float, float, float], fault: bool) -> None:
        """Remember a look, once it is known to be no fault's begin."""
        if fault:
            self.newest.clear()
            return
        self.newest.append(looked)
        if len(self.newest) > 6:
            self.past.append(self.newest.popleft())


class Watch:
    """Looks at what arrives; `device` has the limits, `span` is the range that was agreed [rad].

    None: no device was chosen, no range agreed, and nothing is held to one.
    """

    def __init__(self, device: Device | None, span: tuple[float, float] | None) -> None:
        self.roles: Roles = {}
        self.speed = 0.0  #: Largest that was asked for [rad/s].
        self.device = device
        self.span = span
        self._signals: dict[str, _Signal] = {}
        self._targets: deque[FloatArray] = deque(maxlen=_EFFORT_LOOKS)
        self._efforts: deque[dict[str, float | None]] = deque(maxlen=_EFFORT_LOOKS)
        self._seen: dict[tuple[str, str | None], int] = {}
        self._gone: dict[tuple[str, str | None], int] = {}
        self._active: dict[tuple[str, str | None], Alarm] = {}
        self._lock = threading.Lock()

    @property
    def active(self) -> list[Alarm]:
        """What is wrong now."""
        return list(self._active.values())

    def show(self, stream: Stream, times: FloatArray, values: npt.NDArray[Any]) -> None:
        """Take new samples of a stream."""
        with self._lock:
            for index, column in enumerate(stream.columns):
                if column in self.roles and stream.rate_hz > 0:
                    role, factor, offset = self.roles[column]
                    with np.errstate(over="ignore", invalid="ignore"):
                        signal = factor * values[:, index].astype(float) + offset
                    finite = signal[np.abs(signal) < 1e100]
                    known = self._signals.get(role)
                    if known is None or known.rate_hz != stream.rate_hz:
                        known = self._signals[role] = _Signal(stream.rate_hz)
                    if len(finite):
                        known.take(float(times[-1]), finite)

    def look(self, now: float, targets: FloatArray) -> list[Alarm]:
        """The alarms that are new; `targets` are the four efforts asked for at our `now`."""
        with self._lock:
            windows = {role: s.window(now) for role, s in self._signals.items()}
        alarms = [
            alarm
            for role, window in windows.items()
            if window is not None
            for alarm in self._looked(role, window)
        ]
        self._targets.append(targets)
        self._efforts.append({m: self._effort(m) for m in MUSCLES})
        alarms += self._wrong_effort({alarm.role for alarm in alarms})
        now_wrong = {(alarm.code, alarm.role): alarm for alarm in alarms}
        fresh = []
        for key, alarm in now_wrong.items():
            self._seen[key] = self._seen.get(key, 0) + 1
            self._gone[key] = 0
            if self._seen[key] >= (1 if alarm.code in _AT_ONCE else _SEEN):
                if key not in self._active:
                    fresh.append(alarm)
                self._active[key] = alarm
        for key in [key for key in self._seen if key not in now_wrong]:
            self._gone[key] += 1
            if key not in self._active or self._gone[key] >= _GONE:
                del self._seen[key], self._gone[key]
                self._active.pop(key, None)
        return fresh

    def _looked(self, role: str, window: FloatArray) -> Iterator[Alarm]:
        if role.startswith("emg_") and role[4:] in MUSCLE_NAMES:
            yield from self._electrode(role, window)
            return
        last = window[-round(EVERY * self._signals[role].rate_hz) :]
        if role == "torque" and self.device is not None:
            top = float(np.abs(last).max())
            most = self.device.max_torque
            if top >= _NEAR * most:
                yield Alarm(
                    "torque-limit",
                    role,
                    N_(
                        "The torque is {torque} Nm, {percent} % of what the device may: "
                        "ask for less effort, and be ready to stop."
                    ),
                    {"torque": f"{top:.0f}", "percent": f"{100 * top / most:.0f}"},
                )
        elif role == "angle":
            yield from self._moving(last, self._signals[role].rate_hz)

    def _moving(self, angle: FloatArray, rate_hz: float) -> Iterator[Alarm]:
        step = max(round(0.03 * rate_hz), 1)
        most = np.inf if self.device is None else self.device.max_velocity
        low = float(angle.min())
        high = float(angle.max())
        if len(angle) > step:
            speed = float(np.abs(angle[step:] - angle[:-step]).max()) * rate_hz / step
            if speed >= _NEAR * most and speed >= _FASTER * self.speed:
                given = {
                    "speed": f"{np.degrees(speed):.0f}",
                    "percent": f"{100 * speed / most:.0f}",
                }
                yield Alarm(
                    "speed-limit",
                    "angle",
                    N_(
                        "The foot turns at {speed} °/s, {percent} % of what the "
                        "device may: stop if "
                        "nobody wanted that."
                    ),
                    given,
                )
        if self.span is None:
            return
        if low < self.span[0] - _BEYOND or high > self.span[1] + _BEYOND:
            beyond = low if low < self.span[0] else high
            yield Alarm(
                "angle-range",
                "angle",
                N_(
                    "The ankle is at {angle}°, beyond the range that was agreed: "
                    "stop, and look at the "
                    "device’s zero."
                ),
                {"angle": f"{np.degrees(beyond):.0f}"},
            )

    def _electrode(self, role: str, window: FloatArray) -> Iterator[Alarm]:
        signal = self._signals[role]
        muscle = MUSCLE_NAMES[role[4:]]
        mean = float(window.mean())
        low = float(window.min())
        high = float(window.max())
        signal.raw |= low < -0.1 * high < 0.0
        signal.varied |= high > low
        level = float(window.std())
        half = window[len(window) // 2 :]
        signal.level = float(half.std()) if signal.raw else float(half.mean())
        mains, hum, alone = _hum(window - mean, signal.rate_hz)
        past = np.array(signal.past) if len(signal.past) >= _KNOWN else None
        alarms = []
        quiet = past is not None and level < _SILENT * np.quantile(past[:, 0], 0.1)
        if (high == low and not signal.varied) or (signal.raw and (high == low or quiet)):
            alarms.append(("silent", _SILENCE))
        elif _clipped(window, low, high, both=signal.raw):
            alarms.append(("clipped", _CLIPPING))
        elif signal.raw and alone and past is not None and hum > _TIMES * np.median(past[:, 1]):
            most = float(past[:, 0].max())
            rest = float(np.quantile(past[:, 0], 0.1))
            if hum > most > _WORKED * rest:
                alarms.append(("electrode-off", _CAME_OFF))
            else:
                alarms.append(("hum", _HUMS))
        if signal.raw and past is not None and not alarms:
            step = abs(mean - float(np.median(past[:, 2])))
            least = max(
                _OFFSET * past[:, 0].max(), _OFFSET_REST * float(np.quantile(past[:, 0], 0.1))
            )
            if step > least:
                alarms.append(("offset", _LEFT_ZERO))
        signal.keep((level, hum, mean), bool(alarms))
        given = {"muscle": muscle, "mains": f"{mains:.0f}"}
        yield from (Alarm(code, role, message, given) for code, message in alarms)

    def _effort(self, muscle: str) -> float | None:
        """Effort as a part of the largest so far; None where the muscle never worked."""
        signal = self._signals.get(f"emg_{muscle}")
        if signal is None or not signal.raw or len(signal.past) < _KNOWN:
            return None
        past = np.array([level for level, _, _ in signal.past])
        rest = float(np.quantile(past, 0.1))
        top = max(float(past.max()), signal.level)
        if top < _WORKED * rest:
            return 0.0 if signal.level < 2.0 * rest else None
        return (signal.level - rest) / (top - rest)

    def _wrong_effort(self, faulty: set[str | None]) -> Iterator[Alarm]:
        if len(self._targets) < _EFFORT_LOOKS:
            return
        targets = np.array(self._targets)
        if not targets.any():
            for muscle in MUSCLES:
                efforts = [looked[muscle] for looked in self._efforts]
                least = min((e for e in efforts if e is not None), default=0.0)
                if None not in efforts and least > _TOO_MUCH and f"emg_{muscle}" not in faulty:
                    given = {"muscle": MUSCLE_NAMES[muscle], "percent": f"{100 * least:.0f}"}
                    yield Alarm("effort", f"emg_{muscle}", _RESTLESS, given)
                    return
        for side, muscles in _SIDES:
            wanted = targets[:, [MUSCLES.index(m) for m in muscles]].max(axis=1).min()
            heard = [m for m in muscles if f"emg_{m}" not in faulty and f"emg_{m}" in self._signals]
            efforts = [looked[m] for looked in self._efforts for m in heard]
            if wanted >= _ASKED and efforts and all(e is not None and e < _NONE for e in efforts):
                yield Alarm("effort", f"emg_{heard[0]}", _IDLE[side], {})


def _hum(window: FloatArray, rate_hz: float) -> tuple[float, float, bool]:
    """Frequency of the mains [Hz], its amplitude's root mean square, and whether it is alone."""
    if rate_hz < 2.2 * _MAINS[-1]:
        return 0.0, 0.0, False
    halves = np.array_split(window, 2)
    best = (0.0, 0.0, False)
    for mains in _MAINS:
        lines = []
        for part in halves:
            wave = np.exp(-2j * np.pi * mains / rate_hz * np.arange(len(part)))
            lines.append(2.0 * abs(part @ wave) / len(part))
        power = [max(float(np.mean(part**2)), np.finfo(float).tiny) for part in halves]
        alone = all(0.5 * line**2 > _SHARE * size for line, size in zip(lines, power, strict=True))
        rms = float(min(lines)) / 2**0.5
        if rms > best[1]:
            best = (mains, rms, alone)
    return best


def _clipped(window: FloatArray, low: float, high: float, *, both: bool) -> bool:
    """Whether it stops at a plateau; an envelope rests at its lowest, so only its top counts."""
    if high == low or len(np.unique(window[:2000])) < _VALUES:
        return False
    for top, oriented in ((high, window), (-low, -window))[: 2 if both else 1]:
        there = oriented >= top - 1e-9 * (high - low)
        count = int(there.sum())
        beside = int((oriented >= top - 0.01 * (high - low)).sum()) - count
        if count >= _CLIPPED and count > _EXCESS * beside:
            return True
    return False
