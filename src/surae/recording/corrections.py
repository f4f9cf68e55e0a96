"""Signs, scales, zeros and electrodes put right in a recording that was read, as its user says."""

import re
from collections.abc import Mapping, Sequence
from dataclasses import dataclass, field, replace
from typing import Any, Self, TypedDict, Unpack

import numpy as np

from surae.base.errors import InputError
from surae.base.formatting import listed
from surae.base.frozen import FrozenDict, freeze
from surae.base.units import FACTORS, SI, kind
from surae.base.words import Message
from surae.recording.recording import MUSCLES, ROLES, Channel, Recording

_WORDS = {
    "wrap": "a period, as 360",
    "scale": "a factor that is not 0",
    "offset": "a number",
    "sign": "1 or -1",
}
#: What a channel's source says before what was put right.
_PUT_RIGHT = ", put right: "
#: A unit in a channel's source, as `Scaling.describe` writes it.
_UNIT = re.compile(r"\[([^][]+)\]")


class CorrectionKeywords(TypedDict, total=False):
    """What may be put right, by keyword; None is not given."""

    sign: Mapping[str, float] | None
    scale: Mapping[str, float] | None
    offset: Mapping[str, float] | None
    swap: Sequence[Sequence[str]] | None
    wrap: Mapping[str, float] | None


@dataclass(frozen=True, slots=True)
class Corrections:
    """What is to be put right in recordings, by role: ``sign * (scale * value + offset)``.

    It acts on what the file, or its mapping, gives; offset and wrap are in the unit of the file.

    Raises
    ------
    InputError
        A role or muscle is unknown, or a number means nothing.
    """

    sign: Mapping[str, float] = field(default_factory=FrozenDict)
    scale: Mapping[str, float] = field(default_factory=FrozenDict)
    offset: Mapping[str, float] = field(default_factory=FrozenDict)
    swap: Sequence[Sequence[str]] = ()  #: Pairs of muscles whose electrodes were exchanged.
    #: Periods of signals that jump by one at the end of their range; the jumps are taken out first.
    wrap: Mapping[str, float] = field(default_factory=FrozenDict)

    @classmethod
    def of(cls, **given: Unpack[CorrectionKeywords]) -> Self:
        """From keywords, of which None is not given."""
        there: dict[str, Any] = {name: each for name, each in given.items() if each is not None}
        return cls(**there)

    def __post_init__(self) -> None:
        """Refuse what no recording has."""
        for name, words in _WORDS.items():
            for role, value in getattr(self, name).items():
                if role not in ROLES:
                    raise InputError(f"{name} of {role!r}: no such signal; use: {listed(ROLES)}")
                wrong = not np.isfinite(value) or (name == "scale" and value == 0.0)
                wrong |= name == "wrap" and value <= 0.0
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
        for role in {role: None for name in _WORDS for role in getattr(self, name)}:
            if role not in channels:
                raise InputError(f"{recording.where}: there is no {role} to put right")
            channels[role] = self._corrected(channels[role])
        return replace(recording, channels=channels)

    def _corrected(self, channel: Channel) -> Channel:
        given = {name: getattr(self, name).get(channel.role) for name in _WORDS}
        wrap, scale, offset, sign = given.values()
        factor = FACTORS[kind(channel.role)][stated_unit(channel)]
        values = channel.values if wrap is None else np.unwrap(channel.values, period=wrap * factor)
        values = (sign or 1.0) * ((scale or 1.0) * values + (offset or 0.0) * factor)
        done = _together(_described(channel.source)[1], given)
        words = ", ".join(f"{name} {v:.6g}" for name, v in done.items() if v is not None)
        source = channel.source.partition(_PUT_RIGHT)[0] + _PUT_RIGHT + words
        return replace(channel, values=freeze(values), source=source)

    def lines(self, recording: Recording) -> Message:
        """How to write it: as lines of the recording's TOML, and as options of a command."""
        lines = []
        options = []
        for role in {role: None for name in _WORDS for role in getattr(self, name)}:
            given = {name: getattr(self, name).get(role) for name in _WORDS}
            described, before = _described(recording.channels[role].source)
            toml = _together(described, _together(before, given))
            lines.append(
                " and ".join(f"{n} = {v:.6g}" for n, v in toml.items() if v is not None)
                + f" for the {role}"
            )
            options += [
                f"--{name} {role}={value:.6g}"
                for name, value in _together(before, given).items()
                if value is not None
            ]
        for pair in self.swap:
            lines.append('swap = ["{}", "{}"]'.format(*pair))
            options.append("--swap {}:{}".format(*pair))
        return Message("advice/write", lines=", ".join(lines), options=" ".join(options))


_Given = Mapping[str, float | None]


def _described(source: str) -> tuple[_Given, _Given]:
    """What a channel's source says that a mapping and an earlier correction have done."""
    mapped, _, before = source.partition(_PUT_RIGHT)
    numbers = {name: re.search(rf"\b{name} ([-+.\de]+)", mapped) for name in ("scale", "offset")}
    given: dict[str, float | None] = {n: float(m[1]) for n, m in numbers.items() if m}
    if "sign reversed" in mapped:
        given["sign"] = -1.0
    words = (part.split() for part in before.split(", ") if part)
    return given, {name: float(value) for name, value in words}


def _together(first: _Given, then: _Given) -> dict[str, float | None]:
    """Two corrections, one after the other, as one."""
    both = {name: [each.get(name) for each in (first, then)] for name in _WORDS}
    known = {name: any(value is not None for value in pair) for name, pair in both.items()}
    (c1, c2), (o1, o2), (s1, s2) = (
        [neutral if value is None else value for value in both[name]]
        for name, neutral in (("scale", 1.0), ("offset", 0.0), ("sign", 1.0))
    )
    made = {"scale": c1 * c2, "offset": c2 * o1 + s1 * o2, "sign": s1 * s2}
    wrap = both["wrap"][1] if both["wrap"][1] is not None else both["wrap"][0]
    return {"wrap": wrap} | {name: made[name] if known[name] else None for name in made}


def stated_unit(channel: Channel) -> str:
    """The unit that a channel has in its file."""
    known = FACTORS[kind(channel.role)]
    units = [unit for unit in _UNIT.findall(channel.source) if unit in known]
    return units[-1] if units else SI[kind(channel.role)]
