"""Filmed fascicles beside the model's own lengths, of a fit or a prediction."""

from collections.abc import Mapping
from dataclasses import dataclass

import numpy as np

from surae.base.frozen import Comparable
from surae.base.units import FloatArray
from surae.inference import FitResult
from surae.inference.posterior.film import group_of_film, names_of_film, seen_by
from surae.model import ModelOptions, ModelSpec
from surae.signals import ModelInputs


@dataclass(frozen=True, slots=True)
class FascicleQuality:
    """How well the frames of one film are followed, without the tracker's drift."""

    channel: str  #: ``"fascicle_tib"`` …
    n: int  #: Number of frames.
    rmse_mm: float  #: Of measured minus modelled length.
    bias_mm: float
    correlation: float | None = None  #: Of both lengths; None where one of them never changes.
    noise_mm: float | None = None  #: Standard deviation of the tracker from frame to frame.


@dataclass(frozen=True, slots=True, eq=False)
class Fascicles(Comparable):
    """One film and what the model says of it, over time; arrays of shape (k,)."""

    recording: str
    channel: str
    time: FloatArray  #: Of the frames that fall into the recording [s].
    measured: FloatArray  #: Fascicle length [m].
    modelled: FloatArray  #: What the film should show [m].
    stretch: FloatArray  #: How far the tendon is stretched in the model [m]; 0 where it is rigid.
    filmed_stretch: FloatArray  #: The path's length in the model less what the film shows [m].
    force: FloatArray  #: On the tendon in the model [N].
    torque: FloatArray  #: Measured [Nm].

    @property
    def quality(self) -> FascicleQuality:
        """The figures."""
        error = 1e3 * (self.measured - self.modelled)
        rmse = float(np.sqrt(np.mean(error**2)))
        bias = float(error.mean())
        changes = min(np.ptp(self.measured), np.ptp(self.modelled)) > 0.0
        alike = float(np.corrcoef(self.measured, self.modelled)[0, 1]) if changes else None
        noise = float(np.std(np.diff(error)) / np.sqrt(2.0)) if len(error) > 2 else None
        return FascicleQuality(self.channel, len(error), rmse, bias, alike, noise)


def fascicles_of(result: FitResult) -> tuple[Fascicles, ...]:
    """The films of a fit's recordings."""
    problem = result.problem
    return tuple(
        each
        for recording in problem.inputs
        for each in followed(problem.spec, problem.options, result.values, recording)
    )


def followed(
    spec: ModelSpec, options: ModelOptions, values: Mapping[str, float], recording: ModelInputs
) -> tuple[Fascicles, ...]:
    """A recording's films and what parameters say of them; one not fitted is the group's length."""
    if not recording.films:
        return ()
    vector = spec.vector(values, options)
    lengths, stretches, forces = spec.simulator(recording, options).muscles(vector)
    measured = np.full(recording.n, np.nan) if recording.torque is None else recording.torque
    each = []
    for film in recording.films:
        inside = (film.time >= recording.time[0]) & (film.time <= recording.time[-1])
        if not inside.any():
            continue
        group = group_of_film(film.channel)
        time = film.time[inside]
        seen = film.length[inside]
        length, stretch, force, torque = (
            np.interp(time, recording.time, row)
            for row in (lengths[group], stretches[group], forces[group], measured)
        )
        modelled = seen_by(film.channel, values, length)
        grown = 1.0 + values.get(names_of_film(film.channel)[0], 0.0)
        filmed = stretch + (modelled - seen) / grown
        series = (time, seen, modelled, stretch, filmed, force, torque)
        each.append(Fascicles(recording.name, film.channel, *series))
    return tuple(each)
