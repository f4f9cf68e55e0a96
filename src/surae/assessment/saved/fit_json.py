"""FIT.json: a fit as a file, readable by people and programs, loaded again without loss."""

import json
import math
from collections.abc import Mapping, Sequence
from dataclasses import dataclass
from typing import Any

import numpy as np

from surae._version import __version__
from surae.assessment.assess import Assessment, ParameterEstimate
from surae.assessment.saved.arrays import decode, encode
from surae.assessment.saved.outliers_json import outliers_as_dict, read_outliers
from surae.assessment.uncertainty.snsem import Baseline, baseline_as_dict, read_baseline
from surae.errors import InputError
from surae.estimation import FitProblem, FitResult, Prior, Start
from surae.files import PathLike, read_bytes, shown, write_json
from surae.model import ModelOptions, check_value, get_model, with_drives
from surae.quality.finding import Quality, quality_of
from surae.recording import MUSCLES, SourceFile
from surae.signals import EmgReference, ModelInputs

#: Of the file's layout; raised when an older surae could not read it.
FORMAT = 1
_SERIES = ("time", "angle", "velocity", "acceleration")


@dataclass(frozen=True, slots=True)
class SavedFit:
    """What a FIT.json holds.

    Attributes
    ----------
    result : FitResult
        The fit.
    baseline : Baseline or None
        The simulations that its standard errors were compared with.
    quality : tuple of Quality
        What was found in each recording; empty where nobody looked.
    """

    result: FitResult
    baseline: Baseline | None
    quality: tuple[Quality, ...]


def save_fit(
    path: PathLike,
    result: FitResult,
    assessment: Assessment,
    quality: Sequence[Quality] = (),
) -> None:
    """Write a fit to `path`, all of it or nothing.

    Raises
    ------
    InputError
        The file cannot be written.
    """
    write_json(path, as_dict(result, assessment, quality))


def load_saved(path: PathLike) -> SavedFit:
    """Read the fit that `save_fit` wrote; equal to the one saved, to the last bit.

    Raises
    ------
    InputError
        The file is missing, damaged, not a fit, or of a newer surae.
    """
    data = read_json(path)
    check_version(data, path)
    try:
        compared = data.get("snsem")
        baseline = None if compared is None else read_baseline(compared["baseline"])
        quality = tuple(quality_of(one) for one in data.get("findings", ()))
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


@dataclass(frozen=True, slots=True)
class GivenParameters:
    """Parameters from a file, and what else a FIT.json says of them.

    Attributes
    ----------
    values : mapping of str to float
        By name.
    model : str or None
        The model they belong to; None where the file does not say.
    options : mapping
        The model's options.
    emg_unit : str or None
        Unit of the EMG that the weights go with.
    """

    values: Mapping[str, float]
    model: str | None
    options: Mapping[str, Any]
    emg_unit: str | None


def read_parameters(path: PathLike) -> GivenParameters:
    """Parameter values from a FIT.json or from ``{"parameters": {"m": 2.0, …}}``.

    Raises
    ------
    InputError
        The file is missing, not JSON, or has no table of numbers under ``parameters``.
    """
    data = read_json(path)
    check_version(data, path)
    table = data.get("parameters")
    if not isinstance(table, dict) or not table:
        raise InputError(
            f'{shown(path)}: no parameters; write {{"parameters": {{"m": 2.0, …}}}} or give a '
            "FIT.json"
        )
    values = {}
    for name, entry in table.items():
        value = entry.get("value") if isinstance(entry, dict) else entry
        if isinstance(value, bool) or not isinstance(value, int | float):
            text = json.dumps(entry, ensure_ascii=False)
            raise InputError(f"{shown(path)}: parameter {name!r} is {text}; give a number")
        try:
            values[name] = float(value)
        except OverflowError:
            raise InputError(f"{shown(path)}: parameter {name!r} is too large a number") from None
    model, options, traces = data.get("model"), data.get("options", {}), data.get("traces")
    if not (isinstance(model, str | None) and isinstance(options, dict)):
        raise InputError(f"{shown(path)}: model must be a name, and options a table")
    units = {t.get("emg_unit") for t in traces if isinstance(t, dict)} if traces else set()
    return GivenParameters(values, model, options, units.pop() if len(units) == 1 else None)


def read_json(path: PathLike) -> dict[str, Any]:
    """A JSON object from a file.

    Raises
    ------
    InputError
        The file is missing or is not a JSON object.
    """
    content = read_bytes(path)
    try:
        data = json.loads(content.decode("utf-8"))
    except UnicodeDecodeError:
        raise InputError(f"{shown(path)}: not a text file, expected JSON") from None
    except RecursionError:
        raise InputError(f"{shown(path)}: nested too deeply, expected JSON of a fit") from None
    except json.JSONDecodeError as error:
        raise InputError(
            f"{shown(path)}: not JSON (line {error.lineno}, column {error.colno}: {error.msg})"
        ) from None
    except ValueError:
        raise InputError(f"{shown(path)}: a number in it has thousands of digits") from None
    if not isinstance(data, dict):
        raise InputError(
            f'{shown(path)}: expected a JSON object {{"…": …}}, found a {type(data).__name__}'
        )
    return data


def check_version(data: Mapping[str, Any], path: PathLike) -> None:
    """Refuse a file that a newer surae wrote: it may mean what this one does not know."""
    written = data.get("surae")
    if written is None:
        return
    layout = data.get("format", FORMAT)
    if not isinstance(written, str) or not isinstance(layout, int):
        raise InputError(f"{shown(path)}: a damaged FIT.json (surae or format); fit again")
    if _ordered(written) > _ordered(__version__) or layout > FORMAT:
        raise InputError(
            f"{shown(path)}: written by surae {written} in format {layout}, newer than this one "
            f"({__version__}, format {FORMAT}); upgrade surae to read it"
        )


def _ordered(version: str) -> tuple[int, ...]:
    """The leading numbers of a version, comparable."""
    numbers = []
    for part in version.split("."):
        if not part.isdecimal():
            break
        numbers.append(int(part))
    return tuple(numbers)


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
        "correlation": {
            "names": list(assessment.covariance.names),
            "matrix": assessment.covariance.correlation.tolist(),
            "inseparable": [list(names) for names in assessment.covariance.directions],
        },
        "interval": str(assessment.interval),
        "interval_note": assessment.interval_note,
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
        "findings": [one.as_dict() for one in quality],
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
        "free": list(problem.free),
        "priors": {
            name: {"median": prior.median, "spread": prior.spread}
            for name, prior in problem.priors.items()
        },
        "outliers": outliers_as_dict(result.outliers),
        "sse": _number(result.sse),
        "R": encode(result.R),
        "traces": [
            _trace(one, residual)
            for one, residual in zip(problem.inputs, result.residuals, strict=True)
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
    }


def _number(value: float) -> float | None:
    """A number that is not finite has no place in JSON."""
    return value if math.isfinite(value) else None


def _optional(value: float | None) -> float | None:
    return None if value is None else _number(value)


def _trace(one: ModelInputs, residual: Any) -> dict[str, Any]:
    torque = one.torque if one.torque is not None else np.zeros(0)
    return {
        "name": one.name,
        "rate_hz": one.rate_hz,
        "n": one.n,
        "emg_unit": one.emg_unit,
        "emg_reference": _reference_as_dict(one.emg_reference),
        "missing_emg": list(one.missing_emg),
        "prepared": one.prepared,
        "steps": list(one.steps),
        "fixed": dict(one.fixed),
        "files": [{"path": file.path, "sha256": file.sha256} for file in one.files],
        **{name: encode(getattr(one, name)) for name in _SERIES},
        "emg": encode(one.emg),
        "torque": encode(torque),
        "weight": None if one.weight is None else encode(one.weight),
        "emphasised": one.emphasised,
        "residual": encode(residual),
    }


def _reference_as_dict(reference: EmgReference | None) -> dict[str, Any] | None:
    if reference is None:
        return None
    return {
        "kind": reference.kind,
        "values_V": dict(zip(MUSCLES, reference.values, strict=True)),
        "recordings": reference.count,
        "files": [{"path": file.path, "sha256": file.sha256} for file in reference.files],
    }


def _reference(data: Mapping[str, Any] | None) -> EmgReference | None:
    if data is None:
        return None
    kind = data["kind"]
    if kind not in ("session", "mvc"):
        raise ValueError(f"emg_reference is of {kind!r:.40}")
    values = [data["values_V"][muscle] for muscle in MUSCLES]
    if any(value is not None and not _real(value) > 0 for value in values):
        raise ValueError("a reference of the EMG is not above zero")
    return EmgReference(
        kind=kind,
        values=tuple(None if value is None else _real(value) for value in values),
        files=tuple(SourceFile(str(f["path"]), str(f["sha256"])) for f in data["files"]),
        count=int(data["recordings"]),
    )


def _inputs(trace: Mapping[str, Any]) -> ModelInputs:
    n = int(trace["n"])
    return ModelInputs(
        name=str(trace["name"]),
        rate_hz=_real(trace["rate_hz"]),
        emg=decode(trace["emg"], (n, 4)),
        emg_unit=str(trace["emg_unit"]),
        emg_reference=_reference(trace.get("emg_reference")),
        torque=decode(trace["torque"], (n,)),
        missing_emg=tuple(map(str, trace["missing_emg"])),
        steps=tuple(map(str, trace["steps"])),
        prepared=bool(trace["prepared"]),
        weight=None if trace["weight"] is None else decode(trace["weight"], (n,)),
        emphasised=bool(trace.get("emphasised", False)),
        fixed={str(name): _real(value) for name, value in trace["fixed"].items()},
        files=tuple(SourceFile(str(f["path"]), str(f["sha256"])) for f in trace["files"]),
        **{name: decode(trace[name], (n,)) for name in _SERIES},
    )


def _result(data: Mapping[str, Any]) -> FitResult:
    table = data["parameters"]
    spec = with_drives(get_model(data["model"]), table)
    options = ModelOptions.of(**data["options"])
    free = tuple(name for name in spec.names if table[name]["free"])
    values = {name: _real(table[name]["value"]) for name in spec.names}
    traces = data["traces"]
    starts = data["starts"]
    if not traces or not starts["all"] or not free:
        raise ValueError("no recording, start or free parameter")
    for name in spec.names:
        check_value(spec.parameters[spec.names.index(name)], values[name], spec)
    limits = np.array([[table[n]["lower"], table[n]["upper"]] for n in free], dtype=float)
    if not np.isfinite(limits).all():
        raise ValueError("a bound is not a number")
    problem = FitProblem(
        spec=spec,
        options=options,
        inputs=tuple(_inputs(trace) for trace in traces),
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
        priors={
            str(name): Prior(_real(prior["median"]), _real(prior["spread"]))
            for name, prior in data["priors"].items()
        },
    )
    residuals = tuple(decode(trace["residual"], (int(trace["n"]),)) for trace in traces)
    sse = _sum(data["sse"])
    weights = [1.0 if one.weight is None else one.weight for one in problem.inputs]
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
                {str(name): _real(value) for name, value in start["initial"].items()},
                {str(name): _real(value) for name, value in start["values"].items()},
                _sum(start["sse"]),
                str(start["outcome"]),
                int(start["iterations"]),
            )
            for start in starts["all"]
        ),
        agreeing=int(starts["agreeing"]),
        seed=int(data["seed"]),
        seconds=_real(data["seconds"]),
        versions={str(name): str(version) for name, version in data["versions"].items()},
        outliers=read_outliers(data.get("outliers"), [one.n for one in problem.inputs]),
    )


def _sum(value: float | None) -> float:
    return math.inf if value is None else _real(value)


def _real(value: object) -> float:
    """A finite number; text, true and false are none."""
    if isinstance(value, bool) or not isinstance(value, int | float) or not math.isfinite(value):
        raise ValueError(f"{value!r:.40} is not a finite number")
    return float(value)
