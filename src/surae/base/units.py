"""The one table of units: every quantity that enters is converted to SI here and nowhere else.

What is written otherwise (foot-pounds, revolutions) pint reads, which is loaded only then.
"""

import math
import re
import tomllib
from dataclasses import dataclass
from functools import cache
from importlib.resources import files
from typing import Any

import numpy as np
import numpy.typing as npt

from surae.base.errors import InputError

FloatArray = npt.NDArray[np.float64]
ComplexArray = npt.NDArray[np.complex128]

#: SI unit of each kind of signal, as written in files and figures.
SI = {
    "angle": "rad",
    "torque": "Nm",
    "emg": "V",
    "angular_velocity": "rad/s",
    "angular_acceleration": "rad/s2",
    "length": "m",
    "time": "s",
}

#: Factor from a unit to the SI unit of its kind. "1" is an EMG envelope normalised by its user.
FACTORS: dict[str, dict[str, float]] = {
    "angle": {"rad": 1.0, "deg": math.pi / 180},
    "torque": {"Nm": 1.0, "mNm": 1e-3, "Nmm": 1e-3},
    "emg": {"V": 1.0, "mV": 1e-3, "uV": 1e-6, "1": 1.0},
    "angular_velocity": {"rad/s": 1.0, "deg/s": math.pi / 180},
    "angular_acceleration": {"rad/s2": 1.0, "deg/s2": math.pi / 180},
    "length": {"mm": 1e-3, "cm": 1e-2, "m": 1.0},
    "time": {"s": 1.0, "ms": 1e-3, "us": 1e-6, "ns": 1e-9, "min": 60.0, "h": 3600.0},
}

#: Units of clocks alone, which a mapping may say and no name does: days of Excel, .NET's ticks.
_OF_CLOCKS = {"d": 86400.0, "100ns": 1e-7}

_KNOWN_HERE = tomllib.loads(files("surae.base").joinpath("units.toml").read_text(encoding="utf-8"))
#: How else files spell units, in small letters, and what is a unit of a kind alone.
_SPELLINGS, _KINDS_ALONE = (
    {word: says for says, words in _KNOWN_HERE[each].items() for word in words}
    for each in ("spellings", "alone")
)
#: Units that are some of ours times a number: what files write, in small letters and without what
#: joins its parts, and the unit with that number.
_SCALED: dict[str, tuple[str, float]] = {
    word: (unit, float(scale)) for word, (unit, scale) in _KNOWN_HERE["scaled"].items()
}
#: Kind of signal by the first word of roles that have a second.
_KINDS = {
    "emg": "emg",
    "fascicle": "length",
    "pennation": "angle",
    "second": "angle",
    "commanded": "angle",
}
#: What may stand between the parts of a unit, and what makes them others.
_JOINED = re.compile(r"[\s.·⋅*×_-]")
_BETWEEN = re.compile(r"\s*[\s.·⋅*×_-]\s*")
_PER_KG = re.compile(r"(.+?)\s*(?:/\s*kg|per kg|[ .·*]?kg\s*(?:\^?-1|⁻¹))(?: ?bm| ?bw)?")
_PERCENT = re.compile(r"(?:%|percent|per cent)[\s_]*(?:of )?(?:mvi?c|max(?:imum)?)?|mvi?c ?%")
#: What pint is asked: words of systems that laboratories use, and no numbers.
_READABLE = re.compile(
    r"(?:(?:k?n|k?nc?m|k?newton|(?:ft|in)lbf?|lbf?|pound|ft|foot|feet|in|inch|inche|kgf|kg|kilogram|ozf?|"
    r"ounce|dyne?|force|[cmkd]?m|(?:centi|milli|kilo)?met(?:er|re)|[kmun]?v|(?:nano|milli|kilo)?volt"
    r"|turn|rev|revolution|mrad|milliradian|gon|arcmin|rpm|rad|deg|degree|min|minute|h|us|"
    r"microsecond|s)s?(?:[\s.·⋅*×_/-]+|$))+"
)
#: What is written as one word, and what pint calls otherwise.
_ONE_WORD = re.compile(r"^(ft|in|k?N)(lbf?|c?m)s?$", re.I)
_REVOLUTION = re.compile(r"^revs?$", re.I)
_LONGEST = 30
_PINT = {
    "newton * meter": "torque",
    "kilogram * meter": "torque",
    "volt": "emg",
    "meter": "length",
    "second": "time",
}
_KNOWN = {unit.casefold(): unit for units in FACTORS.values() for unit in units}


def plain(text: str) -> str:
    """A unit or column name with both of Unicode's micro signs written as ``u``."""
    return text.replace("\N{MICRO SIGN}", "u").replace("\N{GREEK SMALL LETTER MU}", "u")


def spelled(text: str) -> str | None:
    """Our spelling of a unit as a file spells it; None where it is none that is known here."""
    folded = plain(text.strip()).casefold()
    for each in (folded, _JOINED.sub("", folded), _JOINED.sub("", folded).removesuffix("s")):
        if (known := _KNOWN.get(_SPELLINGS.get(each, each).casefold())) is not None:
            return known
    return None


def clock_units() -> dict[str, float]:
    """Units in which clocks count, and what each is in seconds."""
    return FACTORS["time"] | _OF_CLOCKS


def clock_seconds(unit: str) -> float | None:
    """What a clock's unit is in seconds; None where it is none that is known."""
    return clock_units().get(spelled(unit) or unit.strip())


@dataclass(frozen=True, slots=True)
class Stated:
    """What a file's unit is in ours."""

    kind: str  #: A kind of signal in `FACTORS`; ``"other"`` for a unit of none of them.
    unit: str = ""  #: One of `FACTORS`; empty where the numbers aren't in any.
    scale: float = 1.0  #: What the file's numbers are multiplied by to be in it.
    per_kg: bool = False  #: Whether that is still to be multiplied by the body's mass [kg].


def stated(text: str | None) -> Stated | None:
    """What a unit, as a file spells it, says of the signal; None where it says nothing known."""
    folded = plain((text or "").strip()).casefold()
    if match := _PER_KG.fullmatch(folded):
        whole = stated(match[1])
        return None if whole is None else Stated(whole.kind, whole.unit, whole.scale, True)
    if _PERCENT.fullmatch(folded):
        return Stated("emg", "1", 0.01)
    if unit := spelled(folded):
        return Stated(next(sort for sort, units in FACTORS.items() if unit in units), unit)
    if (known := _SCALED.get(_JOINED.sub("", folded))) is not None:
        sort = next(sort for sort, units in FACTORS.items() if known[0] in units)
        return Stated(sort, *known)
    if folded in _KINDS_ALONE:
        return Stated(_KINDS_ALONE[folded])
    readable = len(folded) <= _LONGEST and _READABLE.fullmatch(folded)
    return _by_pint(plain((text or "").strip())) if readable else None


@cache
def _by_pint(text: str) -> Stated | None:
    """A unit of other systems, as pint's registry has it; a pound times a length is a torque."""
    import pint

    registry = _registry()
    text = _REVOLUTION.sub("turn", _ONE_WORD.sub(r"\1*\2", text))
    for spelling in (text, text.lower()):
        try:
            one: Any = registry.parse_expression(_BETWEEN.sub("*", spelling))
            for factor, unit in (
                (1.0, "newton * meter"),
                (9.80665, "kilogram * meter"),
                (1.0, "volt"),
                (1.0, "meter"),
                (1.0, "second"),
            ):
                if one.is_compatible_with(unit):
                    sort = _PINT[unit]
                    return Stated(sort, SI[sort], float(one.to(unit).magnitude) * factor)
            if "radian" in f"{one.to_base_units().units}":
                speed = one.is_compatible_with("radian / second")
                sort = "angular_velocity" if speed else "angle"
                return Stated(sort, SI[sort], float(one.to_base_units().magnitude))
            return Stated("other")
        except (pint.errors.PintError, AttributeError, TypeError, ValueError, ArithmeticError):
            continue  # pint raises what its parser does
    return None


@cache
def _registry() -> Any:
    import pint

    return pint.UnitRegistry()


def kind(role: str) -> str:
    """The kind of signal behind a channel's role: ``"emg"`` for ``"emg_ta"``, else the role."""
    return _KINDS.get(role.partition("_")[0], role)


def to_si(role: str, unit: str, where: str) -> float:
    """Factor from `unit` to the SI unit of `role`; the message of an error begins with `where`."""
    known = FACTORS[kind(role)]
    if unit not in known:
        allowed = ", ".join(known)
        raise InputError(f"{where}: unit {unit!r} is not known for {role}; use one of: {allowed}")
    return known[unit]


#: What a unit of files is on pages, and the factor to it: of one thing one unit, for readers.
_ON_PAGES = {
    "deg": ("°", 1.0),
    "rad": ("°", 180.0 / math.pi),
    "1/rad": ("1/°", math.pi / 180.0),
    "Nm/deg": ("Nm/°", 1.0),
    "Nm/rad": ("Nm/°", math.pi / 180.0),
    "Nm·s/deg": ("Nm·s/°", 1.0),
    "Nm·s/rad": ("Nm·s/°", math.pi / 180.0),
    "rad/s": ("°/s", 180.0 / math.pi),
    "deg/s": ("°/s", 1.0),
    "V": ("mV", 1e3),
    "Nm/V": ("Nm/mV", 1e-3),
    "-": ("", 1.0),
}


def on_page(unit: str) -> tuple[str, float]:
    """The unit in which pages show what files have in `unit`, and the factor to it."""
    return _ON_PAGES.get(unit, (unit, 1.0))
