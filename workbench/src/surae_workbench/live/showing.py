"""What a screen gets, thirty times a second: the extremes of every channel, effort, target."""

import threading
import time
from collections.abc import Callable, Mapping
from pathlib import Path
from typing import Any

import numpy as np
import numpy.typing as npt

from surae.api import MUSCLES
from surae.base.records import read_toml
from surae.base.units import FACTORS, SI, FloatArray, kind, plain
from surae_workbench.live.stream import Stream

#: Frames per second, and how the envelope of an EMG is smoothed [s].
RATE = 30.0
_SMOOTH = 0.15
_DRIFT = 0.05
#: What is larger is no measurement, and sums of it are none.
_HUGE = 1e100
#: A muscle's largest EMG is at least this part of the strongest muscle's, and so many times its own
#: at rest above that: the noise of an amplifier is no effort.
_CROSSTALK = 0.25
_WORKS = 1.5

#: Column → role and the factor and offset that bring it to SI.
Roles = Mapping[str, tuple[str, float, float]]


def roles_of(mapping: Path | None) -> Roles:
    """Which column is which signal, and how it comes to SI; empty where nothing says it."""
    if mapping is None:
        return {}
    roles = {}
    for role, entry in read_toml(mapping)["channels"].items():
        unit = plain(str(entry.get("unit", SI[kind(role)])))
        factor = entry.get("sign", 1) * FACTORS[kind(role)].get(unit, 1.0)
        roles[str(entry["column"])] = (
            str(role),
            factor * entry.get("scale", 1.0),
            factor * entry.get("offset", 0.0),
        )
    return roles


def guessed_roles(offered: Mapping[str, Any]) -> Roles:
    """Which column seems to be which signal, to be looked at before somebody settles it."""
    return {
        str(guess["column"]): (role, FACTORS[kind(role)][guess["unit"]] * guess["scale"], 0.0)
        for role, guess in offered["guesses"].items()
    }


class Showing:
    """Takes samples from the recorder and makes frames of them, which `send` gets."""

    def __init__(self, send: Callable[[dict[str, Any]], None]) -> None:
        self._send = send
        self.roles: Roles = {}
        self._lock = threading.Lock()
        # By role: lowest, highest, newest; None where no sample was a finite number.
        self._new: dict[str, list[float] | None] = {}
        self._newest = 0.0
        self._felt: dict[str, float] = {}  # by role: when it was last felt
        self._means: dict[str, float] = {}
        self._levels: dict[str, float] = {}
        self._rests: dict[str, float] = {}
        self._largest: dict[str, float] = {}
        self._ended = threading.Event()

    def show(self, stream: Stream, times: FloatArray, values: npt.NDArray[Any]) -> None:
        """Take new samples of a stream."""
        with self._lock:
            for index, column in enumerate(stream.columns):
                if column not in self.roles:
                    continue
                role, factor, offset = self.roles[column]
                with np.errstate(over="ignore", invalid="ignore"):
                    signal = factor * values[:, index].astype(float) + offset
                signal = signal[np.abs(signal) < _HUGE]  # what is hidden from a camera is NaN
                if not len(signal):
                    self._new.setdefault(role, None)
                    continue
                low = float(signal.min())
                high = float(signal.max())
                known = self._new.get(role)
                if known is not None:
                    low = min(low, known[0])
                    high = max(high, known[1])
                self._new[role] = [low, high, float(signal[-1])]
                if role.startswith("emg_"):
                    # What is irregular says by its stamps alone for how long it was felt.
                    last = self._felt.get(role, float(times[0]))
                    regular = len(times) / stream.rate_hz if stream.rate_hz > 0 else 0.0
                    self._feel(role, signal, regular or max(float(times[-1]) - last, 0.0))
                    self._felt[role] = float(times[-1])
            self._newest = max(self._newest, float(times[-1]))

    def efforts(self) -> list[float]:
        """Effort of the four muscles as a part of the largest so far, 0 to 1.

        Of a muscle that has not worked yet the largest is its neighbours' crosstalk: it counts as a
        quarter of the strongest muscle's at least.
        """
        roles = [f"emg_{muscle}" for muscle in MUSCLES]
        rests = [self._rests.get(role, 0.0) for role in roles]
        spans = [
            self._largest.get(role, 0.0) - rest for role, rest in zip(roles, rests, strict=True)
        ]
        least = _CROSSTALK * max(spans)
        return [
            min(
                max((self._levels.get(role, 0.0) - rest) / max(span, least, _WORKS * rest), 0.0),
                1.0,
            )
            if least > 0
            else 0.0
            for role, rest, span in zip(roles, rests, spans, strict=True)
        ]

    def forget(self) -> None:
        """Begin again with what the largest effort is."""
        with self._lock:
            self._largest.clear()
            self._rests.clear()

    def run(self, clock: Callable[[], float], target: Callable[[], FloatArray]) -> None:
        """Send frames until closed, in a thread of its own.

        `clock` gives LSL's time [s], `target` what is asked for now: angle [rad] and four efforts.
        """
        work = threading.Thread(
            target=self._frames, args=(clock, target), daemon=True, name="live-frames"
        )
        work.start()

    def close(self) -> None:
        """Send no more."""
        self._ended.set()

    def _feel(self, role: str, signal: FloatArray, seconds: float) -> None:
        """Follow the envelope of an EMG, its rest and its largest."""
        mean = self._means.get(role, float(signal.mean()))
        mean += (float(signal.mean()) - mean) * (1.0 - np.exp(-seconds / _DRIFT))
        size = float(np.abs(signal - mean).mean())
        level = self._levels.get(role, size)  # not from nothing: that would be taken for rest
        level += (size - level) * (1.0 - np.exp(-seconds / _SMOOTH))
        self._means[role] = mean
        self._levels[role] = level
        self._largest[role] = max(self._largest.get(role, 0.0), level)
        rest = self._rests.get(role, level)
        self._rests[role] = min(rest * (1.0 + 0.002 * seconds), level) if rest else level

    def _frames(self, clock: Callable[[], float], target: Callable[[], FloatArray]) -> None:
        due = time.monotonic()
        while not self._ended.is_set():
            due = max(due + 1.0 / RATE, time.monotonic())
            self._ended.wait(due - time.monotonic())
            with self._lock:
                new = self._new
                self._new = {}
                efforts = self.efforts()
                newest = self._newest
            now = clock()
            self._send(
                {
                    "t": round(now, 4),
                    # On the wall's clock: when the newest of these samples was taken.
                    "taken": round(1e3 * (time.time() - (now - newest)), 1) if new else None,
                    "new": {
                        role: kept and [float(f"{value:.5g}") for value in kept]
                        for role, kept in new.items()
                    },
                    "effort": [round(effort, 3) for effort in efforts],
                    "asked": [float(f"{value:.4g}") for value in target()],
                }
            )
