"""A study: factors whose values are crossed, read from a TOML file and checked beforehand."""

import itertools
import math
from collections.abc import Iterator, Mapping
from dataclasses import dataclass, fields
from typing import Any

from surae.base.errors import InputError
from surae.base.files import PathLike, read_bytes, shown
from surae.base.names import AUTO, CHIRP_RATE
from surae.base.records import parse_toml
from surae.base.setting import Setting, checked
from surae.model import ModelOptions
from surae.model.registry import OWN
from surae.protocol import PROFILES, TASKS, Protocol, chirp_rate
from surae.studies.populations import POPULATIONS

#: More than this is a slip of the keyboard: it would take months.
MOST_FITS = 1_000_000
#: A settings file is small; a larger one is some other file.
_MOST_BYTES = 1_000_000

#: Models of surae whose parameters a virtual subject has: it is their truth.
SIMULATED_MODELS = tuple(
    name for name, spec in OWN.items() if set(POPULATIONS["healthy"]) <= set(spec.names)
)

Value = str | float | int


@dataclass(frozen=True, slots=True)
class Study:
    """A study as its file asks for it."""

    name: str  #: What it is called.
    #: The values of every factor, in the order of the table: `subject` and `repeat` are numbered
    #: from 1. Model options are there only where the file gives them.
    factors: Mapping[str, tuple[Value, ...]]
    text: str  #: The file.

    @property
    def size(self) -> int:
        """Number of combinations."""
        return math.prod(len(values) for values in self.factors.values())

    def combinations(self) -> Iterator[dict[str, Value]]:
        """Every combination of the factors' values, the last factor changing fastest."""
        for values in itertools.product(*self.factors.values()):
            yield dict(zip(self.factors, values, strict=True))


#: The factors in the order of the table, each with what it may be and its values by default; a
#: factor changes faster than those before it.
FACTORS: dict[str, tuple[Setting, tuple[Value, ...]]] = {
    "protocol": (Setting(meaning="Of `PROFILES`.", choices=tuple(PROFILES)), ()),
    "chirp_amplitude": (Setting(meaning="Of the added chirp [rad].", least=0.0), (0.0,)),
    "chirp_rate": (Setting(meaning="Rise of its frequency [Hz/s].", least=0.0), (CHIRP_RATE,)),
    "task": (Setting(meaning="Of `TASKS`.", choices=tuple(TASKS)), ("part-passive",)),
    "population": (Setting(meaning="Of the subjects.", choices=tuple(POPULATIONS)), ("healthy",)),
    "subjects": (Setting(meaning="How many.", least=1, most=999_999), (1,)),
    "noise": (Setting(meaning="A part of each signal's mean magnitude.", least=0.0), (0.05,)),
    "repeats": (Setting(meaning="Realisations of the noise.", least=1, most=999_999), (1,)),
    "rate_hz": (Setting(meaning="Sampling rate [Hz].", above=0.0), (125.0,)),
    "seed": (Setting(meaning="Of the study.", least=0, most=999_999_999), (1,)),
    "starts": (Setting(meaning="Of each fit.", least=1, most=10_000), (2,)),
    "model": (Setting(meaning="What simulates.", choices=SIMULATED_MODELS), ("muscle",)),
}
#: What a protocol has of its own where the file gives it; left out, they are no columns.
OWN_MOTION: dict[str, Setting] = {
    "duration": Setting(meaning="Of the trial [s].", above=0.0, most=600.0),
    "passive_seconds": Setting(meaning="Relaxed at first [s].", least=0.0, most=600.0),
}
#: The model that is fitted, where it is another than the one that simulates; no column else.
FITTED = {"fitted": Setting(meaning="What is fitted.", choices=(*SIMULATED_MODELS, AUTO))}
#: Factors that are there only where the file gives them.
GIVEN = {**OWN_MOTION, **FITTED}
#: Model options may be factors too; left out, they are no columns either.
OPTIONS = tuple(field.name for field in fields(ModelOptions))
#: What may stand in a factor's place, and in its column: the thesis's A·sin(s·t²) has the rate s/π.
INSTEAD = {"chirp_rate": "chirp_factor"}
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
    settings = parse_toml(text)
    known = ("name", *FACTORS, *INSTEAD.values(), *GIVEN, *OPTIONS)
    for key in settings:
        if key not in known:
            raise InputError(f"unknown setting {key!r}; known settings: {', '.join(known)}")
    name = settings.get("name", "study")
    if not isinstance(name, str) or not name.strip() or not name.isprintable():
        raise InputError(f"name is {name!r}; give a text of one line")
    factors: dict[str, tuple[Value, ...]] = {}
    for factor in (*FACTORS, *GIVEN, *OPTIONS):
        record, default = FACTORS.get(factor, (GIVEN.get(factor), ()))
        other = INSTEAD.get(factor, "")
        if other in settings and factor in settings:
            raise InputError(f"{factor} and {other} say the same; give one of them")
        key = other if other in settings else factor
        if key in settings:
            factors[_COUNTED.get(key, key)] = _values(key, settings[key], record)
        elif default:
            factors[_COUNTED.get(key, key)] = default
        elif factor in FACTORS:
            raise InputError(f'{key} is missing; e.g. {key} = "multiple-holds"')
    study = Study(name, factors, text)
    if study.size > MOST_FITS:
        raise InputError(f"{study.size:,} fits are too many; at most {MOST_FITS:,} in one study")
    _check_motions(study)
    return study


def _values(key: str, setting: object, record: Setting | None) -> tuple[Value, ...]:
    """The values of a factor, each checked, none twice."""
    if not isinstance(setting, list):
        value = _checked(key, setting, record)
        return tuple(range(1, int(value) + 1)) if key in _COUNTED else (value,)
    values = tuple(_checked(key, element, record) for element in setting)
    if not values:
        raise InputError(f"{key} is an empty list; give at least one value")
    for value in values:
        if values.count(value) > 1:
            raise InputError(f"{key} has {value!r} twice; give it once")
    return values


def _checked(key: str, value: Any, record: Setting | None) -> Value:
    """A value that a factor, or where it has no record a model option, may have."""
    if record is None:
        whole = isinstance(value, int) and not isinstance(value, bool)
        given = (float(value) if abs(value) < 1e9 else math.inf) if whole else value
        option: Value = getattr(ModelOptions.of(**{key: given}), key)
        return option
    if record.choices:
        if not isinstance(value, str) or value not in record.choices:
            raise InputError(f"{key} is {value!r}; use one of: {', '.join(record.choices)}")
        return value
    try:
        number: float = checked(key, value, record, whole=isinstance(record.least, int))
    except OverflowError:
        raise InputError(f"{key} is a number of too many digits; give a smaller one") from None
    return number + 0  # no minus zero


def motion(combination: Mapping[str, Any]) -> Protocol:
    """The protocol of one combination; errors as of `Protocol`."""
    amplitude = combination["chirp_amplitude"]
    return Protocol(
        profile=combination["protocol"],
        task=combination["task"],
        chirp_amplitude=amplitude,
        chirp_rate=rise(combination) if amplitude > 0.0 else CHIRP_RATE,
        rate_hz=combination["rate_hz"],
        duration=combination.get("duration"),
        passive_seconds=combination.get("passive_seconds"),
    )


def rise(combination: Mapping[str, Any]) -> float:
    """Rise of the chirp's frequency [Hz/s], by its rate or by the thesis's factor."""
    if "chirp_factor" in combination:
        return chirp_rate(combination["chirp_factor"])
    return float(combination["chirp_rate"])


def _check_motions(study: Study) -> None:
    """Refuse a combination whose protocol is impossible, naming it."""
    rate = "chirp_rate" if "chirp_rate" in study.factors else "chirp_factor"
    motions = [name for name in OWN_MOTION if name in study.factors]
    names = ("protocol", "chirp_amplitude", rate, "task", "rate_hz", *motions)
    for values in itertools.product(*(study.factors[name] for name in names)):
        try:
            motion(dict(zip(names, values, strict=True)))
        except InputError as error:
            raise InputError(f"protocol {values[0]}: {error}") from None
