"""One job of the cohort, from plain settings to plain numbers."""

import math
from collections.abc import Mapping, Sequence
from typing import Any

import numpy as np

import surae
from surae import ComputationError, ModelInputs
from surae.assessment import vaf
from surae.model import get_model
from surae.protocol import Protocol, chirp_rate
from surae.studies import make_baseline
from surae_thesis.cohort.members import CohortSubject, make_cohort
from surae_thesis.cohort.trials import cohort_inputs

#: Samples of the largest torque that count as its peaks.
PEAK = 0.05
#: Steps of the finite differences that look past a torque's chatter, as parts of the parameters,
#: and evaluations of the torque's derivatives.
_STEP, _EVALUATIONS = 0.01, 25


def fit_job(**settings: Any) -> dict[str, Any]:
    """Fit recordings of one subject, judge the fit and let it predict others; see `fitted`.

    Returns
    -------
    dict
        Status, VAF, parameters beside the truth, correlation, predictions, sizes of torque parts.
    """
    who, without = make_cohort(settings["seed"])[settings["member"]], settings["without"]
    fit = fitted(**settings)
    truth = _truth(who, without)
    sums = [start.sse for start in fit.result.starts]
    return {
        "status": fit.status,
        "n": fit.result.problem.n,
        "vaf": _finite(fit.vaf),
        "ipde": _finite(fit.ipde),
        # Whether the default start alone finds the best minimum, to a thousandth of its sum.
        "first_start": bool(sums[0] <= 1.001 * min(sums)),
        "parameters": {
            name: {
                "value": _finite(p.value),
                "sem": _finite(p.sem),
                "ci95": None if p.ci95 is None else [_finite(end) for end in p.ci95],
                "free": p.free,
                "at_bound": p.at_bound,
                "true": _finite(truth.get(name)),
            }
            for name, p in fit.parameters.items()
        },
        "correlation": {
            "names": list(fit.covariance.names),
            "matrix": np.round(fit.correlation, 6).tolist(),
        },
        "predicted": [
            {"protocol": protocol, "repetition": repetition, "vaf": _predicted(fit, inputs)}
            for protocol, repetition in settings["predicted"]
            for inputs in [
                cohort_inputs(
                    who, protocol, repetition, rate_hz=settings["rate_hz"], without=without
                )
            ]
        ],
        "sizes": _sizes(fit),
    }


def fitted(
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
) -> surae.Fit:
    """Fit recordings, protocol and repetition each, of a member of the cohort, counted from 0.

    Several are one joint fit. Beside the model's own free parameters it estimates `free`; all
    recordings are spared the imperfections `without`; the options are those of the model. What it
    is to predict does not matter to the fit.
    """
    del predicted
    who = make_cohort(seed)[member]
    inputs = [
        cohort_inputs(who, protocol, repetition, rate_hz=rate_hz, without=without)
        for protocol, repetition in trials
    ]
    return surae.fit(
        inputs, model, free=tuple(free), starts=starts, seed=seed, quality=(), **options
    )


def baseline_job(
    *, seed: int, protocol: str, model: str, subjects: int, rate_hz: float
) -> dict[str, float]:
    """Mean standard errors of simulations of the protocol that the thesis chose (4.1.5).

    That is the motion before it was adapted to the device: chirp of 0.2 rad and factor 0.5.
    """
    protocol_ = Protocol(
        profile=protocol, chirp_amplitude=0.2, chirp_rate=chirp_rate(0.5), rate_hz=rate_hz
    )
    return dict(make_baseline(protocol_, model, subjects, seed).sem)


def strength_job(*, seed: int, member: int, protocol: str, rate_hz: float) -> dict[str, float]:
    """Largest torque [Nm]: measured, and of the leg on Table 2's tendons with ε0 in metres."""
    who = make_cohort(seed)[member]
    inputs = cohort_inputs(who, protocol, 1, rate_hz=rate_hz)
    printed = surae.simulate("muscle-tendon", who.subject.parameters, inputs)
    return {"measured": _largest(_measured(inputs)), "printed": _largest(printed)}


def explicit_job(
    *,
    seed: int,
    member: int,
    protocol: str,
    rate_hz: float,
    implicit: Mapping[str, float],
) -> dict[str, float | None]:
    """What a fair optimiser makes of the thesis's explicit scheme, model 2.0, repetition 1.

    Least squares whose finite differences are wider than the chatter of the torque, as a
    general-purpose solver would be used, from the default start and from the parameters of the
    implicit fit.

    Returns
    -------
    dict
        VAF [%] ``"replayed"`` of the explicit scheme with the implicit fit's parameters, and
        fitted from either start: ``"default"``, ``"warm"``.
    """
    from scipy.optimize import least_squares

    inputs = cohort_inputs(make_cohort(seed)[member], protocol, 1, rate_hz=rate_hz)
    parameters = [p for p in get_model("muscle").parameters if p.name in implicit]
    low, high = (np.array([getattr(p, end) for p in parameters]) for end in ("lower", "upper"))
    measured = _measured(inputs)
    size = np.maximum(np.abs([p.start for p in parameters]), 1e-9)

    def residual(scaled: np.ndarray[Any, Any]) -> Any:
        values = dict(zip([p.name for p in parameters], (scaled * size).tolist(), strict=True))
        try:
            torque = surae.simulate("muscle-tendon", values, inputs, integrator="explicit-euler")
        except ComputationError:
            return np.full(inputs.n, 1e3)
        return torque - measured

    def followed(start: Sequence[float], evaluations: int) -> float | None:
        inside = np.clip(np.array(start), low + 1e-6 * (high - low), high - 1e-6 * (high - low))
        if not evaluations:
            return _finite(vaf(measured, residual(inside / size)))
        end = least_squares(
            residual, inside / size, bounds=(low / size, high / size), x_scale=0.1,
            diff_step=_STEP, max_nfev=evaluations,
        )  # fmt: skip
        return _finite(vaf(measured, end.fun))

    warm = [implicit[p.name] for p in parameters]
    return {
        "replayed": followed(warm, 0),
        "default": followed([p.start for p in parameters], _EVALUATIONS),
        "warm": followed(warm, _EVALUATIONS),
    }


def _truth(who: CohortSubject, without: Sequence[str]) -> dict[str, float]:
    """What the leg really has of the parameters of a fit.

    Not its EMG weights: there the electrodes' crosstalk and the muscles without electrodes are
    part of what a weight stands for.
    """
    tendons = {} if "tendons" in without else dict(who.subject.tendons)
    rest = {n: v for n, v in who.subject.parameters.items() if n not in ("g1", "g2", "g3", "g4")}
    return {**rest, **tendons}


def _predicted(fit: surae.Fit, inputs: ModelInputs) -> float | None:
    """VAF of a recording that the fit predicts [%]."""
    try:
        return _finite(fit.predict(inputs).vaf)
    except ComputationError:
        return None


def _sizes(fit: surae.Fit) -> dict[str, float | None]:
    """Largest size of each part of the torque [Nm], and what is missing at the peaks."""
    inputs = fit.result.problem.inputs
    parts = [fit.parts(number) for number in range(len(inputs))]
    sizes: dict[str, float | None] = {
        name: _finite(max(_largest(getattr(part, name)) for part in parts))
        for name in ("neural", "tissue", "inertial", "gravitational")
    }
    measured = np.concatenate([_measured(recording) for recording in inputs])
    missing = np.concatenate(fit.result.residuals)
    high = np.abs(measured) >= np.quantile(np.abs(measured), 1.0 - PEAK)
    short = float(np.mean(np.sign(measured[high]) * missing[high]))
    return {
        **sizes,
        "measured": _largest(measured),
        "short_at_peaks": _finite(short / float(np.mean(np.abs(measured[high])))),
    }


def _measured(inputs: ModelInputs) -> Any:
    assert inputs.torque is not None  # every recording of the cohort has one
    return inputs.torque


def _largest(values: Any) -> float:
    return float(np.abs(values).max())


def _finite(value: float | None) -> float | None:
    """A number, or None where there is none."""
    return None if value is None or not math.isfinite(value) else float(value)
