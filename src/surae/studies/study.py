"""A study: factors whose values are crossed, read from a TOML file and checked beforehand."""

import itertools
import math
import tomllib
from collections.abc import Callable, Iterator, Mapping
from dataclasses import dataclass, fields
from typing import Any

from surae.errors import InputError
from surae.files import PathLike, read_bytes, shown
from surae.model import MODELS, ModelOptions
from surae.protocol import PROFILES, TASKS, Protocol, chirp_rate
from surae.protocol.profiles import DEFAULT_RATE
from surae.studies.virtual import POPULATIONS

#: More than this is a slip of the keyboard: it would take months.
MOST_FITS = 1_000_000
#: A settings file is small; a larger one is some other file.
_MOST_BYTES = 1_000_000

#: Models whose parameters a virtual subject has: it is their truth.
SIMULATED_MODELS = tuple(
    name for name, spec in MODELS.items() if set(POPULATIONS["healthy"]) <= set(spec.names)
)

Value = str | float | int


@dataclass(frozen=True, slots=True)
class Factor:
    """What may be varied: how one value of it is read, and which it takes when none is given."""

    read: Callable[[object], Value]
    default: tuple[Value, ...]


@dataclass(frozen=True, slots=True)
class Study:
    """A study as its file asks for it.

    Attributes
    ----------
    name : str
        What it is called.
    factors : mapping of str to tuple
        The values of every factor, in the order of the table: `subject` and `repeat` are numbered
        from 1. Model options are there only where the file gives them.
    text : str
        The file.
    """

    name: str
    factors: Mapping[str, tuple[Value, ...]]
    text: str

    @property
    def size(self) -> int:
        """Number of combinations."""
        return math.prod(len(values) for values in self.factors.values())

    def combinations(self) -> Iterator[dict[str, Value]]:
        """Every combination of the factors' values, the last factor changing fastest."""
        for values in itertools.product(*self.factors.values()):
            yield dict(zip(self.factors, values, strict=True))


def _one_of(known: Mapping[str, object] | tuple[str, ...]) -> Callable[[object], Value]:
    def read(value: object) -> Value:
        if not isinstance(value, str) or value not in known:
            raise InputError(f"use one of: {', '.join(known)}")
        return value

    return read


def _real(rule: str, least: float) -> Callable[[object], Value]:
    def read(value: object) -> Value:
        if isinstance(value, bool) or not isinstance(value, int | float):
            raise InputError(f"give {rule}")
        try:
            number = float(value) + 0.0  # no minus zero
        except OverflowError:
            number = math.inf
        if not math.isfinite(number) or number < least:
            raise InputError(f"give {rule}")
        return number

    return read


def _whole(least: int, most: int) -> Callable[[object], Value]:
    def read(value: object) -> Value:
        if isinstance(value, bool) or not isinstance(value, int) or not least <= value <= most:
            raise InputError(f"give a whole number, {least} to {most}")
        return value

    return read


def _choices(name: str) -> Callable[[object], Value]:
    """One value of a model option, which knows itself what it may be."""

    def read(value: object) -> Value:
        given: Any = value
        if isinstance(value, int) and not isinstance(value, bool):
            given = float(value) if abs(value) < 1e9 else math.inf
        checked: Value = getattr(ModelOptions.of(**{name: given}), name)
        return checked

    return read


#: The factors in the order of the table; a factor changes faster than those before it.
FACTORS: dict[str, Factor] = {
    "protocol": Factor(_one_of(PROFILES), ()),
    "chirp_amplitude": Factor(_real("0 rad or more", 0.0), (0.0,)),
    "chirp_rate": Factor(_real("0 Hz/s or more", 0.0), (DEFAULT_RATE,)),
    "task": Factor(_one_of(TASKS), ("part-passive",)),
    "population": Factor(_one_of(POPULATIONS), ("healthy",)),
    "subjects": Factor(_whole(1, 999_999), (1,)),
    "noise": Factor(_real("a fraction of each signal's mean magnitude, 0 or more", 0.0), (0.05,)),
    "repeats": Factor(_whole(1, 999_999), (1,)),
    "rate_hz": Factor(_real("a rate above 0 Hz", 1e-9), (125.0,)),
    "seed": Factor(_whole(0, 999_999_999), (1,)),
    "starts": Factor(_whole(1, 10_000), (2,)),
    "model": Factor(_one_of(SIMULATED_MODELS), ("muscle",)),
}
#: Model options may be factors too; left out, they are no columns of the table.
OPTIONS: dict[str, Factor] = {
    field.name: Factor(_choices(field.name), ()) for field in fields(ModelOptions)
}
#: What may stand in a factor's place, and in its column: the thesis's A·sin(s·t²) has the rate s/π.
INSTEAD: dict[str, tuple[str, Factor]] = {
    "chirp_rate": ("chirp_factor", Factor(_real("a factor of 0 or more", 0.0), ())),
}
#: Factors given as a number and counted from 1: `subjects = 3` are subjects 1, 2 and 3.
_COUNTED = {"subjects": "subject", "repeats": "repeat"}


def read_study(path: PathLike) -> Study:
    """Read STUDY.toml.

    Raises
    ------
    InputError
        The file cannot be read, or asks for something unknown or impossible.
    """
    where = shown(path)
    try:
        text = read_bytes(path, _MOST_BYTES).decode()
    except UnicodeDecodeError:
        raise InputError(f"{where}: it is not a text file in UTF-8") from None
    try:
        return parse_study(text)
    except InputError as error:
        raise InputError(f"{where}: {error}") from None


def parse_study(text: str) -> Study:
    """The study that the text of a STUDY.toml describes.

    Raises
    ------
    InputError
        As of `read_study`.
    """
    try:
        settings = tomllib.loads(text)
    except (ValueError, RecursionError) as error:  # also of thousands of digits or brackets
        raise InputError(f"not TOML: {error}") from None
    factors_of_file = _factors(settings)
    known = ("name", *FACTORS, *(name for name, _ in INSTEAD.values()), *OPTIONS)
    for key in settings:
        if key not in known:
            raise InputError(f"unknown setting {key!r}; known settings: {', '.join(known)}")
    name = settings.get("name", "study")
    if not isinstance(name, str) or not name.strip() or not name.isprintable():
        raise InputError(f"name is {name!r}; give a text of one line")
    factors: dict[str, tuple[Value, ...]] = {}
    for key, factor in factors_of_file.items():
        if key in settings:
            factors[_COUNTED.get(key, key)] = _values(key, settings[key], factor)
        elif factor.default:
            factors[_COUNTED.get(key, key)] = factor.default
        elif key not in OPTIONS:
            raise InputError(f'{key} is missing; e.g. {key} = "multiple-holds"')
    study = Study(name, factors, text)
    if study.size > MOST_FITS:
        raise InputError(f"{study.size:,} fits are too many; at most {MOST_FITS:,} in one study")
    _check_motions(study)
    return study


def _factors(settings: Mapping[str, object]) -> dict[str, Factor]:
    """The factors that a file may give, in the order of the table."""
    factors: dict[str, Factor] = {}
    for key, factor in (FACTORS | OPTIONS).items():
        other, instead = INSTEAD.get(key, ("", factor))
        if other in settings and key in settings:
            raise InputError(f"{key} and {other} say the same; give one of them")
        factors |= {other: instead} if other in settings else {key: factor}
    return factors


def _values(key: str, setting: object, factor: Factor) -> tuple[Value, ...]:
    """The values of a factor, each checked, none twice."""
    if not isinstance(setting, list):
        value = _checked(key, setting, factor)
        if key in _COUNTED:
            return tuple(range(1, int(value) + 1))
        return (value,)
    values = tuple(_checked(key, element, factor) for element in setting)
    if not values:
        raise InputError(f"{key} is an empty list; give at least one value")
    for value in values:
        if values.count(value) > 1:
            raise InputError(f"{key} has {value!r} twice; give it once")
    return values


def _checked(key: str, value: object, factor: Factor) -> Value:
    try:
        return factor.read(value)
    except InputError as error:
        text = str(error)
        raise InputError(
            text if text.startswith("option") else f"{key} is {value!r}: {text}"
        ) from None


def motion(combination: Mapping[str, Any]) -> Protocol:
    """The protocol of one combination; errors as of `Protocol`."""
    amplitude = combination["chirp_amplitude"]
    return Protocol(
        profile=combination["protocol"],
        task=combination["task"],
        chirp_amplitude=amplitude,
        chirp_rate=rise(combination) if amplitude > 0.0 else DEFAULT_RATE,
        rate_hz=combination["rate_hz"],
    )


def rise(combination: Mapping[str, Any]) -> float:
    """Rise of the chirp's frequency [Hz/s], by its rate or by the thesis's factor."""
    if "chirp_factor" in combination:
        return chirp_rate(combination["chirp_factor"])
    return float(combination["chirp_rate"])


def _check_motions(study: Study) -> None:
    """Refuse a combination whose protocol is impossible, naming it."""
    rate = "chirp_rate" if "chirp_rate" in study.factors else "chirp_factor"
    names = ("protocol", "chirp_amplitude", rate, "task", "rate_hz")
    for values in itertools.product(*(study.factors[name] for name in names)):
        try:
            motion(dict(zip(names, values, strict=True)))
        except InputError as error:
            raise InputError(f"protocol {values[0]}: {error}") from None
