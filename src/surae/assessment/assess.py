"""From a fit to what it is worth: goodness, intervals, correlations and verdicts."""

from collections.abc import Mapping
from dataclasses import dataclass

import numpy as np

from surae.assessment.quality import rmse, vaf
from surae.assessment.uncertainty import Covariance, covariance, half_width, ipde
from surae.assessment.verdict import Verdict, judge_interval, judge_singular
from surae.estimation import FitResult
from surae.model import adapted
from surae.signals import ModelInputs
from surae.units import FloatArray


@dataclass(frozen=True, slots=True)
class ParameterEstimate:
    """One parameter of a fit.

    Attributes
    ----------
    name, unit, meaning, group : str
        As in `surae.model.Parameter`.
    value : float
        Estimate, or the value it was fixed at.
    sem : float or None
        Standard error, equation (34); None where there is none, and `note` says why.
    ci95 : tuple of float, or None
        95 % interval.
    lower, upper : float
        Bounds of the fit.
    free, at_bound : bool
        Whether it was estimated, and whether the estimate lies at a bound.
    verdict : Verdict
        identified, weak, at-bound or fixed.
    note : str
        The verdict in a plain sentence.
    """

    name: str
    unit: str
    meaning: str
    group: str
    value: float
    sem: float | None
    ci95: tuple[float, float] | None
    lower: float
    upper: float
    free: bool
    at_bound: bool
    verdict: Verdict
    note: str


@dataclass(frozen=True, slots=True)
class RecordingQuality:
    """How well one recording is followed where its samples count: VAF [%], RMSE, bias [Nm]."""

    name: str
    path: str | None
    sha256: str | None
    n: int
    rate_hz: float
    vaf: float
    rmse: float
    bias: float


@dataclass(frozen=True, slots=True)
class Assessment:
    """What a fit is worth.

    Attributes
    ----------
    vaf, rmse : float
        Of all recordings together [%, Nm]; NaN where the model gave no finite torque.
    parameters : mapping of str to ParameterEstimate
        All parameters of the model, in its order.
    covariance : Covariance
        Of the estimates that have one.
    ipde : float or None
        Equation (35); None, with `ipde_note` saying why, when fewer than two have a variance.
    ipde_note : str
        Which parameters it leaves out, or why there is none; empty when it has them all.
    recordings : tuple of RecordingQuality
        One for each recording.
    """

    vaf: float
    rmse: float
    parameters: Mapping[str, ParameterEstimate]
    covariance: Covariance
    ipde: float | None
    ipde_note: str
    recordings: tuple[RecordingQuality, ...]


def assess(result: FitResult) -> Assessment:
    """Judge a fit.

    Parameters
    ----------
    result : FitResult
        What was found.

    Returns
    -------
    Assessment
        Goodness of fit, intervals, correlations and verdicts.
    """
    problem = result.problem
    estimated = covariance(result.R, problem.free, result.sse, problem.n, result.at_bound)
    pairs = [_counted(*pair) for pair in zip(problem.inputs, result.residuals, strict=True)]
    recordings = tuple(
        RecordingQuality(
            name=one.name,
            path=one.files[0].path if one.files else None,
            sha256=one.files[0].sha256 if one.files else None,
            n=one.n,
            rate_hz=one.rate_hz,
            vaf=vaf(torque, residual),
            rmse=rmse(residual),
            bias=float(residual.mean()),
        )
        for one, (torque, residual) in zip(problem.inputs, pairs, strict=True)
    )
    left_out = [name for name in problem.free if name not in estimated.names]
    several = len(estimated.names) > 1
    note = f"without {', '.join(left_out)}" if left_out else ""
    if not several:
        note = "fewer than two parameters have a variance"
    residuals = np.concatenate([residual for _, residual in pairs])
    return Assessment(
        vaf=vaf(np.concatenate([torque for torque, _ in pairs]), residuals),
        rmse=rmse(residuals),
        parameters=_parameters(result, estimated),
        covariance=estimated,
        ipde=ipde(estimated.correlation) if several else None,
        ipde_note=note,
        recordings=recordings,
    )


def _counted(one: ModelInputs, residual: FloatArray) -> tuple[FloatArray, FloatArray]:
    """Measured torque and residual where samples count."""
    torque = one.torque if one.torque is not None else np.full(one.n, np.nan)
    if one.weight is None:
        return torque, residual
    return torque[one.weight > 0], residual[one.weight > 0]


def _parameters(result: FitResult, estimated: Covariance) -> dict[str, ParameterEstimate]:
    problem = result.problem
    table = adapted(problem.spec.parameters, problem.options, problem.inputs[0].emg_unit)
    bounds = dict(
        zip(problem.free, zip(problem.lower.tolist(), problem.upper.tolist(), strict=True),
            strict=True)
    )  # fmt: skip
    variances = dict(zip(estimated.names, np.diag(estimated.matrix).tolist(), strict=True))
    at_bound = result.at_bound
    parameters = {}
    for name, p in table.items():
        value = result.values[name]
        lower, upper = bounds.get(name, (p.lower, p.upper))
        sem = ci95 = None
        if name not in problem.free:
            verdict, note = Verdict.FIXED, "fixed, not estimated"
        elif name in at_bound:
            side = "lower" if value - lower < upper - value else "upper"
            verdict, note = (
                Verdict.AT_BOUND,
                (
                    f"at its {side} bound: no interval; the data ask for a value beyond it, or say "
                    "nothing about it"
                ),
            )
        elif name in variances:
            sem = float(np.sqrt(variances[name]))
            half = half_width(sem, estimated.dof)
            ci95 = (value - half, value + half)
            verdict, note = judge_interval(name, value, half, estimated)
        elif not np.isfinite(estimated.sigma2):
            verdict, note = Verdict.WEAK, "no interval: the model gives no finite torque here"
        else:
            verdict, note = Verdict.WEAK, judge_singular(name, estimated.directions)
        parameters[name] = ParameterEstimate(
            name, p.unit, p.meaning, p.group, value, sem, ci95, lower, upper,
            name in problem.free, name in at_bound, verdict, note,
        )  # fmt: skip
    return parameters
