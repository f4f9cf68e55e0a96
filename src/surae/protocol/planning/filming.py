"""What a film of fascicles would add: rows of the muscle's length beside those of the torque.

Frames of the model's own lengths are seen up to the fascicle's scale and zero, the tracker's drift
and noise, as `surae.estimation.film` reads them. How far the drive itself errs is left out.
"""

from collections.abc import Sequence
from dataclasses import replace

import numpy as np

from surae.errors import InputError
from surae.estimation import FitResult
from surae.estimation.film import DRIFT, DRIFT_S, group_of_film, names_of_film
from surae.frozen import FrozenDict, read_only
from surae.model import ModelSpec, with_optional
from surae.model.laboratory import laboratory
from surae.protocol.planning.legs import Legs
from surae.recording.recording import FILMED
from surae.signals import thinned
from surae.units import FloatArray

#: Frames a second that are counted, and their noise beside the drift [m].
_RATE, _NOISE = 5.0, 5e-4
#: Rate [Hz] at least at which a fit's recordings are simulated for it.
_SIMULATED = 64.0


def filmed(legs: Legs, muscles: Sequence[str]) -> Legs:
    """The same legs with films of these muscles, whose scales and zeros are estimated along."""
    if not muscles:
        return legs
    for muscle in muscles:
        if muscle not in FILMED:
            raise InputError(f"film: no muscle {muscle!r}; use {', '.join(FILMED)}")
    if "dlt_tri" not in legs.spec.names:
        raise InputError(f"{legs.spec.name} has rigid tendons, of which a film shows nothing new")
    names = [n for m in muscles for n in names_of_film(m) if n not in legs.free]
    spec = with_optional(legs.spec, names)
    values = np.zeros((len(legs.values), len(spec.names)))
    values[:, [spec.names.index(n) for n in legs.spec.names]] = legs.values
    known = laboratory()
    return replace(
        legs, name=f"{legs.name}, filmed: {', '.join(muscles)}", spec=spec,
        free=(*legs.free, *names), values=read_only(values), films=tuple(muscles),
        beliefs=FrozenDict({**{n: known[n] for n in names}, **legs.beliefs}),
    )  # fmt: skip


def rows_of_films(
    muscles: Sequence[str],
    simulator: object,
    spec: ModelSpec,
    free: Sequence[str],
    values: FloatArray,
    time: FloatArray,
) -> list[FloatArray]:
    """Whitened derivatives of each film by the free parameters, shape (p, frames) each."""
    step = max(round(len(time) / ((time[-1] - time[0]) * _RATE)), 1)
    at = np.arange(0, len(time), step)
    columns = [spec.names.index(name) for name in free]
    at_point = simulator.tangent(values, columns, lengths=True)  # type: ignore[attr-defined]
    lengths, slopes = at_point.lengths, at_point.length_jacobian
    apart = np.abs(time[at][:, None] - time[at]) / DRIFT_S
    factor = np.linalg.cholesky(DRIFT**2 * np.exp(-apart) + _NOISE**2 * np.eye(len(at)))
    whitened = []
    for muscle in muscles:
        group = group_of_film(f"fascicle_{muscle}")
        rows = slopes[group][:, at].copy()
        for name, by in zip(names_of_film(muscle), (lengths[group][at], 1.0), strict=True):
            if name in free:
                rows[list(free).index(name)] = by
        whitened.append(np.linalg.solve(factor, rows.T).T)
    return whitened


def covariance_if_filmed(result: FitResult, muscle: str) -> FloatArray | None:
    """Covariance of a fit's free parameters, had a muscle been filmed in its recordings.

    None for a named model, and where the muscle was filmed.
    """
    names, problem = names_of_film(muscle), result.problem
    if result.family is None or names[0] in problem.free:
        return None
    spec, free = with_optional(problem.spec, names), (*problem.free, *names)
    values = spec.vector({**result.values, **dict.fromkeys(names, 0.0)}, problem.options)
    p, known = len(problem.free), laboratory()
    V = np.diag([0.0] * p + [known[name].sd ** 2 for name in names])
    V[:p, :p] = result.family.covariance
    for whole in problem.inputs:
        recording = thinned(whole, max(int(whole.rate_hz / _SIMULATED + 1e-9), 1))
        simulator = spec.simulator(recording, problem.options)
        (J,) = rows_of_films((muscle,), simulator, spec, free, values, recording.time)
        gain = V @ J
        V = V - gain @ np.linalg.solve(J.T @ gain + np.eye(J.shape[1]), gain.T)
    return np.asarray(V[:p, :p])
