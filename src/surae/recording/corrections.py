"""Signs, scales, zeros and electrodes put right in a recording that was read, as its user says."""

import re
from collections.abc import Mapping, Sequence
from dataclasses import dataclass, field, replace

import numpy as np

from surae.base.errors import InputError
from surae.base.formatting import listed
from surae.base.frozen import FrozenDict, freeze
from surae.base.units import FACTORS, SI, kind
from surae.recording.recording import MUSCLES, ROLES, Channel, Recording

_WORDS = {"sign": "1 or -1", "scale": "a factor that is not 0", "offset": "a number"}
#: A unit in a channel's source, as `Scaling.describe` writes it.
_UNIT = re.compile(r"\[([^][]+)\]")


@dataclass(frozen=True, slots=True)
class Corrections:
    """What is to be put right in recordings, by role: ``sign * (scale * value + offset)``.

    It acts on what the file, or its mapping, gives; an offset is in the unit that the file has.

    Raises
    ------
    InputError
        A role or muscle is unknown, or a number means nothing.
    """

    sign: Mapping[str, float] = field(default_factory=FrozenDict)
    scale: Mapping[str, float] = field(default_factory=FrozenDict)
    offset: Mapping[str, float] = field(default_factory=FrozenDict)
    swap: Sequence[Sequence[str]] = ()  #: Pairs of muscles whose electrodes were exchanged.

    def __post_init__(self) -> None:
        """Refuse what no recording has."""
        for name, words in _WORDS.items():
            for role, value in getattr(self, name).items():
                if role not in ROLES:
                    raise InputError(f"{name} of {role!r}: no such signal; use: {listed(ROLES)}")
                wrong = not np.isfinite(value) or (name == "scale" and value == 0.0)
                if wrong or (name == "sign" and abs(value) != 1.0):
                    raise InputError(f"{name} of {role} is {value:g}; give {words}")
        pairs = [self.swap] if self.swap and isinstance(self.swap[0], str) else self.swap
        for pair in pairs:
            if isinstance(pair, str) or len(pair) != 2 or not set(pair) <= set(MUSCLES):
                raise InputError(f"swap: {pair!r}: give two of: {', '.join(MUSCLES)}")
        object.__setattr__(self, "swap", tuple(map(tuple, pairs)))

    def __call__(self, recording: Recording) -> Recording:
        """The recording put right; what was done stands in the sources of its channels."""
        channels = dict(recording.channels)
        for pair in self.swap:
            first, second = (f"emg_{muscle}" for muscle in pair)
            for role in (first, second):
                if role not in channels:
                    raise InputError(f"{recording.where}: swap: there is no {role}")
            channels |= {
                role: replace(other, role=role, source=f"{other.source}, swapped")
                for role, other in ((first, channels[second]), (second, channels[first]))
            }
        for role in {**self.sign, **self.scale, **self.offset}:
            if role not in channels:
                raise InputError(f"{recording.where}: there is no {role} to put right")
            channels[role] = self._corrected(channels[role])
        return replace(recording, channels=channels)

    def _corrected(self, channel: Channel) -> Channel:
        role = channel.role
        sign, scale, offset = (getattr(self, name).get(role) for name in _WORDS)
        zero = (offset or 0.0) * FACTORS[kind(role)][stated_unit(channel)]
        values = (sign or 1.0) * ((scale or 1.0) * channel.values + zero)
        done = ", ".join(
            f"{name} {value:g}"
            for name, value in zip(_WORDS, (sign, scale, offset), strict=True)
            if value is not None
        )
        return replace(
            channel, values=freeze(values), source=f"{channel.source}, put right: {done}"
        )


def stated_unit(channel: Channel) -> str:
    """The unit that a channel has in its file."""
    known = FACTORS[kind(channel.role)]
    units = [unit for unit in _UNIT.findall(channel.source) if unit in known]
    return units[-1] if units else SI[kind(channel.role)]
