"""One fit of the cohort, from plain settings to plain numbers."""

import math
from collections.abc import Mapping, Sequence
from typing import Any

import numpy as np

from surae.assessment import assess
from surae.assessment.validation.prediction import predict, predict_others
from surae.errors import ComputationError
from surae.estimation import FitResult, fit_problem, make_problem
from surae.model import ModelOptions, TorqueParts, get_model
from surae.protocol import Protocol, chirp_rate
from surae.studies.baseline import simulated_baseline
from surae.studies.cohort import CohortSubject, make_cohort
from surae.studies.cohort_trials import cohort_inputs
from surae.units import FloatArray

#: Samples of the largest torque that count as its peaks.
PEAK = 0.05


def fit_job(
    *,
    seed: int,
    member: int,
    trials: Sequence[tuple[str, int]],
    model: str,
    free: Sequence[str],
    without: Sequence[str],
    predicted: Sequence[tuple[str, int]],
    rate_hz: float,
    starts: int,
    options: Mapping[str, Any],
) -> dict[str, Any]:
    """Fit recordings of one subject, judge the fit and let it predict others.

    Parameters
    ----------
    seed, member : int
        Seed of the cohort, and number of the subject in it, from 0.
    trials : sequence of (str, int)
        Protocol and repetition of each recording; several are one joint fit.
    model, free : str, sequence of str
        What is fitted, and what it estimates beside its own free parameters.
    without : sequence of str
        Imperfections that all recordings are spared.
    predicted : sequence of (str, int)
        Recordings to predict.
    rate_hz : float
        Of the signals [Hz].
    starts : int
        Of the fit.
    options : mapping
        Of the model, see `surae.model.ModelOptions`.

    Returns
    -------
    dict
        Status, VAF, parameters beside the truth, correlation, predictions, sizes of torque parts.
    """
    who = make_cohort(seed)[member]
    result = fitted(
        seed=seed, member=member, trials=trials, model=model, free=free, without=without,
        rate_hz=rate_hz, starts=starts, options=options,
    )  # fmt: skip
    assessment = assess(result)
    truth = _truth(who, without)
    return {
        "status": result.status,
        "message": result.message,
        "n": result.problem.n,
        "vaf": _finite(assessment.vaf),
        "vafs": [_finite(one.vaf) for one in assessment.recordings],
        "ipde": _finite(assessment.ipde),
        "first_start": _first_start(result),
        "parameters": {
            name: {
                "value": _finite(p.value),
                "sem": _finite(p.sem),
                "robust": _finite(p.sem_robust),
                "ci95": None if p.ci95 is None else [_finite(end) for end in p.ci95],
                "free": p.free,
                "at_bound": p.at_bound,
                "verdict": str(p.verdict),
                "true": _finite(truth.get(name)),
            }
            for name, p in assessment.parameters.items()
        },
        "correlation": {
            "names": list(assessment.covariance.names),
            "matrix": np.round(assessment.covariance.correlation, 6).tolist(),
        },
        "predicted": [_predicted(result, who, one, without, rate_hz) for one in predicted],
        "sizes": _sizes(result),
    }


def fitted(
    *,
    seed: int,
    member: int,
    trials: Sequence[tuple[str, int]],
    model: str,
    free: Sequence[str] = (),
    without: Sequence[str] = (),
    rate_hz: float,
    starts: int,
    options: Mapping[str, Any],
    **others: object,
) -> FitResult:
    """The fit itself; see `fit_job`, whose other settings make no difference."""
    del others
    who = make_cohort(seed)[member]
    inputs = [
        cohort_inputs(who, protocol, repetition, rate_hz=rate_hz, without=without)
        for protocol, repetition in trials
    ]
    problem = make_problem(inputs, model, free=tuple(free), options=ModelOptions.of(**options))
    return fit_problem(problem, starts=starts, seed=seed)


def baseline_job(
    *, seed: int, protocol: str, model: str, subjects: int, rate_hz: float
) -> dict[str, float]:
    """Mean standard errors of simulations of the protocol that the thesis chose (4.1.5).

    That is the motion before it was adapted to the device: chirp of 0.2 rad and factor 0.5.
    """
    return simulated_baseline(
        Protocol(
            profile=protocol, chirp_amplitude=0.2, chirp_rate=chirp_rate(0.5), rate_hz=rate_hz
        ),
        model, subjects, seed,
    )  # fmt: skip


def strength_job(*, seed: int, member: int, protocol: str, rate_hz: float) -> dict[str, float]:
    """Largest measured torque, and that of the same leg and effort on rigid tendons [Nm]."""
    who = make_cohort(seed)[member]
    inputs = cohort_inputs(who, protocol, 1, rate_hz=rate_hz)
    spec, options = get_model("muscle"), ModelOptions()
    vector = spec.vector(who.subject.truth("muscle"), options)
    torque = spec.simulator(inputs, options).torque(vector)
    measured = inputs.torque if inputs.torque is not None else np.zeros(1)
    return {"measured": float(np.abs(measured).max()), "rigid": float(np.abs(torque).max())}


def replay_job(
    *, seed: int, member: int, protocol: str, rate_hz: float, values: Mapping[str, float]
) -> dict[str, float | None]:
    """VAF of model 2.0 by the thesis's explicit scheme with given parameters, repetition 1 [%]."""
    inputs = cohort_inputs(make_cohort(seed)[member], protocol, 1, rate_hz=rate_hz)
    spec, options = get_model("muscle-tendon"), ModelOptions(integrator="explicit-euler")
    try:
        vaf = predict(spec, options, values, [inputs])[0].vaf
    except ComputationError:
        return {"vaf": None}
    return {"vaf": _finite(vaf)}


def _truth(who: CohortSubject, without: Sequence[str]) -> dict[str, float]:
    """What the leg really has of the parameters of a fit.

    Not its EMG weights: there the electrodes' crosstalk and the muscles without electrodes are
    part of what a weight stands for.
    """
    tendons = {} if "tendons" in without else dict(who.subject.tendons)
    rest = {n: v for n, v in who.subject.parameters.items() if n not in ("g1", "g2", "g3", "g4")}
    return {**rest, **tendons}


def _predicted(
    result: FitResult,
    who: CohortSubject,
    trial: tuple[str, int],
    without: Sequence[str],
    rate_hz: float,
) -> dict[str, Any]:
    protocol, repetition = trial
    inputs = cohort_inputs(who, protocol, repetition, rate_hz=rate_hz, without=without)
    found: dict[str, Any] = {"protocol": protocol, "repetition": repetition}
    try:
        one = predict_others(result, [inputs])[0]
    except ComputationError:
        return {**found, "vaf": None, "rmse": None, "bias": None}
    return {
        **found,
        "vaf": _finite(one.vaf),
        "rmse": _finite(one.rmse),
        "bias": _finite(one.bias),
    }


def _first_start(result: FitResult) -> bool:
    """Whether the default start alone finds the best minimum, to a thousandth of its sum."""
    best = min(one.sse for one in result.starts)
    return bool(result.starts[0].sse <= 1.001 * best)


def _sizes(result: FitResult) -> dict[str, float | None]:
    """Largest size of each part of the torque [Nm], and what is missing at the peaks."""
    spec, vector = result.problem.spec, _vector(result)
    parts: list[TorqueParts] = [
        spec.simulator(one, result.problem.options).parts(vector) for one in result.problem.inputs
    ]
    sizes: dict[str, float | None] = {
        name: _finite(max(float(np.abs(getattr(one, name)).max()) for one in parts))
        for name in ("neural", "tissue", "inertial", "gravitational")
    }
    measured = np.concatenate(
        [one.torque for one in result.problem.inputs if one.torque is not None]
    )
    missing = np.concatenate(result.residuals)
    high = np.abs(measured) >= np.quantile(np.abs(measured), 1.0 - PEAK)
    short = float(np.mean(np.sign(measured[high]) * missing[high]))
    sizes["measured"] = _finite(float(np.abs(measured).max()))
    sizes["short_at_peaks"] = _finite(short / float(np.mean(np.abs(measured[high]))))
    return sizes


def _vector(result: FitResult) -> FloatArray:
    return np.array([result.values[name] for name in result.problem.spec.names])


def _finite(value: float | None) -> float | None:
    """A number, or None where there is none."""
    return None if value is None or not math.isfinite(value) else float(value)
