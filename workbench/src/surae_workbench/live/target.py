"""The requested trial as a stream: where the device should be and how hard each muscle should work.

It commands no motor. A manipulator's controller may follow it, with its own safety; and it is
recorded beside what was measured.
"""

import threading
import time
from dataclasses import dataclass
from typing import Any

import numpy as np

from surae.api import MUSCLES, Trajectory
from surae.base.names import TARGET_SOURCE
from surae.base.units import FloatArray
from surae_workbench.live.lsl import lsl, outlet

NAME = "surae target"
KIND = "Target"
#: Rate [Hz], and how much of it is sent at a time [s].
_RATE = 100.0
_STEP = 0.02
#: So long an outlet that sends no more waits for those who hear it to leave [s].
_LEAVE = 1.0


@dataclass(frozen=True, slots=True)
class _Plan:
    """A trajectory, and when it begins, in LSL's time [s]; None while it waits."""

    trajectory: Trajectory | None = None
    begin: float | None = None

    def at(self, times: FloatArray) -> FloatArray:
        """Angle [rad] and the four efforts at some times, shape (n, 5)."""
        wanted = np.zeros((len(times), 1 + len(MUSCLES)))
        if self.trajectory is None:
            return wanted
        path = self.trajectory
        since = times - self.begin if self.begin is not None else np.zeros(len(times))
        wanted[:, 0] = np.interp(since, path.time, path.angle)
        if self.begin is not None:
            for i in range(len(MUSCLES)):
                wanted[:, 1 + i] = np.interp(
                    since, path.time, path.effort[:, i], left=0.0, right=0.0
                )
        return wanted


class TargetStream:
    """The stream of the request, until it is closed."""

    def __init__(self) -> None:
        labels = ["angle", *(f"emg_{muscle}" for muscle in MUSCLES)]
        units = ["rad", *["1"] * len(MUSCLES)]
        self._clock = lsl().local_clock
        self._plan = _Plan()
        self._ended = threading.Event()
        # The stream ends with the thread that alone holds it, not when memory is tidied some day.
        sent = outlet(NAME, KIND, labels, units, _RATE, TARGET_SOURCE)
        self._thread = threading.Thread(
            target=self._send, args=(sent,), name="live-target", daemon=True
        )
        self._thread.start()

    def load(self, trajectory: Trajectory) -> None:
        """Ask for the first position of a trajectory."""
        self._plan = _Plan(trajectory)

    def begin(self, at: float) -> None:
        """Ask for all of it from a time of LSL's clock on [s]."""
        self._plan = _Plan(self._plan.trajectory, at)

    def end(self) -> None:
        """Ask for nothing more than its first position."""
        self._plan = _Plan(self._plan.trajectory)

    def now(self) -> FloatArray:
        """The request now: angle [rad] and the four efforts."""
        wanted: FloatArray = self._plan.at(np.array([float(self._clock())]))[0]
        return wanted

    def close(self) -> None:
        """End the stream."""
        self._ended.set()
        self._thread.join(5.0)

    def _send(self, stream: Any) -> None:
        sent = 0
        start = float(self._clock())
        while not self._ended.wait(_STEP):
            due = int((float(self._clock()) - start) * _RATE)
            if due > sent:
                times = start + np.arange(sent, due) / _RATE
                stream.push_chunk(self._plan.at(times), float(times[-1]))
                sent = due
        # LSL has crashed where an outlet went while its samples were still on their way.
        end = time.monotonic() + _LEAVE
        while stream.have_consumers() and time.monotonic() < end:
            time.sleep(_STEP)
