"""Fits and posteriors as ArviZ and xarray have them."""

from collections.abc import Mapping
from importlib.metadata import PackageNotFoundError, version
from typing import Any

import numpy as np

from surae.base.errors import InputError
from surae.base.units import FloatArray
from surae.inference import AssessedFit
from surae.inference.coordinates import is_straight
from surae.inference.least_squares.residuals import simulators
from surae.inference.posterior.linearised import measured
from surae.model.prior import Prior
from surae.recording.frames import library

#: Chains that independent draws are dealt to, so that ArviZ can compare them.
_CHAINS = 4


def inference_data(groups: Mapping[str, Any], made_by: str, status: str, message: str) -> Any:
    """Datasets by group as the ArviZ that is installed has them.

    That is a DataTree, before ArviZ 1.0, which Python 3.11 has, an ``InferenceData``.
    """
    xarray = library("xarray", "InferenceData")
    about = {
        "inference_library": "surae",
        "inference_library_version": made_by,
        "status": status,
        "message": message,
    }
    try:
        before_one = int(version("arviz").split(".")[0]) < 1
    except PackageNotFoundError:
        before_one = False
    if before_one:
        from arviz import InferenceData

        return InferenceData(attrs=about, **groups)
    root = {"/": xarray.Dataset(attrs=about)}
    return xarray.DataTree.from_dict(root | {f"/{name}": group for name, group in groups.items()})


def drawn(draws: FloatArray, units: Mapping[str, str]) -> Any:
    """Draws of shape (n, p) by chain, of parameters in the order of their `units`."""
    xarray = library("xarray", "InferenceData")
    chains = _CHAINS if len(draws) % _CHAINS == 0 else 1
    variables = {
        name: (("chain", "draw"), column.reshape(chains, -1), {"units": units[name]})
        for name, column in zip(units, draws.T, strict=True)
    }
    along = {"chain": np.arange(chains), "draw": np.arange(len(draws) // chains)}
    return xarray.Dataset(variables, along)


def prior_draws(
    priors: Mapping[str, Prior], units: Mapping[str, str], count: int, seed: int
) -> Any:
    """Draws of priors, in the parameters' units."""
    rng = np.random.default_rng([seed, 2])
    by_name = {}
    for name, prior in priors.items():
        drawn_values = prior.centre + prior.spread * rng.standard_normal(count)
        by_name[name] = np.exp(drawn_values) if prior.log else drawn_values
    return drawn(np.array([*by_name.values()]).T, {name: units[name] for name in by_name})


def of_fit(fit: AssessedFit, draws: int, seed: int, *, log_likelihood: bool) -> Any:
    """What a fit leaves possible (`Uncertainty.draw`), its priors, and what it has seen."""
    result = fit.result
    assessment = fit.assessment
    xarray = library("xarray", "InferenceData")
    known = assessment.uncertainty
    problem = result.problem
    every = {**assessment.parameters, **assessment.nuisances}
    free = [name for name in problem.free if every[name].ci95 is not None]
    if not free:
        raise InputError("no parameter of this fit has an interval, so there is nothing to draw")
    units = {name: every[name].unit for name in free}
    away = known.away(draws, seed)
    legs = known.legs_at(away)
    groups = {"posterior": drawn(legs[:, [known.names.index(name) for name in free]], units)}
    priors = dict(problem.priors)
    for n, p in ({} if result.posterior is None else result.posterior.population).items():
        log = not is_straight(n)
        priors[n] = Prior(float(np.exp(p.mean)) if log else p.mean, p.sd, "population", log)
    for n, p in result.solution.beliefs.items():
        priors[n] = Prior(p.mean, p.sd, "laboratory", log=False)
    if shown := {n: prior for n, prior in priors.items() if n in units}:
        groups["prior"] = prior_draws(shown, units, draws, seed)
    samples = np.concatenate(
        [np.arange(recording.n)[recording.counts] for recording in problem.inputs]
    )
    which = np.concatenate(
        [np.full(int(recording.counts.sum()), i) for i, recording in enumerate(problem.inputs)]
    )
    time = np.concatenate([recording.time[recording.counts] for recording in problem.inputs])
    along = {"sample": samples, "recording": ("sample", which), "time": ("sample", time)}
    torque = np.concatenate([measured(recording)[recording.counts] for recording in problem.inputs])
    groups["observed_data"] = xarray.Dataset({"torque": ("sample", torque, {"units": "Nm"})}, along)
    if log_likelihood:
        # arms and paths leave the torque as it is: it is computed at those of the fit
        each = np.array([_log_likelihood(fit, leg) for leg in known.at(away)])
        chains = groups["posterior"].sizes["chain"]
        by = ("chain", "draw", "sample")
        groups["log_likelihood"] = xarray.Dataset(
            {"torque": (by, each.reshape(chains, -1, len(torque)))}, along
        )
    message = "Gaussian about the estimates, on their scale; `profile` follows valleys"
    if left := [p.name for p in every.values() if p.free and p.name not in units]:
        message += f"; without an interval, left out: {', '.join(left)}"
    return inference_data(groups, result.versions["surae"], "approximation", message)


def _log_likelihood(fit: AssessedFit, leg: FloatArray) -> FloatArray:
    """Logarithm of the likelihood of every sample that counts, its noise taken for white."""
    problem = fit.result.problem
    sigma2 = fit.assessment.covariance.sigma2
    parts = []
    values = problem.values(leg[: len(problem.free)])
    for simulator, recording in zip(simulators(problem), problem.inputs, strict=True):
        weight = np.ones(recording.n) if recording.weight is None else recording.weight
        e = (measured(recording) - simulator.torque(values))[recording.counts]
        variance = sigma2 / weight[recording.counts]
        parts.append(-0.5 * (e**2 / variance + np.log(2.0 * np.pi * variance)))
    return np.concatenate(parts)
