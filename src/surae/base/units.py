"""The one table of units: every quantity that enters is converted to SI here and nowhere else."""

import math

import numpy as np
import numpy.typing as npt

from surae.base.errors import InputError

FloatArray = npt.NDArray[np.float64]

#: SI unit of each kind of signal, as written in files and figures.
SI = {
    "angle": "rad", "torque": "Nm", "emg": "V", "angular_velocity": "rad/s",
    "angular_acceleration": "rad/s2", "length": "m", "time": "s",
}  # fmt: skip

#: Factor from a unit to the SI unit of its kind. "1" is an EMG envelope normalised by its user.
FACTORS: dict[str, dict[str, float]] = {
    "angle": {"rad": 1.0, "deg": math.pi / 180},
    "torque": {"Nm": 1.0, "mNm": 1e-3, "Nmm": 1e-3},
    "emg": {"V": 1.0, "mV": 1e-3, "uV": 1e-6, "1": 1.0},
    "angular_velocity": {"rad/s": 1.0, "deg/s": math.pi / 180},
    "angular_acceleration": {"rad/s2": 1.0, "deg/s2": math.pi / 180},
    "length": {"mm": 1e-3, "cm": 1e-2, "m": 1.0},
    "time": {"s": 1.0, "ms": 1e-3},
}

#: How else files spell units, in small letters.
_SPELLINGS = {
    "°/s": "deg/s", "rad/s^2": "rad/s2", "radian": "rad", "radians": "rad",
    **dict.fromkeys(("degree", "degrees", "°"), "deg"),
    **dict.fromkeys(("°/s2", "deg/s^2", "°/s^2"), "deg/s2"),
    **dict.fromkeys(("n.m", "n·m", "n m", "n*m", "newton meter"), "Nm"),
    **dict.fromkeys(("n.mm", "n·mm", "n mm", "n*mm", "ntmm"), "Nmm"),
    "volt": "V", "volts": "V", "millivolt": "mV", "millivolts": "mV", "microvolt": "uV",
    "microvolts": "uV",
    **dict.fromkeys(("millimeter", "millimeters", "millimetre", "millimetres"), "mm"),
    **dict.fromkeys(("sec", "second", "seconds"), "s"),
    **dict.fromkeys(("msec", "millisecond", "milliseconds"), "ms"),
}  # fmt: skip
#: Kind of signal by the first word of roles that have a second.
_KINDS = {"emg": "emg", "fascicle": "length", "pennation": "angle", "second": "angle"}
_KNOWN = {unit.casefold(): unit for units in FACTORS.values() for unit in units}


def plain(text: str) -> str:
    """A unit or column name with both of Unicode's micro signs written as ``u``."""
    return text.replace("\N{MICRO SIGN}", "u").replace("\N{GREEK SMALL LETTER MU}", "u")


def spelled(text: str) -> str | None:
    """Our spelling of a unit as a file spells it; None where it is none that is known here."""
    folded = plain(text.strip()).casefold()
    return _KNOWN.get(_SPELLINGS.get(folded, folded).casefold())


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
