"""Results of MuscleRedundancySolver, and the matrices of its fellows, in files of MATLAB."""

from collections.abc import Mapping
from typing import Any

import numpy as np

from surae.base.errors import InputError
from surae.exchange.foreign_result import ForeignValue
from surae.recording.programs.foreign import in_child
from surae.recording.programs.matlab_layouts import texts
from surae.recording.programs.matlab_variables import matlab5, matlab73
from surae.recording.source import Source

_MATLAB5 = b"MATLAB 5.0 MAT-file"
#: Its names of parameters, and the rows of a matrix of them.
_NAMES = {
    "FMo": "max_isometric_force",
    "lMo": "optimal_fiber_length",
    "lTs": "tendon_slack_length",
    "alphao": "pennation_angle",
    "kT": "tendon_stiffness",
}
_ROWS = (
    "max_isometric_force",
    "optimal_fiber_length",
    "tendon_slack_length",
    "pennation_angle",
)
_SCALED = ("lMo", "lTs", "kT")
_MOST = 2000


def read_matlab(data: bytes, where: str) -> tuple[str, str, tuple[ForeignValue, ...]]:
    """The program, the file and the values in it."""
    plain = in_child(Source(where, data, ""), "MATLAB", __name__)
    if not plain["values"]:
        raise InputError(
            f"{where}: no result of MuscleRedundancySolver: it has no Results.Param.Estimated "
            "and no MTParameters"
        )
    return "MuscleRedundancySolver", where, tuple(ForeignValue(**v) for v in plain["values"])


def parse(data: bytes, shown: str) -> dict[str, Any]:
    """Values as plain data; in a child process."""
    try:
        variables = matlab5(data) if data.startswith(_MATLAB5) else matlab73(data)
    except InputError:
        raise
    except Exception as error:  # SciPy's and h5py's readers raise anything
        raise InputError(f"{shown}: MATLAB that cannot be read: {error}") from None
    if "MTParameters" in variables:
        return {"values": list(_matrix(variables["MTParameters"]))}
    results = variables.get("Results", {})
    param = results.get("Param") if isinstance(results, Mapping) else None
    if not isinstance(param, Mapping) or not isinstance(param.get("Estimated"), Mapping):
        return {"values": []}
    names = texts(results.get("MuscleNames", []))
    misc = variables.get("Misc", {})
    if isinstance(misc, Mapping):
        names = texts(misc.get("allMuscleList", [])) or names
    return {"values": list(_values(param, list(names)))}


def _matrix(matrix: Any) -> "list[dict[str, Any]]":
    """Values of a matrix without names, a row for each parameter."""
    array = np.atleast_2d(np.asarray(matrix, dtype=np.float64))
    if array.shape[0] < len(_ROWS) or array.shape[1] > _MOST:
        return []
    return [
        {"muscle": f"muscle {place + 1}", "parameter": name, "value": float(array[row, place])}
        for place in range(array.shape[1])
        for row, name in enumerate(_ROWS)
        if np.isfinite(array[row, place])
    ]


def _values(param: Mapping[str, Any], names: list[str]) -> "list[dict[str, Any]]":
    """Estimated values with what they began from and the limits of their scales."""
    made = []
    bounds = param.get("Bound", {})
    for name, ours in _NAMES.items():
        estimated = _vector(param["Estimated"], name)
        began = _vector(param.get("Original", {}), name)
        limits = bounds.get(name, {}) if isinstance(bounds, Mapping) else {}
        low, high = (_vector(limits, end) for end in ("lb", "ub"))
        for place, value in enumerate(estimated[:_MOST].tolist()):
            generic = float(began[place]) if place < len(began) else None
            known = generic is not None and name in _SCALED and len(low) and len(high)
            fixed = known and value == generic  # what was not searched for has its own limits, 1
            made.append(
                {
                    "muscle": names[place] if place < len(names) else f"muscle {place + 1}",
                    "parameter": ours,
                    "value": value,
                    "generic": generic,
                    "low": _end(low, place, generic) if known and not fixed else None,
                    "high": _end(high, place, generic) if known and not fixed else None,
                    "free": name in _SCALED and not fixed if generic is not None else None,
                }
            )
    return made


def _end(ends: Any, place: int, generic: float | None) -> float:
    """A limit, of one for all muscles or of each."""
    return float(ends[place if len(ends) > 1 else 0]) * (generic or 0.0)


def _vector(of: Any, name: str) -> Any:
    """Numbers of a structure's field; empty where it has none."""
    value = of.get(name) if isinstance(of, Mapping) else None
    if not isinstance(value, np.ndarray) or value.dtype.kind not in "fiu":
        return np.empty(0)
    return value.astype(np.float64).ravel()
