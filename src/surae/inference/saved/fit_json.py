"""FIT.json: a fit as a file, readable by people and programs, loaded again without loss.

What people read comes first: what the fit is worth. Then come the fields of the result, and what it
saw of each recording.
"""

import math
from collections.abc import Mapping, Sequence
from dataclasses import dataclass, field, fields
from typing import Any

import numpy as np

from surae._version import __version__
from surae.base.cleaning import cleaned
from surae.base.errors import InputError
from surae.base.file_form import filed
from surae.base.files import PathLike, shown, write_json
from surae.base.frozen import FrozenDict
from surae.base.packed import bound_arrays, encode
from surae.base.records import FORMAT, check_format, from_plain, read_json, to_plain
from surae.base.units import FloatArray
from surae.inference import LOSSES, FitProblem, FitResult, LeastSquares, PosteriorMode, Start
from surae.inference.judging.assessed import AssessedFit
from surae.inference.judging.assessment import assess
from surae.inference.result import Outliers, Stage
from surae.inference.saved.checksums import check_checksums, checksums
from surae.inference.saved.verdicts import as_judged
from surae.model import ModelOptions, check_value, get_model, with_optional
from surae.model.source_table import SOURCES
from surae.quality.finding import Quality
from surae.recording.reading import is_recording
from surae.settings import FitSettings
from surae.signals import ModelInputs

#: Letters of what is said of a damaged file.
_REASON = 300


def save_fit(path: PathLike, fit: AssessedFit) -> None:
    """Write a fit to `path`, all of it or nothing."""
    write_json(path, as_dict(fit))


def as_dict(fit: AssessedFit) -> dict[str, Any]:
    """A fit as plain data, in the shape of FIT.json."""
    result = fit.result
    judged = to_plain(fit.assessment)
    problem = result.problem
    found = to_plain(result)
    for recording, white in zip(judged["recordings"], judged.pop("whiteness"), strict=True):
        recording["residual"] = white
    how = result.solution
    data: dict[str, Any] = {
        "surae": result.versions.get("surae", __version__),
        "format": FORMAT,
        "model": problem.spec.name,
        "options": to_plain(problem.options),
        "status": result.status,
        "message": result.message,
        **judged,
        "findings": to_plain(fit.quality),
        "starts": {"n": len(how.starts), "agreeing": how.agreeing, "all": to_plain(how.starts)},
        "search": {
            "outcome": how.outcome,
            "evaluations": how.evaluations,
            "stages": to_plain(how.stages),
        },
        **found,
        "outliers": to_plain(how.outliers),
        "family": to_plain(result.posterior),
        **to_plain(problem),
        "traces": [
            {**to_plain(recording), "residual": encode(residual)}
            for recording, residual in zip(problem.inputs, result.residuals, strict=True)
        ],
    }
    return {**data, **checksums(data)}


@dataclass(frozen=True, slots=True)
class _Parameter:
    value: float
    free: bool
    lower: float
    upper: float


@dataclass(frozen=True, slots=True)
class _Starts:
    agreeing: int
    all: tuple[Start, ...]


@dataclass(frozen=True, slots=True)
class _Search:
    outcome: str
    stages: tuple[Stage, ...] = ()


@dataclass(frozen=True, slots=True)
class _Left:
    residual: FloatArray
    n: int | None = None  #: Number of samples.


@filed(inputs="traces", left="traces")
@dataclass(frozen=True, slots=True)
class _File:
    """What is read of the file beside the fields of result and problem."""

    model: str
    options: ModelOptions
    parameters: Mapping[str, _Parameter]
    starts: _Starts
    inputs: tuple[ModelInputs, ...]
    left: tuple[_Left, ...]
    settings: FitSettings
    nuisances: Mapping[str, _Parameter] = field(default_factory=FrozenDict)
    findings: tuple[Quality, ...] = ()
    search: _Search | None = None  #: Older files have none.


def load_saved(path: PathLike) -> AssessedFit:
    """Read the fit that `save_fit` wrote; equal to the one saved, to the last bit."""
    try:
        data = read_json(path)
    except InputError:
        if not is_recording(path):
            raise
        raise InputError(
            f"{shown(path)}: this is a recording; fit it first, `surae fit {shown(path)} --output "
            "FIT.json`, and give FIT.json"
        ) from None
    check_format(data, path)
    try:
        bound_arrays(data)
        file = from_plain(_File, data)
        result = _result(file, data)
        check_checksums(data)
        now = assess(result, alternatives=True, quality=file.findings)
        return AssessedFit(result, as_judged(now, data), file.findings)
    except (ArithmeticError, np.linalg.LinAlgError):
        raise InputError(f"{shown(path)}: a number in it is beyond any leg; fit again") from None
    except InputError as error:
        why = cleaned(str(error), _REASON)
        raise InputError(f"{shown(path)}: {why}; fit again where this is damaged") from None


def _result(file: _File, data: Mapping[str, Any]) -> FitResult:
    table = {**file.parameters, **file.nuisances}
    starts = file.starts.all
    spec = with_optional(get_model(file.model), table)
    ModelOptions.of(**data["options"])  # what this surae does not know is another model
    if missing := [name for name in spec.names if name not in table]:
        raise InputError(f"parameters.{missing[0]}: it is missing")
    for i, (recording, left) in enumerate(zip(file.inputs, file.left, strict=True)):
        if left.n not in (None, recording.n):
            raise InputError(f"traces[{i}].n: {left.n}, but its time has {recording.n} samples")
    free = tuple(name for name in spec.names if table[name].free)
    values = {name: table[name].value for name in spec.names}
    if not file.inputs or not starts or not free:
        raise InputError("no recording, start or free parameter")
    for parameter in spec.parameters:
        check_value(parameter, values[parameter.name], spec)
    problem = {
        "spec": spec,
        "inputs": file.inputs,
        "free": free,
        "lower": np.array([table[name].lower for name in free]),
        "upper": np.array([table[name].upper for name in free]),
        "settings": file.settings,
    }
    if "base" not in data:  # older files have it as the first start
        initial = starts[0].initial
        if not set(free) <= set(initial):
            raise InputError("starts.all[0].initial: a free parameter is missing")
        problem["base"] = np.array([initial[n] if n in free else values[n] for n in spec.names])
    parts = {
        "problem": from_plain(FitProblem, {**data, **problem}),
        "values": values,
        "residuals": tuple(left.residual for left in file.left),
        "solution": _solution(file, data),
    }
    result = from_plain(FitResult, {**data, **parts})
    _check(result)
    return result


def _solution(file: _File, data: Any) -> LeastSquares | PosteriorMode:
    """How the fit was found; older files say less of it, or have it within the family."""
    starts = file.starts.all
    family = data.get("family")
    ended = starts[-1] if starts[-1].outcome == "interrupted" else min(starts, key=lambda s: s.sse)
    search = file.search or _Search(ended.outcome)
    of_kind = {
        "starts": starts,
        "agreeing": file.starts.agreeing,
        "stages": search.stages,
        "outcome": search.outcome,
    }
    if family is None:
        return from_plain(LeastSquares, {**of_kind, "outliers": data.get("outliers")})
    known = _family(family)
    return from_plain(PosteriorMode, {**of_kind, **known} if isinstance(known, dict) else known)


def _family(data: Any) -> Any:
    """A family's own fields, as files of 0.2.0 had them: zeros alone, a population of no means."""
    if not isinstance(data, dict):
        return data
    if "each" not in data:
        zeros = data.get("zeros")
        data = {**data, "each": {"torque_zero": zeros} if zeros else {}}
    if not all(isinstance(prior, dict) for prior in data.get("population", {}).values()):
        data = {**data, "population": {}}
    return data


def _check(result: FitResult) -> None:
    """Refuse arrays that do not go with each other, and numbers that no fit gives."""
    problem = result.problem
    posterior = result.posterior
    outliers = result.solution.outliers
    p = len(problem.free)
    inputs = problem.inputs
    shapes: list[tuple[str, FloatArray, tuple[int, ...]]] = [("R", result.R, (p, p))]
    shapes.append(("base", problem.base, (len(problem.spec.names),)))
    for i, (recording, residual) in enumerate(zip(inputs, result.residuals, strict=True)):
        n = recording.n
        arrays = [(f.name, getattr(recording, f.name)) for f in fields(recording)]
        arrays += [("residual", residual), *(("second", array) for array in recording.second)]
        shapes += [
            (f"traces[{i}].{name}", array, (n, 4) if name == "emg" else (n,))
            for name, array in arrays
            if isinstance(array, np.ndarray)
        ]
        if recording.torque is None:
            raise InputError(f"traces[{i}].torque: it is missing")
        reference = recording.emg_reference
        if reference is not None and not all(v is None or v > 0 for v in reference.values):
            raise InputError(f"traces[{i}].emg_reference.values_V: one is not above zero")
    if posterior is not None:
        if any(len(values) != len(inputs) for values in posterior.each.values()):
            raise InputError("family.each: it has not one value for each recording")
        if other := [source for source in posterior.spread if source not in SOURCES]:
            raise InputError(
                f"family.spread.{other[0]}: no source of "
                "uncertainty is called so; install what brings it, or fit again"
            )
        shapes += [(f"family.spread.{s}", by, (len(by), p)) for s, by in posterior.spread.items()]
    if outliers is not None:
        _check_outliers(outliers, len(inputs))
        pairs = enumerate(zip(outliers.weights, inputs, strict=True))
        shapes += [(f"outliers.weights[{i}]", w, (each.n,)) for i, (w, each) in pairs]
    _check_shapes(shapes)
    if not (np.isfinite(problem.lower).all() and np.isfinite(problem.upper).all()):
        raise InputError("parameters: a bound is not a number")
    with np.errstate(over="ignore", invalid="ignore"):
        pairs_of = zip(inputs, result.residuals, strict=True)
        weighted = sum(float(np.sum(of_recording.weights * e**2)) for of_recording, e in pairs_of)
    if math.isfinite(result.sse) and not math.isclose(result.sse, weighted, rel_tol=1e-6):
        raise InputError("sse: the sum of squares is not that of the residuals")


def _check_outliers(outliers: Outliers, recordings: int) -> None:
    """Refuse weights of outliers that no fit gives."""
    scales = (outliers.tuning, outliers.scale, outliers.widening)
    between = all(w.size and w.min() > 0 and w.max() <= 1 for w in outliers.weights)
    if outliers.loss not in LOSSES or min(scales) <= 0 or not between:
        raise InputError("outliers: an unknown loss, or a number that is impossible")
    if len(outliers.weights) != recordings:
        raise InputError("outliers.weights: not one for each recording")


def _check_shapes(shapes: Sequence[tuple[str, FloatArray, tuple[int, ...]]]) -> None:
    """Refuse arrays that have not the shape they should, and signals that are not numbers."""
    for where, array, shape in shapes:
        if array.shape != shape:
            raise InputError(f"{where}: an array is {list(array.shape)}, expected {list(shape)}")
        if where.endswith(("].time", "].angle", "].torque")) and not np.isfinite(array).all():
            raise InputError(f"{where}: not all of it are numbers")
