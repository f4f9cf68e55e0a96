"""FIT.json: a fit as a file, readable by people and programs, loaded again without loss."""

import math
from collections.abc import Mapping, Sequence
from dataclasses import dataclass
from typing import Any

import numpy as np

from surae._version import __version__
from surae.assessment.assess import Assessment
from surae.assessment.parameter import ParameterEstimate
from surae.assessment.saved.json_file import FORMAT, check_format, decode, encode, read_json, real
from surae.assessment.saved.parts_json import (
    family_as_dict,
    outliers_as_dict,
    read_family,
    read_outliers,
    read_trace,
    trace_as_dict,
)
from surae.assessment.uncertainty.snsem import Baseline, baseline_as_dict, read_baseline
from surae.errors import InputError
from surae.estimation import FitProblem, FitResult, FitSettings, Outliers, Prior, Start
from surae.files import PathLike, shown, write_json
from surae.frozen import FrozenDict
from surae.model import ModelOptions, ModelSpec, check_value, get_model, with_optional
from surae.quality.finding import Quality, quality_of


@dataclass(frozen=True, slots=True)
class SavedFit:
    """What a FIT.json holds."""

    result: FitResult  #: The fit.
    baseline: Baseline | None  #: The simulations that its standard errors were compared with.
    quality: tuple[Quality, ...]  #: What was found in each recording; empty where nobody looked.


def save_fit(
    path: PathLike,
    result: FitResult,
    assessment: Assessment,
    quality: Sequence[Quality] = (),
) -> None:
    """Write a fit to `path`, all of it or nothing."""
    write_json(path, as_dict(result, assessment, quality))


def load_saved(path: PathLike) -> SavedFit:
    """Read the fit that `save_fit` wrote; equal to the one saved, to the last bit."""
    data = read_json(path)
    check_format(data, path)
    try:
        compared = data.get("snsem")
        baseline = None if compared is None else read_baseline(compared["baseline"])
        quality = tuple(quality_of(finding) for finding in data.get("findings", ()))
        return SavedFit(_result(data), baseline, quality)
    except InputError as error:
        raise InputError(f"{shown(path)}: {error}") from None
    except KeyError as error:
        raise InputError(
            f"{shown(path)}: not a whole FIT.json, {error} is missing; give one that "
            "`surae fit --output` wrote"
        ) from None
    except (TypeError, ValueError, AttributeError, IndexError, OverflowError) as error:
        raise InputError(f"{shown(path)}: a damaged FIT.json ({error}); fit again") from None


def as_dict(
    result: FitResult, assessment: Assessment, quality: Sequence[Quality] = ()
) -> dict[str, Any]:
    """A fit as plain data, in the shape of FIT.json."""
    problem = result.problem
    return {
        "surae": result.versions.get("surae", __version__),
        "format": FORMAT,
        "model": problem.spec.name,
        "options": problem.options.as_dict(),
        "status": result.status,
        "message": result.message,
        "vaf": _number(assessment.vaf),
        "vaf_weighted": _optional(assessment.vaf_weighted),
        "rmse_Nm": _number(assessment.rmse),
        "parameters": {p.name: _parameter(p) for p in assessment.parameters.values()},
        "nuisances": {p.name: _parameter(p) for p in assessment.nuisances.values()},
        "correlation": {
            "names": list(assessment.covariance.names),
            "matrix": assessment.covariance.correlation.tolist(),
            "inseparable": [list(names) for names in assessment.covariance.directions],
        },
        "interval": str(assessment.interval),
        "interval_note": assessment.interval_note,
        "adequacy": {
            "grade": str(assessment.adequacy.grade),
            "reasons": list(assessment.adequacy.reasons),
            "r2": _number(assessment.adequacy.r2),
        },
        "ipde": assessment.ipde,
        "ipde_note": assessment.ipde_note,
        "recordings": [
            {
                "name": quality.name,
                "path": quality.path,
                "sha256": quality.sha256,
                "n": quality.n,
                "rate_hz": quality.rate_hz,
                "vaf": _number(quality.vaf),
                "vaf_weighted": _optional(quality.vaf_weighted),
                "r2": _number(quality.r2),
                "rmse_Nm": _number(quality.rmse),
                "bias_Nm": _number(quality.bias),
                "residual": {
                    "lag1": _number(white.lag1),
                    "ljung_box": _number(white.statistic),
                    "lags": white.lags,
                    "p_value": _number(white.p_value),
                },
            }
            for quality, white in zip(assessment.recordings, assessment.whiteness, strict=True)
        ],
        "findings": [finding.as_dict() for finding in quality],
        "snsem": None
        if assessment.baseline is None
        else {
            "values": dict(assessment.snsem),
            "baseline": baseline_as_dict(assessment.baseline),
        },
        "seed": result.seed,
        "starts": {
            "n": len(result.starts),
            "agreeing": result.agreeing,
            "all": [
                {
                    "initial": dict(start.initial),
                    "values": dict(start.values),
                    "sse": _number(start.sse),
                    "outcome": start.outcome,
                    "iterations": start.iterations,
                }
                for start in result.starts
            ],
        },
        "seconds": result.seconds,
        "versions": dict(result.versions),
        "settings": problem.settings.as_dict(),
        "free": list(problem.free),
        "priors": {
            name: {"median": prior.median, "spread": prior.spread}
            for name, prior in problem.priors.items()
        },
        "outliers": outliers_as_dict(result.outliers),
        "family": family_as_dict(result.family),
        "sse": _number(result.sse),
        "R": encode(result.R),
        "traces": [
            trace_as_dict(recording, residual)
            for recording, residual in zip(problem.inputs, result.residuals, strict=True)
        ],
    }


def _parameter(p: ParameterEstimate) -> dict[str, Any]:
    return {
        "value": p.value,
        "unit": p.unit,
        "sem": p.sem,
        "sem_robust": p.sem_robust,
        "ci95": None if p.ci95 is None else list(p.ci95),
        "interval": None if p.interval is None else str(p.interval),
        "lower": p.lower,
        "upper": p.upper,
        "free": p.free,
        "at_bound": p.at_bound,
        "verdict": str(p.verdict),
        "note": p.note,
        "ci95_repeat": None if p.ci95_repeat is None else list(p.ci95_repeat),
        "repeatable": p.repeatable,
        "budget": dict(p.budget),
    }


def _number(value: float) -> float | None:
    """A number that is not finite has no place in JSON."""
    return value if math.isfinite(value) else None


def _optional(value: float | None) -> float | None:
    return None if value is None else _number(value)


def _result(data: Mapping[str, Any]) -> FitResult:
    model, table = data["model"], {**data["parameters"], **data.get("nuisances", {})}
    spec = with_optional(get_model(model), table)
    options = ModelOptions.of(**data["options"])
    free = tuple(name for name in spec.names if table[name]["free"])
    values = {name: real(table[name]["value"]) for name in spec.names}
    traces = data["traces"]
    starts = data["starts"]
    if not traces or not starts["all"] or not free:
        raise ValueError("no recording, start or free parameter")
    for name in spec.names:
        check_value(spec.parameters[spec.names.index(name)], values[name], spec)
    limits = np.array([[table[n]["lower"], table[n]["upper"]] for n in free], dtype=float)
    if not np.isfinite(limits).all():
        raise ValueError("a bound is not a number")
    outliers = read_outliers(data.get("outliers"), [int(trace["n"]) for trace in traces])
    problem = FitProblem(
        spec=spec,
        options=options,
        inputs=tuple(read_trace(trace) for trace in traces),
        free=free,
        base=np.array(
            [
                starts["all"][0]["initial"][name] if name in free else values[name]
                for name in spec.names
            ],
            dtype=float,
        ),
        lower=limits[:, 0],
        upper=limits[:, 1],
        priors=FrozenDict(
            (str(name), Prior(real(prior["median"]), real(prior["spread"])))
            for name, prior in data["priors"].items()
        ),
        settings=_settings(data, spec, outliers),
    )
    residuals = tuple(decode(trace["residual"], (int(trace["n"]),)) for trace in traces)
    sse = _sum(data["sse"])
    weights = [
        1.0 if recording.weight is None else recording.weight for recording in problem.inputs
    ]
    with np.errstate(over="ignore", invalid="ignore"):
        weighted = sum(float(np.sum(w * e**2)) for w, e in zip(weights, residuals, strict=True))
    if math.isfinite(sse) and not math.isclose(sse, weighted, rel_tol=1e-6):
        raise ValueError("the sum of squares is not that of the residuals")
    return FitResult(
        problem=problem,
        status=str(data["status"]),
        message=str(data["message"]),
        values=values,
        residuals=residuals,
        sse=sse,
        R=decode(data["R"], (len(free), len(free))),
        starts=tuple(
            Start(
                {str(name): real(value) for name, value in start["initial"].items()},
                {str(name): real(value) for name, value in start["values"].items()},
                _sum(start["sse"]),
                str(start["outcome"]),
                int(start["iterations"]),
            )
            for start in starts["all"]
        ),
        agreeing=int(starts["agreeing"]),
        seed=int(data["seed"]),
        seconds=real(data["seconds"]),
        versions={str(name): str(version) for name, version in data["versions"].items()},
        outliers=outliers,
        family=read_family(data.get("family"), free),
    )


def _settings(data: Mapping[str, Any], spec: ModelSpec, outliers: Outliers | None) -> FitSettings:
    """What was asked; of format 1, which does not say, what the result tells of it."""
    if "settings" in data:
        return FitSettings.from_dict(data["settings"])
    table, starts = data["parameters"], data["starts"]
    free = [name for name in spec.names if table[name]["free"]]
    held = [name for name in spec.free if name not in free]
    return FitSettings(
        model=spec.name,
        options=ModelOptions.of(**data["options"]),
        fixed={name: real(table[name]["value"]) for name in held},
        free=tuple(name for name in free if name not in spec.free),
        start={name: real(starts["all"][0]["initial"][name]) for name in free},
        bounds={name: (real(table[name]["lower"]), real(table[name]["upper"])) for name in free},
        priors={
            name: (real(prior["median"]), real(prior["spread"]))
            for name, prior in data["priors"].items()
        },
        loss=None if outliers is None else outliers.loss,
        prepared=bool(data["traces"][0]["prepared"]),
        starts=int(starts["n"]),
        seed=int(data["seed"]),
    )


def _sum(value: float | None) -> float:
    return math.inf if value is None else real(value)
