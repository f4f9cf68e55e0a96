"""What a film adds to the posterior: the length of a muscle's fascicles, as its tracker sees them.

    y = (1 + scale)·l + zero + drift(t) + noise

l is the length of the muscle group in the model, path and tendon included. A fascicle is one of
many, deeper or shallower and pennate: it has a scale and a zero of its own, which are parameters
(`film_scale_tib`, `film_zero_tib` …) and the same in all trials of a mounting. Trackers drift by a
millimetre or two within seconds; what is left counts as the noise of the torque does.
"""

from collections.abc import Mapping, Sequence
from dataclasses import dataclass

import numpy as np

from surae.base.units import FloatArray
from surae.inference.noise import NoiseModel, noise_behind
from surae.model.activation import IntArray
from surae.signals import Film, ModelInputs

#: A tracker's drift [m], its correlation time and the distance of its hats [s].
DRIFT = 1e-3
DRIFT_S = 5.0
_STEP_S = 1.0
_MOST = 60
#: Noise from which a search begins, and the least [m]; largest order of its model; frames a second
#: that are used, and the fewest of a film.
_BEGIN = 1.5e-3
_LEAST = 1e-4
_ORDER = 8
_RATE = 40.0
_FEWEST = 20
_COUNTED = 2.0


@dataclass(frozen=True, slots=True)
class FilmView:
    """A film on the samples of a model."""

    channel: str
    group: int  #: 0 is the triceps, 1 the tibialis.
    length: FloatArray  #: What was measured [m], shape (k,).
    before: IntArray  #: The sample before each frame, shape (k,).
    part: FloatArray  #: How far each frame is from there to the next sample, shape (k,).
    drift: FloatArray  #: Hats over time, shape (h, k).
    inverse: FloatArray  #: Inverse covariance of the drift, shape (h, h).
    noise: NoiseModel

    @classmethod
    def of(cls, film: Film, recording: ModelInputs) -> "FilmView | None":
        """A recording's film; None where too few of its frames fall into the recording."""
        inside = (film.time >= recording.time[0]) & (film.time <= recording.time[-1])
        frames = np.flatnonzero(inside)
        if len(frames) < _FEWEST:
            return None
        seconds = float(film.time[frames[-1]] - film.time[frames[0]])
        frames = frames[:: max(1, round((len(frames) - 1) / seconds / _RATE))]
        time = film.time[frames]
        length = film.length[frames]
        at = (time - recording.time[0]) * recording.rate_hz
        before = np.clip(at.astype(np.int64), 0, recording.n - 2)
        first = float(film.time[0])
        last = float(film.time[-1])  # the same at every rate
        knots = np.linspace(first, last, min(max(2, round((last - first) / _STEP_S) + 1), _MOST))
        apart = np.abs(knots[:, None] - knots) / DRIFT_S
        drift = DRIFT**2 * (np.exp(-apart) + 1e-6 * np.eye(len(knots)))
        return cls(
            film.channel,
            group_of_film(film.channel),
            length,
            before,
            at - before,
            hats(time, knots),
            np.asarray(np.linalg.inv(drift), dtype=float),
            NoiseModel.white(_BEGIN**2, float(len(frames))),
        )

    def at_frames(self, rows: FloatArray) -> FloatArray:
        """What is known at the samples, (…, n), at the frames, (…, k)."""
        here = rows[..., self.before]
        return np.asarray(here + self.part * (rows[..., self.before + 1] - here))

    def short(self, columns: FloatArray, first: IntArray) -> tuple[FloatArray, IntArray]:
        """Columns that begin at samples `first`, (j, size), at the frames from their first on."""
        size = columns.shape[1]
        position = self.before + self.part
        begin = np.searchsorted(position, first)
        frames = int(np.ceil((size - 1) * len(position) / max(position[-1] - position[0], 1.0)))
        at = begin[:, None] + np.arange(frames)
        since = position[np.minimum(at, len(position) - 1)] - first[:, None]
        inside = (at < len(position)) & (since <= size - 1)
        low = np.clip(since.astype(np.int64), 0, size - 2)
        here = np.take_along_axis(columns, low, axis=1)
        after = np.take_along_axis(columns, low + 1, axis=1)
        values = np.where(inside, here + (since - low) * (after - here), 0.0)
        return np.ascontiguousarray(np.where(at < len(position), values, 0.0)), begin


def hats(at: FloatArray, knots: FloatArray) -> FloatArray:
    """Hat functions about the knots, each from one neighbour to the next, shape (k, n)."""
    return np.stack([np.interp(at, knots, row) for row in np.eye(len(knots))])


def views(recording: ModelInputs) -> tuple[FilmView, ...]:
    """The films of a recording."""
    each = (FilmView.of(film, recording) for film in recording.films)
    return tuple(view for view in each if view is not None)


def names_of_film(channel: str) -> tuple[str, str]:
    """Names of the parameters that are a film's scale and zero."""
    muscle = channel.rpartition("_")[2]
    return f"film_scale_{muscle}", f"film_zero_{muscle}"


def group_of_film(channel: str) -> int:
    """The muscle group that a film is of: 0 is the triceps, 1 the tibialis."""
    return int(channel.rpartition("_")[2].startswith("tib"))


def seen_by(channel: str, values: Mapping[str, float], length: FloatArray) -> FloatArray:
    """What a film shows of its muscle's length [m], without the tracker's drift."""
    scale, zero = (values.get(name, 0.0) for name in names_of_film(channel))
    return np.asarray((1.0 + scale) * length + zero)


def noise_of_film(residual: FloatArray, taken: FloatArray) -> NoiseModel:
    """The noise behind a film's residual [m]; `taken` is as of `noise_behind`."""
    model = noise_behind(residual, taken, min(_ORDER, len(residual) // 10))
    return model.slow(_COUNTED / _RATE, least=_LEAST**2)


def slices_of(films: Sequence[FilmView], start: int) -> tuple[slice, ...]:
    """Where the latent values of each film are, from `start` on."""
    ends = start + np.cumsum([len(film.drift) for film in films], dtype=int)
    each = zip(films, ends.tolist(), strict=True)
    return tuple(slice(end - len(film.drift), end) for film, end in each)
