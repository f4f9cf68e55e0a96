"""What recordings show around a point of the posterior: residuals, and what moves them.

A posterior's noise and the sizes of its latents change more often than its point, so that what they
do not touch is kept: a recording is simulated once for each point.

Fast gains of the drives add to the torque what they moved where a descent began. Were they gains of
each point, the mode would go where they are most powerful, for they are as many as the samples, and
a mode leaves out the volume that they then lose.

What no model has is in parts of each muscle group's active torque as it was where a descent began:
an addition that no parameter moves, so that the derivatives of all else stay exact.
"""

from collections import deque
from collections.abc import Callable, Sequence
from copy import copy
from dataclasses import dataclass
from functools import cached_property
from typing import Any

import numpy as np

from surae.base.units import FloatArray
from surae.inference.coordinates import Coordinates
from surae.inference.interrupt import checkpoint
from surae.inference.least_squares.residuals import simulators
from surae.inference.posterior.banded import band_products, border_products, lifted
from surae.inference.posterior.film import names_of_film, seen_by
from surae.inference.posterior.latent import TAIL_S, Latents
from surae.model.activation import IntArray
from surae.model.muscle_tendon import Tangent
from surae.signals import ModelInputs

#: Points that are kept of each recording: the best one, and the one that is tried.
_KEPT = 2
#: Active state over which it reaches zero in a search [N]: resting muscles cross zero at one value
#: of crosstalk or of EMG at rest, at which the model's kink would stop it.
REST = 3.0
#: Derivatives by fast gains, and their first samples, where there are none.
_NO_COLUMNS = np.zeros((0, 0)), np.zeros(0, dtype=np.int64)


class SensorRows:
    """Derivatives of what one sensor shows, and its residual, not divided by its noise.

    `whole`, shape (q + m + 1, n), has those by the coordinates that move the recording and by its
    slow latents, then the residual; `fast`, (k, l), by fast gains, each from its `first` sample on.
    """

    def __init__(
        self, whole: FloatArray, q: int, fast: FloatArray, first: IntArray, latents: Latents
    ) -> None:
        self.whole = whole
        self.fast = fast
        self.first = first
        self.by_z = whole[:q]
        self.by_c = whole[q:-1]
        self.residual = whole[-1]
        self._muscles = len(latents.muscles)
        #: Rows that stay as they are for as long as a descent lasts: by all latents but the gains.
        self.still = slice(q + latents.slices["drift"].start, len(whole) - 1)

    def columns(self) -> "SensorRows":
        """The fast columns alone, with their products, which other points share."""
        _ = self.band
        alone = copy(self)
        alone.whole = alone.by_z = alone.by_c = np.zeros((0, 0))
        alone.residual = self.residual.copy()
        return alone

    @cached_property
    def products(self) -> FloatArray:
        """Products of all of `whole`."""
        with np.errstate(over="ignore", invalid="ignore"):
            return np.asarray(self.whole @ self.whole.T)

    def noisy(self, like: "SensorRows", w: FloatArray) -> None:
        """Let fast gains add to the residual what they moved where `like` was."""
        self.fast = like.fast
        self.first = like.first
        self.band = like.band
        self.residual += like.lifted(w[:, None])[:, 0]

    def lifted(self, heights: FloatArray) -> FloatArray:
        """What fast gains of these heights, (k, d), move, shape (n, d)."""
        moved = np.zeros((len(self.residual), heights.shape[1]))
        lifted(self.fast, self.first, heights, moved)
        return moved

    @cached_property
    def band(self) -> FloatArray:
        """Products of the fast columns, as a lower band (b + 1, k)."""
        spacing = float(self.first[-1]) / (len(self.first) // self._muscles - 1)
        reach = self._muscles * (int(np.ceil(self.fast.shape[1] / spacing)) + 2)
        band = np.zeros((min(reach, len(self.first) - 1) + 1, len(self.first)))
        band_products(self.fast, self.first, band)
        return band

    @cached_property
    def border(self) -> FloatArray:
        """Products of the fast columns with the rows of `whole` that move, shape (k, …)."""
        moving = np.delete(self.whole, self.still, axis=0)
        return border_products(self.fast, self.first, moving.T.copy())

    @cached_property
    def still_border(self) -> FloatArray:
        """Those with the rows that stay."""
        return border_products(self.fast, self.first, self.whole[self.still].T.copy())


@dataclass(frozen=True, slots=True)
class _Seen:
    """A recording at a point: the model, its parameters, and what moves it, as in `SensorRows`."""

    tangent: Tangent
    values: FloatArray
    rows: list[FloatArray]  #: By coordinates and gains, of the torque and of each film's muscle.


class Observed:
    """The recordings of a problem, and their latents."""

    def __init__(
        self,
        at: Coordinates,
        latents: Sequence[Latents],
        *,
        expected: Sequence[FloatArray] = (),
        rest: float = REST,
        calls: list[int] | None = None,
    ) -> None:
        self._at = at
        self._latents = latents
        self.expected = expected
        self._inputs = at.problem.inputs
        self._spec = at.problem.spec
        self._names = self._spec.names
        self._simulators: list[Any] = list(simulators(at.problem))
        for simulator in self._simulators:
            simulator.rest = rest
        self._gains = [_short(each.gain) for each in latents]
        self._q = len(at.columns) + len(at.own_columns)  # coordinates that move a recording
        #: Recordings that were simulated with derivatives, and descents that ended at a cap, those
        #: of what was observed before too.
        self.calls = [0, 0] if calls is None else calls
        #: What the misfit's values add to each recording's torque, once its descent began.
        self._added: list[FloatArray | None] = []
        #: Where a descent began, of recordings that have fast gains.
        self._noise: list[list[SensorRows]] = []
        self._kept: list[deque[tuple[bytes, list[SensorRows]]]] = []
        #: What was simulated last, from which other latents and another descent are made too.
        self._seen = [deque[tuple[bytes, _Seen]](maxlen=_KEPT) for _ in self._inputs]
        self.anew()

    def anew(self) -> None:
        """Begin a descent: what latents add is that of its first point from now on."""
        self._added = [None for _ in self._inputs]
        self._noise = [[] for _ in self._inputs]
        self._kept = [deque(maxlen=_KEPT) for _ in self._inputs]

    def forget(self) -> None:
        """Let go of all points, which are large: this posterior is through."""
        self.anew()
        for seen in self._seen:
            seen.clear()

    def _set(
        self, z: FloatArray, c: FloatArray, number: int, ahead: Sequence[int] = ()
    ) -> tuple[Any, ModelInputs, Latents, FloatArray]:
        """The simulator of a recording at a point, and its parameter vector.

        Derivatives by columns `ahead` are asked for next.
        """
        simulator = self._simulators[number]
        recording = self._inputs[number]
        latents = self._latents[number]
        values = self._at.values(z, number)
        gain = latents.log_gain(c) if c.any() else None
        if self.expected and self.expected[number].any():
            quick = latents.fast.log_gain(self.expected[number], latents.muscles)
            gain = quick if gain is None else gain + quick
        simulator.with_log_gain(gain)
        if "plate_give" in self._names:
            simulator.pulled_by(measured(recording))
            with np.errstate(over="ignore", invalid="ignore"):
                simulator.pulled_by(simulator.torque(values, ahead))
        return simulator, recording, latents, values

    def plain_residual(self, z: FloatArray, recording: ModelInputs, number: int) -> FloatArray:
        """Modelled minus measured torque by the parameters alone [Nm], shape (n,)."""
        simulator: Any = self._spec.simulator(recording, self._at.problem.options)
        values = self._at.values(z, number)
        if "plate_give" in self._names:
            simulator.pulled_by(simulator.torque(values))
        return np.asarray(simulator.torque(values) - measured(recording))

    def effort(self, z: FloatArray, c: FloatArray, number: int) -> FloatArray:
        """Active states of both muscle groups [N], shape (2, n)."""
        simulator, _, _, values = self._set(z, c, number)
        return np.asarray(simulator.activity(values))

    def rows(self, z: FloatArray, c: FloatArray, w: FloatArray, number: int) -> list[SensorRows]:
        """What moves the torque of a recording, weighted, then what moves each of its films."""
        return list(_known(self._kept[number], (z, c, w), lambda: self._rows(z, c, w, number)))

    def _simulated(self, z: FloatArray, c: FloatArray, number: int) -> "_Seen":
        """A recording at a point, but for what latents add to it."""
        checkpoint()
        self.calls[0] += 1
        columns = [*self._at.columns, *self._at.own_columns]
        simulator, recording, latents, values = self._set(z, c, number, columns)
        with np.errstate(over="ignore", invalid="ignore"):
            tangent = simulator.tangent(values, columns, lengths=bool(latents.films))
        of_leg = len(self._at.columns)
        n = recording.n
        q = self._q
        each = []
        for group in (None, *(film.group for film in latents.films)):
            jacobian = tangent.jacobian if group is None else tangent.length_jacobian[group]
            rows = np.zeros((q + latents.size + 1, n))
            rows[:of_leg] = self._at.searched(jacobian[:of_leg], z)
            rows[of_leg:q] = jacobian[of_leg:]
            self._gain_rows(tangent.response, number, rows[q:-1], group)
            each.append(rows)
        return _Seen(tangent, values, each)

    def _rows(self, z: FloatArray, c: FloatArray, w: FloatArray, number: int) -> list[SensorRows]:
        at = self._at
        recording = self._inputs[number]
        latents = self._latents[number]
        moved = z, c[latents.slices["gain"]]
        seen = _known(self._seen[number], moved, lambda: self._simulated(z, c, number))
        tangent = seen.tangent
        values = seen.values
        q = self._q
        n = recording.n
        whole = seen.rows[0].copy()
        of_latents = whole[q:-1]
        added = self._added[number]
        if added is None:
            added = self._added[number] = latents.of_parts(tangent.active, tangent.tissue)
        of_latents[latents.of_model] = added
        of_latents[latents.slices["drift"]] = latents.drift
        drift = latents.slices["drift"].start
        whole[-1] = tangent.torque - measured(recording) + c[drift:] @ of_latents[drift:]
        response = tangent.response
        moving = bool(len(w)) and not self._noise[number]
        fast, first = self._fast_columns(response, values, number) if moving else _NO_COLUMNS
        if recording.weight is not None:
            root = np.sqrt(recording.weight)
            whole *= root
            fast = fast * root[np.minimum(first[:, None] + np.arange(fast.shape[1]), n - 1)]
        each = [SensorRows(whole, q, fast, first, latents)]
        by_name = at.by_name(z, number)
        films = zip(latents.films, latents.own_of_films(), seen.rows[1:], strict=True)
        for film, where, rows in films:
            names = names_of_film(film.channel)
            grown = 1.0 + by_name.get(names[0], 0.0)
            whole = grown * film.at_frames(rows)
            length = film.at_frames(tangent.lengths[film.group])
            for name, by in zip(names, (length, np.ones_like(length)), strict=True):
                if name in at.names:
                    whole[at.names.index(name)] = by
            whole[q + where.start : q + where.stop] = film.drift
            shown = seen_by(film.channel, by_name, length)
            whole[-1] = shown + c[where] @ film.drift - film.length
            fast, first = _NO_COLUMNS
            if moving:
                short, begins = self._fast_columns(response, values, number, film.group)
                fast, first = film.short(grown * short, begins)
            each.append(SensorRows(whole, q, fast, first, latents))
        if len(w):
            self._noise[number] = self._noise[number] or [
                of_latents.columns() for of_latents in each
            ]
            for own_rows, like in zip(each, self._noise[number], strict=True):
                own_rows.noisy(like, w)
        return each

    def _fast_columns(
        self, response: Any, values: FloatArray, number: int, group: int | None = None
    ) -> tuple[FloatArray, IntArray]:
        """Derivatives by the fast gains, (k, l), and their first samples, (k,).

        Of the torque, or of the length of a muscle `group`. Each is followed for a second or so.
        """
        recording = self._inputs[number]
        latents = self._latents[number]
        fast = latents.fast
        m = len(latents.muscles)
        tail = min(TAIL_S, 0.25 + 1.2 / float(values[self._names.index("f0")]))
        size = fast.shapes.shape[1] + int(tail * recording.rate_hz)
        columns = np.zeros((len(fast.first), m, size))
        for at, muscle in enumerate(latents.muscles):
            if group in (None, int(muscle == 0)):
                columns[:, at] = response.columns(
                    muscle, fast.shapes, fast.first, size, lengths=group is not None
                )
        columns = columns.reshape(-1, size)
        first = np.repeat(fast.first, m)
        if group is None:
            columns[first[:, None] + np.arange(size) >= recording.n] = 0.0
        return columns, first

    def _gain_rows(
        self, response: Any, number: int, into: FloatArray, group: int | None = None
    ) -> None:
        """Derivatives by the slow gains, each followed for as long as it changes anything.

        Of the torque, or of the length of a muscle `group`.
        """
        first, shapes = self._gains[number]
        k = len(first)
        n = into.shape[1]
        size = min(n, shapes.shape[1] + int(TAIL_S * self._inputs[number].rate_hz))
        for at, muscle in enumerate(self._latents[number].muscles):
            if group not in (None, int(muscle == 0)):
                continue
            columns = response.columns(muscle, shapes, first, size, lengths=group is not None)
            for j, (begin, column) in enumerate(zip(first, columns, strict=True)):
                into[at * k + j, begin : begin + size] = column[: n - begin]


def _known(kept: deque[Any], at: Sequence[FloatArray], make: Callable[[], Any]) -> Any:
    """What is kept of a point, or made of it."""
    key = b"".join(x.tobytes() for x in at)
    for known, made in kept:
        if known == key:
            return made
    kept.append((key, make()))
    return kept[-1][1]


def _short(hats: FloatArray) -> tuple[IntArray, FloatArray]:
    """Hats over time, shape (k, n), from their first samples, (k,), on: shape (k, width)."""
    k, n = hats.shape
    first = np.array([np.flatnonzero(hat)[0] for hat in hats], dtype=np.int64)
    width = min(n, 2 * int(np.ceil(n / (k - 1))) + 1)
    padded = np.pad(hats, ((0, 0), (0, width)))
    return first, padded[np.arange(k)[:, None], first[:, None] + np.arange(width)]


def measured(recording: ModelInputs) -> FloatArray:
    """The torque of a recording [Nm], shape (n,); none counts as zero."""
    return np.zeros(recording.n) if recording.torque is None else recording.torque
