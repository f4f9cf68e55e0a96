"""A fit as it goes on: parameters and torque at every better point, not too often."""

import time
from collections.abc import Sequence

import numpy as np

from surae import api
from surae.processes import tell
from surae.units import FloatArray
from surae_workbench.web.curves import plain

#: News of a fit come at most this often [s].
_EVERY = 0.1
#: The torque is shown from signals thinned to this rate [Hz], but not to fewer samples.
_RATE, _SAMPLES = 60.0, 500
#: By so many points, of all recordings and of one.
_ALL, _POINTS = 8000, 1000


class FitProgress:
    """Tells how a fit goes on; made for `follow` and `progress` of `surae.fit`."""

    def __init__(
        self, inputs: Sequence[api.ModelInputs], ids: Sequence[str], settings: api.FitSettings
    ) -> None:
        self._inputs = [
            api.thinned(recording, api.thinning_factor(recording, _RATE, _SAMPLES))
            for recording in inputs
        ]
        self._ids = ids
        self._options = settings.options
        self._starts, self._start, self._iteration = settings.starts, 1, 0
        self._points = min(_POINTS, max(_ALL // len(self._inputs), 100))
        self._last, self._simulators = 0.0, dict[tuple[str, ...], list[api.Simulator]]()
        self._best: tuple[api.ModelSpec, FloatArray, float] | None = None

    def start(self, done: int, starts: int, best: float) -> None:
        """A start is done."""
        del best
        self._start = min(done + 1, starts)
        if self._best is not None:
            self._send(*self._best)

    def point(self, spec: api.ModelSpec, values: FloatArray, sse: float) -> None:
        """A better point is found."""
        self._iteration += 1
        self._best = (spec, values, sse)
        if time.monotonic() - self._last >= _EVERY:
            self._send(spec, values, sse)

    def _send(self, spec: api.ModelSpec, values: FloatArray, sse: float) -> None:
        # A fit may go through simpler models, and through the same one without its drives.
        key = (spec.name, *spec.names)
        if key not in self._simulators:
            self._simulators[key] = [
                spec.simulator(recording, self._options) for recording in self._inputs
            ]
        traces, pairs_of = [], list[tuple[FloatArray, FloatArray]]()
        pairs = zip(self._ids, self._inputs, self._simulators[key], strict=True)
        for id_, recording, simulator in pairs:
            with np.errstate(all="ignore"):
                torque = simulator.torque(values)
            measured = np.zeros(recording.n) if recording.torque is None else recording.torque
            counts = recording.counts
            pairs_of.append((measured[counts], (measured - torque)[counts]))
            shown = api.extremes([measured], self._points - 2)
            lines = {"t": recording.time, "measured": measured, "modelled": torque}
            traces.append(
                {"recording": id_, **{name: plain(line[shown]) for name, line in lines.items()}}
            )
        r2 = api.centred_r2(pairs_of)
        tell(
            {
                "phase": "fitting",
                "start": self._start,
                "starts": self._starts,
                "iteration": self._iteration,
                "model": spec.name,
                "r2": r2 if np.isfinite(r2) else None,
                "sse": sse if np.isfinite(sse) else None,
                "values": dict(zip(spec.names, plain(values), strict=True)),
                "traces": traces,
            }
        )
        self._last = time.monotonic()
