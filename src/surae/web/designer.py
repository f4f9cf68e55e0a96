"""A protocol before anybody is measured: the motion, what it covers, and what it will tell.

The information matrix needs no fit: the Jacobian of the torque at a typical subject's parameters
and the noise that is expected give the standard errors (Cramér and Rao's bound) at once.
"""

import time
from collections.abc import Mapping
from typing import TYPE_CHECKING, Any

import numpy as np

from surae.assessment.uncertainty.covariance import covariance, half_width, ipde
from surae.assessment.verdict import judge_interval, judge_singular
from surae.errors import InputError
from surae.estimation.least_squares import compress
from surae.model import ModelOptions, get_model
from surae.protocol import Protocol, Trajectory, generate, named_device
from surae.protocol.triceps import triceps_path
from surae.report.decimate import extremes
from surae.studies import POPULATIONS, VirtualSubject, virtual_trial
from surae.web.live import plain

if TYPE_CHECKING:
    from surae.web.schemas import ProtocolSettings

_POINTS = 2000
#: More samples than this, ten minutes at 2 kHz, are a slip of the keyboard.
_MOST_SAMPLES = 1_200_000
#: Samples of the torque that the prediction is made of; more tell it nothing else.
_PREDICTED = 60_000


def protocol(settings: "ProtocolSettings") -> Protocol:
    """The protocol of some settings.

    Raises
    ------
    InputError
        A setting is out of its range.
    """
    made = Protocol(
        profile=settings.profile,
        task=settings.task,
        chirp_amplitude=settings.chirp_amplitude,
        chirp_rate=settings.chirp_rate,
        range_of_motion=settings.range,
        duration=settings.duration,
        rate_hz=settings.rate_hz,
        device=None if settings.device is None else named_device(settings.device),
        adapt=settings.adapt,
    )
    if made.seconds * max(made.rate_hz, 2000.0) > _MOST_SAMPLES:
        raise InputError(
            f"{made.seconds:g} s at {made.rate_hz:g} Hz are too many samples; use a shorter "
            "duration or a lower rate"
        )
    low, high = made.range_of_motion
    if not -3.0 <= low < high <= 3.0:
        raise InputError(f"range of motion {low:g} … {high:g} rad; give angles of an ankle")
    return made


def preview(
    settings: "ProtocolSettings", model: str, population: str, noise: float
) -> dict[str, Any]:
    """The motion, the effort, the coverage, and the standard errors to expect."""
    made = protocol(settings)
    if made.seconds * made.rate_hz > _PREDICTED:
        raise InputError(
            f"{made.seconds:g} s at {made.rate_hz:g} Hz are too many samples to predict from; use "
            "a rate of 125 Hz: it tells as much"
        )
    trajectory = generate(made)
    path, adaptation = triceps_path(trajectory), trajectory.adaptation
    shown = extremes([trajectory.angle, trajectory.velocity], _POINTS)
    step = max(-(-len(trajectory.time) // _POINTS), 1)
    return {
        "t": plain(trajectory.time[shown]),
        "angle": plain(trajectory.angle[shown]),
        "velocity": plain(trajectory.velocity[shown]),
        "effort": [plain(trajectory.effort[shown, i]) for i in range(4)],
        "seconds": trajectory.settings.seconds,
        "samples": len(trajectory.time),
        "adaptation": None
        if adaptation is None
        else {
            "device": adaptation.device,
            "steps": list(adaptation.steps),
            "chirp_amplitude": list(adaptation.chirp_amplitude),
            "cutoff_hz": adaptation.cutoff_hz,
            "peak_velocity": list(adaptation.peak_velocity),
            "peak_acceleration": list(adaptation.peak_acceleration),
            "span": adaptation.span,
        },
        "coverage": {
            "share": path.coverage.share,
            "outside": path.coverage.outside,
            "length_edges": plain(path.coverage.length_edges),
            "velocity_edges": plain(path.coverage.velocity_edges),
            "time_share": [plain(row) for row in path.coverage.time_share],
        },
        "path": {"length": plain(path.length[::step]), "velocity": plain(path.velocity[::step])},
        "prediction": predicted(trajectory, model, population, noise),
    }


def typical_subject(population: str) -> VirtualSubject:
    """The subject in the middle of a population's ranges."""
    middle = {name: 0.5 * (low + high) for name, (low, high) in POPULATIONS[population].items()}
    return VirtualSubject(population, 0, middle)


def predicted(trajectory: Trajectory, model: str, population: str, noise: float) -> dict[str, Any]:
    """Standard errors, dependency and verdicts that a trial of a typical subject would give.

    Parameters
    ----------
    trajectory : Trajectory
        The protocol.
    model : str
        A model that the population's parameters are of.
    population : str
        Whose middle the typical subject is.
    noise : float
        Standard deviation of the torque's noise as a part of its mean magnitude, white.

    Raises
    ------
    InputError
        The model has parameters of which the population knows nothing.
    """
    begin = time.perf_counter()
    spec, options, subject = get_model(model), ModelOptions(), typical_subject(population)
    if not set(subject.parameters) <= set(spec.names):
        raise InputError(f"nothing typical is known for model {model!r}; choose another model")
    trial = virtual_trial(subject, trajectory, model=model, noise=0.0)
    vector = spec.vector(subject.truth(model, options), options)
    columns = [spec.names.index(name) for name in spec.free]
    torque, jacobian = spec.simulator(trial, options).torque_jacobian(vector, columns)
    sigma = noise * float(np.abs(torque).mean())
    rows = np.vstack([jacobian, np.zeros(trial.n)])
    R, _, _ = compress(rows)
    dof = trial.n - len(spec.free)
    if dof <= 0:
        raise InputError(f"{trial.n} samples cannot tell {len(spec.free)} parameters; measure more")
    result = covariance(R, spec.free, max(sigma, 1e-12) ** 2 * dof, trial.n)
    return {
        "model": model,
        "population": population,
        "torque_rms": float(np.sqrt(np.mean(torque**2))),
        "noise_Nm": sigma,
        "ipde": ipde(result.correlation) if len(result.names) > 1 else None,
        "parameters": _parameters(spec, vector, result),
        "correlation": {"names": list(result.names), "matrix": result.correlation.tolist()},
        "milliseconds": round(1e3 * (time.perf_counter() - begin), 3),
    }


def _parameters(spec: Any, vector: Any, result: Any) -> list[Mapping[str, Any]]:
    rows: list[Mapping[str, Any]] = []
    for p, value in zip(spec.parameters, vector.tolist(), strict=True):
        sem = relative = None
        if p.name not in spec.free:
            verdict, note = "fixed", "fixed, not estimated"
        elif p.name in result.names:
            j = result.names.index(p.name)
            sem = float(np.sqrt(result.matrix[j, j]))
            half = half_width(sem, result.dof)
            relative = sem / abs(value) if value else None
            judged, note = judge_interval(p.name, value, half, result, p.unit)
            verdict = str(judged)
        else:
            verdict, note = "weak", judge_singular(p.name, result.directions)
        rows.append(
            {
                "name": p.name, "unit": p.unit, "meaning": p.meaning, "value": value, "sem": sem,
                "relative": relative, "verdict": verdict, "note": note,
            }
        )  # fmt: skip
    return rows
