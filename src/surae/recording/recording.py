"""A recording as measured: channels with their own time axes, in SI units, never changed."""

from collections.abc import Mapping
from dataclasses import dataclass, field
from types import MappingProxyType
from typing import Any, Literal

import numpy as np

from surae.units import FloatArray

#: Muscles in the order of the equations: tibialis anterior, gastrocnemius lateralis, soleus,
#: gastrocnemius medialis (model equations 12 and 13).
MUSCLES = ("ta", "gl", "sol", "gm")

#: Every role a channel can have, in the order in which they are listed.
ROLES = (
    "angle",
    "torque",
    *(f"emg_{muscle}" for muscle in MUSCLES),
    "angular_velocity",
    "angular_acceleration",
)


def read_only(values: Any) -> FloatArray:
    """A float64 copy of `values` that cannot be written to."""
    array = np.array(values, dtype=np.float64)
    array.setflags(write=False)
    return array


@dataclass(frozen=True, slots=True)
class SourceFile:
    """A file that a recording was read from: its path as given and its SHA-256."""

    path: str
    sha256: str


@dataclass(frozen=True, slots=True)
class Channel:
    """One measured signal.

    Attributes
    ----------
    role : str
        One of `ROLES`.
    time : ndarray, shape (n,)
        Increasing times of the samples [s].
    values : ndarray, shape (n,)
        The signal in `unit`, sign applied: angle dorsiflexion positive, torque positive when the
        triceps pulls.
    unit : str
        SI unit (`surae.units.SI`), or ``"1"`` for a normalised EMG envelope.
    source : str
        Where it came from and what was applied, e.g. ``"ik.sto: ankle_angle_r [deg]"``.
    """

    role: str
    time: FloatArray
    values: FloatArray
    unit: str
    source: str

    @property
    def rate_hz(self) -> float:
        """Mean sampling rate [Hz]."""
        return float((len(self.time) - 1) / (self.time[-1] - self.time[0]))


@dataclass(frozen=True, slots=True)
class Recording:
    """One trial of one leg.

    Attributes
    ----------
    name : str
        Name shown in tables and figures.
    channels : mapping of str to Channel
        By role, in the order of `ROLES`; angle is always there.
    emg : {"raw", "envelope"}
        Whether the EMG channels are raw (the EMG chain applies) or already envelopes.
    fixed : mapping of str to float
        Parameter values that this recording prescribes, e.g. ``{"m": 0.0}``.
    prepare : mapping
        Settings of the preparation that the recording's description overrides.
    files : tuple of SourceFile
        What it was read from; empty for a simulated recording.
    """

    name: str
    channels: Mapping[str, Channel]
    emg: Literal["raw", "envelope"] = "raw"
    fixed: Mapping[str, float] = field(default_factory=dict)
    prepare: Mapping[str, Any] = field(default_factory=dict)
    files: tuple[SourceFile, ...] = ()

    def __post_init__(self) -> None:
        """Order the channels and make the mappings read-only."""
        ordered = {role: self.channels[role] for role in ROLES if role in self.channels}
        object.__setattr__(self, "channels", MappingProxyType(ordered))
        object.__setattr__(self, "fixed", MappingProxyType(dict(self.fixed)))
        object.__setattr__(self, "prepare", MappingProxyType(dict(self.prepare)))
