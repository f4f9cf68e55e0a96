"""A laboratory to practise with: a manipulator with a virtual leg in it, streaming in real time.

It runs in a process of its own and speaks only LSL: it hears words on one stream (`CONTROL`) and
sends angle and torque on one, raw EMG on another. Faults come on command.
"""

import json
import threading
import time
from collections.abc import Mapping
from contextlib import suppress
from dataclasses import replace
from typing import TYPE_CHECKING, Any

import numpy as np

from surae.api import smooth_step
from surae.base.frozen import read_only
from surae.base.units import FloatArray
from surae.processes import tell
from surae_workbench.live.lsl import lsl, outlet

if TYPE_CHECKING:
    from surae.api import Trajectory

#: Sources: of the words that the laboratory hears, and of the streams that it sends.
CONTROL = "surae-live-control"
MANIPULATOR = "surae-rehearsal-device"
EMG = "surae-rehearsal-emg"
#: Rates [Hz] and how often samples are sent [s].
_RATE = 2048.0
_DEVICE_EVERY = 2
_STEP = 0.01
#: The torque's sensor is this much later than the muscles [s].
_TORQUE_DELAY = 0.02
#: The device goes to where a trial begins within this [s].
_RETURN = 2.0
#: What an electrode hears that has fallen off [V], and mains on a bad one.
_OFF = 2e-3
_HUM = 3e-4
FAULTS = ("electrode-off", "hum", "torque-sign", "angle-sign", "dropout")


def run(seed: int) -> None:
    """Stream the virtual leg of a seed until this process ends."""
    laboratory = _Laboratory(seed)
    from surae.api import Protocol, generate

    first = generate(Protocol(profile="sine", task="active", duration=5.0, rate_hz=256.0))
    laboratory.load(first, trial=0)  # compiles what trials need
    tell({"ready": True})
    laboratory.stream()


class _Laboratory:
    """The device, the leg in it and the amplifier."""

    def __init__(self, seed: int) -> None:
        from surae.api import realistic_imperfections, virtual_subject

        self._lsl = lsl()
        self._leg = virtual_subject(seed)
        self._imperfections = realistic_imperfections(self._leg)
        self._device, self._emg = self._outlets()
        self._looking = self._lsl.ContinuousResolver(prop="source_id", value=CONTROL)
        self._rng = np.random.default_rng(seed)
        self._trial: FloatArray | None = None  # shape (n, 6): angle, torque, EMG
        self._begin: float | None = None
        self._from = self._to = np.zeros(6)
        self._left = 0.0
        self._faults: list[dict[str, Any]] = []

    def _outlets(self) -> tuple[Any, Any]:
        from surae.api import MUSCLES

        rate = _RATE / _DEVICE_EVERY
        return (
            outlet(
                "manipulator", "Mechanics", ["angle", "torque"], ["rad", "Nm"], rate, MANIPULATOR
            ),
            outlet("EMG", "EMG", [f"emg_{m}" for m in MUSCLES], ["V"] * 4, _RATE, EMG),
        )

    def load(self, trajectory: "Trajectory", trial: int) -> None:
        """Compute what the leg will do in the next trial."""
        from surae.api import virtual_recording

        recording = virtual_recording(
            self._leg, _finer(trajectory), seed=trial, imperfections=self._imperfections
        )
        signals = np.column_stack([channel.values for channel in recording.channels.values()])
        late = round(_TORQUE_DELAY * _RATE)
        signals[late:, 1] = signals[:-late, 1].copy()
        self._trial = signals
        self._go(signals[0] * [1, 1, 0, 0, 0, 0])

    def stream(self) -> None:
        """Send what there is to send, in real time."""
        words = None
        clock = self._lsl.local_clock
        sent = 0
        start = clock()
        while True:
            time.sleep(_STEP)
            words = self._heard(words)
            due = int((clock() - start) * _RATE) // _DEVICE_EVERY * _DEVICE_EVERY
            if due <= sent:
                continue
            times = start + np.arange(sent, due) / _RATE
            self._send(times, self._signals(times))
            sent = due

    def _heard(self, words: Any) -> Any:
        """Do what was said, if anything was; the stream of words, found again where it is lost."""
        if words is None:
            for info in self._looking.results():
                with suppress(RuntimeError):  # it is gone again
                    words = self._lsl.StreamInlet(info, recover=False)
                    words.open_stream(1.0)
                    tell({"hears": True})
            return words
        try:
            sample, _ = words.pull_sample(timeout=0.0)
        except self._lsl.util.LostError:
            return None
        if sample is not None:
            word = json.loads(sample[0])
            tell({"heard": word.pop("number")})
            getattr(self, f"_do_{word.pop('do')}")(word)
        return words

    def _do_load(self, word: Mapping[str, Any]) -> None:
        def work() -> None:
            self.load(read_protocol(word["path"]), word["trial"])
            time.sleep(_RETURN)
            tell({"loaded": word["trial"]})

        from surae.api import read_protocol

        threading.Thread(target=work, daemon=True).start()  # the streams go on

    def _go(self, to: FloatArray) -> None:
        """Move gently to a position from where the device is, within `_RETURN`."""
        now = float(self._lsl.local_clock())
        self._from = self._resting(np.array([now]))[0]
        self._to = to
        self._left = now

    def _resting(self, times: FloatArray) -> FloatArray:
        """Angle, torque and EMG between trials, shape (n, 6)."""
        share = smooth_step((times - self._left) / _RETURN)[:, None]
        return (1.0 - share) * self._from + share * self._to

    def _do_start(self, word: Mapping[str, Any]) -> None:
        self._begin = float(word["at"])

    def _do_stop(self, word: Mapping[str, Any]) -> None:
        """Stay where it is; the next trial's beginning is gone to when it is loaded."""
        del word
        if self._begin is not None:
            now = np.array([float(self._lsl.local_clock())])
            self._from = self._to = self._signals(now)[0] * [1, 1, 0, 0, 0, 0]
            self._begin = None

    def _do_fault(self, word: Mapping[str, Any]) -> None:
        """A fault from `at` seconds of the trial on, or at once; "none" ends all."""
        if word["kind"] == "none":
            self._faults = []
        else:
            self._faults.append({"now": float(self._lsl.local_clock()), **word})

    def _signals(self, times: FloatArray) -> FloatArray:
        """Angle, torque and EMG at some times, shape (n, 6)."""
        signals = self._resting(times)
        if self._begin is not None and self._trial is not None:
            index = np.round((times - self._begin) * _RATE).astype(int)
            inside = (index >= 0) & (index < len(self._trial))
            signals[inside] = self._trial[index[inside]]
            signals[index >= len(self._trial)] = self._trial[-1] * [1, 1, 0, 0, 0, 0]
        signals[:, 1] += 0.05 * self._rng.standard_normal(len(times))
        signals[:, 2:] += 2e-6 * self._rng.standard_normal((len(times), 4))
        return signals

    def _send(self, times: FloatArray, signals: FloatArray) -> None:
        send = {"manipulator": True, "EMG": True}
        for fault in self._faults:
            since = fault["now"]
            if "at" in fault:
                since = np.inf if self._begin is None else self._begin + fault["at"]
            on = times >= since
            if not on.any():
                continue
            kind = fault["kind"]
            column = 2 + int(fault.get("muscle", 2))
            hum = np.sin(2 * np.pi * 50.0 * times[on])
            if kind == "electrode-off":
                signals[on, column] = _OFF * hum + 1e-4 * self._rng.standard_normal(hum.size)
            elif kind == "hum":
                signals[on, column] += _HUM * hum
            elif kind == "torque-sign":
                signals[on, 1] *= -1
            elif kind == "angle-sign":
                signals[on, 0] *= -1
            elif times[-1] < since + float(fault.get("for", 0.5)):
                send[fault.get("stream", "EMG")] = False
        if send["manipulator"]:
            rows = slice(None, None, _DEVICE_EVERY)
            sent_times = times[rows]
            self._device.push_chunk(np.ascontiguousarray(signals[rows, :2]), float(sent_times[-1]))
        if send["EMG"]:
            self._emg.push_chunk(np.ascontiguousarray(signals[:, 2:]), float(times[-1]))


def _finer(coarse: "Trajectory") -> "Trajectory":
    """A trajectory at the rate of the laboratory."""
    from scipy.interpolate import CubicSpline

    time = np.arange(int(coarse.time[-1] * _RATE) + 1) / _RATE
    angle = CubicSpline(coarse.time, coarse.angle)
    effort = np.column_stack([np.interp(time, coarse.time, e) for e in coarse.effort.T])
    return replace(
        coarse,
        settings=replace(coarse.settings, rate_hz=_RATE),
        time=read_only(time),
        angle=read_only(angle(time)),
        velocity=read_only(angle(time, 1)),
        acceleration=read_only(angle(time, 2)),
        effort=read_only(effort),
    )
