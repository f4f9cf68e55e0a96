"""A predictor as one file of C99 and its header: its numbers in a template, and a test."""

import re
from collections.abc import Sequence
from dataclasses import dataclass
from importlib.resources import files
from typing import Any, Protocol

import numpy as np

from surae._version import __version__
from surae.base.errors import InputError
from surae.base.files import PathLike, write_atomic
from surae.base.units import FloatArray
from surae.causal.layout import DOUBT, NUMBERS, STATE
from surae.causal.numbers import Numbers
from surae.inference import FitResult
from surae.model import activation, contraction, crosstalk, equilibrium, movement, parameters
from surae.model.compliant_stage import GAMMA, RHO

#: Of each precision: the ending of its functions, the solver's tolerance, and what the test
#: allows, as a part of the peak torque beside an absolute difference [Nm].
_PRECISIONS = {
    "double": ("", equilibrium.TOLERANCE, "1e-9 + 1e-11 * peak"),
    "float": ("f", 1e-4, "1e-4 * peak"),
}
_FUNCTIONS = ("EXP", "EXPM1", "LOG", "SQRT", "SIN", "COS", "ATAN2", "FABS")
#: Steps of the test program.
_STEPS = 400
_NAME = re.compile(r"[A-Za-z_][A-Za-z0-9_]*")


class Stepped(Protocol):
    """What is told of a predictor in C: how it is stepped, and what it gives of signals."""

    @property
    def rate_hz(self) -> float:
        """Samples in a second [Hz]."""

    @property
    def emg(self) -> str:
        """How EMG comes."""

    @property
    def account(self) -> str:
        """What causality costs."""

    def run(self, angle: FloatArray, emg: FloatArray) -> Any:
        """Torque and its standard deviation of each sample [Nm]."""


@dataclass(frozen=True, slots=True)
class CSource:
    """A predictor in C99."""

    name: str  #: How the files are called, without their endings.
    c: str  #: The one source file, with a test program where SURAE_TEST is defined.
    h: str  #: Its header.

    def save(self, folder: PathLike) -> tuple[str, str]:
        """Write both files to a folder; their paths are returned.

        Raises
        ------
        InputError
            A file cannot be written.
        """
        from pathlib import Path

        paths = (str(Path(folder) / f"{self.name}.c"), str(Path(folder) / f"{self.name}.h"))
        for path, text in zip(paths, (self.c, self.h), strict=True):
            write_atomic(path, text)
        return paths


def c_source(
    predictor: Stepped, numbers: Numbers, result: FitResult, name: str, precision: str
) -> CSource:
    """The C file and header of a predictor, of a name and a precision.

    Raises
    ------
    InputError
        The name is none that C allows, or the precision is another.
    """
    if not _NAME.fullmatch(name):
        raise InputError(
            f"{name!r} is no name in C; use letters, digits and underscores, no digit first"
        )
    if precision not in _PRECISIONS:
        raise InputError(f"precision is {precision!r}; use one of: {', '.join(_PRECISIONS)}")
    ending, tolerance, allowed = _PRECISIONS[precision]
    record = numbers.record[0]
    # lengths beyond the one at rest, and what an own path adds to it
    beyond = record["at_rest"] + record["has_own_path"] * record["own_path"][:, 5]
    path = numbers.path.copy()
    path[:, [4, 12]] -= record["at_rest"]
    filled = {
        "NAME": name,
        "GUARD": name.upper(),
        "REAL": precision,
        "RATE": _real(predictor.rate_hz),
        "DELAY": str(numbers.delay),
        "EMG": predictor.emg if predictor.emg == "raw" else "envelopes",
        "ABOUT": _about(predictor, result),
        "STATE": _fields(STATE, "surae_real", "long long"),
        "NUMBERS": _fields(NUMBERS, "real", "int"),
        "VALUES": ",\n".join(f"    .{f} = {_values(record[f])}" for f, _, _ in NUMBERS),
        "PATHS": str(len(numbers.path)),
        "KNOTS": str(numbers.curve.shape[1]),
        "RELAXING": str(numbers.relaxing.shape[1]),
        "DOUBT": str(DOUBT),
        "PATH": _rows(path),
        "FROM_SLACK": _values(beyond - record["groups"][:, 1]),
        "FROM_OPTIMUM": _values(beyond - record["groups"][:, 2]),
        "CURVE": _rows(np.pad(numbers.curve, ((0, 0), (0, 1)))),
        "RELAX": _rows(np.pad(numbers.relaxing, ((0, 0), (0, 1)))),
        "GRAVITY": _real(movement.GRAVITY),
        "JOINT_RESTS": _real(parameters.JOINT_RESTS),
        "CF": _real(contraction.CF),
        "MVSH": _real(contraction.MVSH),
        "MVSHL": _real(contraction.MVSHL),
        "ABOVE_ONE": _real(contraction.FECC - 1.0),
        "SILENT": _real(crosstalk.SILENT),
        "SMALLEST": _real(activation.SMALLEST_EFFORT),
        "NEAR": _real(activation.NEAR),
        "GAMMA": _real(GAMMA),
        "RHO": _real(RHO),
        "TOLERANCE": _real(tolerance),
        "NEWTON_STEPS": str(equilibrium.NEWTON_STEPS),
        "SEARCH_STEPS": str(equilibrium.SEARCH_STEPS),
        "STEPS": str(_STEPS),
        "SIGNALS": _rows(_signals(predictor, result)),
        "ALLOWED": allowed,
        **{function: function.lower() + ending for function in _FUNCTIONS},
    }
    here = files("surae.causal")
    texts = [
        _filled(here.joinpath(f"predictor.{kind}.in").read_text(encoding="utf-8"), filled)
        for kind in ("c", "h")
    ]
    return CSource(name, *texts)


def _filled(text: str, values: dict[str, str]) -> str:
    return re.sub(r"@([A-Z_0-9]+)@", lambda place: values[place.group(1)], text)


def _fields(layout: Sequence[tuple[str, str, tuple[int, ...]]], real: str, whole: str) -> str:
    """Members of a struct."""
    return "\n".join(
        f"    {real if kind == 'f8' else whole} {name}{''.join(f'[{n}]' for n in shape)};"
        for name, kind, shape in layout
    )


def _real(value: float) -> str:
    """A number that reads back without loss, as a constant of double precision."""
    text = repr(float(value))
    if text in ("inf", "-inf", "nan"):
        raise InputError(f"a number of the predictor is {text}; the fit cannot be exported")
    return text


def _values(of: Any) -> str:
    """A number or array as C initialises one."""
    values = np.asarray(of)
    if values.ndim:
        return "{" + ", ".join(map(_values, values)) + "}"
    return _real(float(values)) if values.dtype.kind == "f" else str(int(values))


def _rows(table: FloatArray) -> str:
    return ",\n".join(f"    {_values(row)}" for row in table)


def _about(predictor: Stepped, result: FitResult) -> str:
    """What a reader has to know, as lines of a comment."""
    from textwrap import wrap

    said = [
        f"Made by surae {__version__} of a fit of {result.problem.spec.name}: "
        + ", ".join(r.name for r in result.problem.inputs),
        predictor.account,
        "Made for its parameters, its rate and its geometry: of another leg it knows nothing.",
        *(f"{name} = {value:.9g}" for name, value in result.values.items()),
    ]
    lines = (line for text in said for line in wrap(text.replace("*/", "* /"), 90))
    return "\n".join(f" * {_plain(line)}" for line in lines)


def _plain(text: str) -> str:
    """ASCII alone, for compilers."""
    return text.replace("’", "'").encode("ascii", "replace").decode("ascii")


def _signals(predictor: Stepped, result: FitResult) -> FloatArray:
    """Made-up signals of the size of the fit's, with the torque and its doubt, shape (n, 7)."""
    first = result.problem.inputs[0]
    low, high = (float(np.quantile(first.angle, q)) for q in (0.05, 0.95))
    level = np.quantile(first.emg, 0.95, axis=0)
    if (reference := first.emg_reference) is not None:
        level = level * [value or 0.0 for value in reference.values]
    i = np.arange(_STEPS)
    angle = low + 0.5 * (high - low) * (1.0 - np.cos(2.0 * np.pi * i / (0.8 * _STEPS)))
    rng = np.random.default_rng(0)
    effort = np.abs(np.sin(np.pi * i[:, None] * (1.0 + np.arange(4)) / _STEPS))
    noise = rng.normal(size=(_STEPS, 4))
    emg = level * effort * (noise if predictor.emg == "raw" else np.abs(noise))
    made = predictor.run(angle, emg)
    return np.column_stack([angle, emg, made.torque, made.sd])
