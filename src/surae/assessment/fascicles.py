"""Filmed fascicles beside the model's own lengths, of a fit or a prediction."""

from collections.abc import Mapping
from dataclasses import dataclass

import numpy as np

from surae.estimation import FitResult
from surae.estimation.film import group_of_film, seen_by
from surae.frozen import Comparable
from surae.model import ModelOptions, ModelSpec
from surae.signals import ModelInputs
from surae.units import FloatArray


@dataclass(frozen=True, slots=True)
class FascicleQuality:
    """How well the frames of one film are followed, without the tracker's drift."""

    channel: str  #: ``"fascicle_tib"`` …
    n: int  #: Number of frames.
    rmse_mm: float  #: Of measured minus modelled length.
    bias_mm: float


@dataclass(frozen=True, slots=True, eq=False)
class Fascicles(Comparable):
    """One film and what the model says of it, over time."""

    recording: str
    channel: str
    time: FloatArray  #: Of the frames that fall into the recording [s], shape (k,).
    measured: FloatArray  #: Fascicle length [m], shape (k,).
    modelled: FloatArray  #: What the film should show [m], shape (k,).

    @property
    def quality(self) -> FascicleQuality:
        """The figures."""
        error = 1e3 * (self.measured - self.modelled)
        rmse, bias = float(np.sqrt(np.mean(error**2))), float(error.mean())
        return FascicleQuality(self.channel, len(error), rmse, bias)


def fascicles_of(result: FitResult) -> tuple[Fascicles, ...]:
    """The films of a fit's recordings."""
    problem = result.problem
    return tuple(
        each
        for recording in problem.inputs
        for each in followed(problem.spec, problem.options, result.values, recording)
    )


def followed(
    spec: ModelSpec,
    options: ModelOptions,
    values: Mapping[str, float],
    recording: ModelInputs,
) -> tuple[Fascicles, ...]:
    """A recording's films and what parameters say of them; none of a rigid tendon's model.

    A film that the fit did not have is taken for the group's own length.
    """
    if not recording.films:
        return ()
    state = spec.simulator(recording, options).tendon(spec.vector(values, options))
    if state is None:
        return ()
    each = []
    for film in recording.films:
        inside = (film.time >= recording.time[0]) & (film.time <= recording.time[-1])
        if not inside.any():
            continue
        time, length = film.time[inside], state.muscle_length[group_of_film(film.channel)]
        modelled = seen_by(film.channel, values, np.interp(time, recording.time, length))
        each.append(Fascicles(recording.name, film.channel, time, film.length[inside], modelled))
    return tuple(each)
