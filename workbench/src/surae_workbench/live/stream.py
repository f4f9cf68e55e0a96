"""A stream that is recorded: what it says of itself, and how it does."""

import math
import re
from dataclasses import dataclass, field
from typing import Any
from xml.etree import ElementTree
from xml.sax.saxutils import escape, unescape

import numpy as np

from surae.base.cleaning import cleaned
from surae.base.units import FloatArray
from surae_workbench.live.identity import Identity

#: LSL's names of the formats of numbers, by the number that LSL gives them; 3 are words.
_FORMATS = {1: "float32", 2: "float64", 3: "text", 4: "int32", 5: "int16", 6: "int8", 7: "int64"}
_LSL_FORMATS = {**_FORMATS, 2: "double64", 3: "string"}
#: Letters of a description, of a name in it, and of a text that is shown nowhere. A reader calls a
#: column by two names, in a line of 200.
_XML = 2**20
_NAME = 90
_TEXT = 4000
#: A stream of whose name nothing can be shown.
_NAMELESS = "stream"
#: An element with nothing but text, and letters by their number in it.
_ELEMENT = re.compile(r"<(\w+)>([^<>]*)</\1\s*>")
_NUMBERED = re.compile(r"&#(x[0-9a-fA-F]{1,6}|[0-9]{1,7});")
#: No clock has counted for longer than this [s]: 3,000 years.
_AGE = 1e11


@dataclass(slots=True)
class Stream:
    """A stream that is recorded; one and the same through losses, as long as its layout is."""

    number: int  #: Its number in the file.
    #: `name`, `kind`, `host`: as it says of itself.
    name: str
    kind: str
    host: str
    #: `labels`, `units`: of its channels.
    labels: list[str]
    units: list[str]
    rate_hz: float  #: As it says; 0 where it is irregular.
    words: bool  #: Whether it sends words.
    xml: str
    format: int = 0  #: Of its samples, as LSL numbers formats.
    state: str = "good"  #: "good", "silent", "lost": Whether samples come.
    received: int = 0  #: Samples, in all.
    #: `gaps`, `losses`: how often stamps jumped, and how often it was gone.
    gaps: int = 0
    losses: int = 0
    lost_s: float = 0.0  #: For how long together [s].
    #: `not_finite`, `bad_stamps`: values, and time stamps, that were no numbers.
    not_finite: int = 0
    bad_stamps: int = 0
    remark: str = ""  #: What somebody should know of it.
    offset_s: float | None = None  #: What its clock is behind ours, measured last.
    last_s: float | None = None  #: Our time of its newest sample.
    inlet: Any = None
    uid: str = ""
    lost_at: float = 0.0
    clocks: list[tuple[float, float]] = field(default_factory=list)
    stamp: float | None = None
    rates: list[tuple[float, int]] = field(default_factory=list)
    source: str = ""  #: Which program sends it, as it says; empty where it says nothing.
    #: What it is called where others have its name; empty where none has.
    told: str = ""
    key: tuple[str, ...] = ()  #: What LSL tells of it before it is asked.

    @classmethod
    def of(cls, number: int, info: Any) -> "Stream":
        """A stream as LSL describes it."""
        count = info.channel_count()
        given = info.get_channel_labels(), info.get_channel_units()
        labels, units = ([cleaned(t or "", _NAME) for t in (each or [])[:count]] for each in given)
        labels += [""] * (count - len(labels))
        rate = float(info.nominal_srate())
        kind = info.channel_format()
        stream = cls(
            number=number,
            name=cleaned(info.name(), _NAME) or _NAMELESS,
            kind=cleaned(info.type(), _NAME),
            host=cleaned(info.hostname()),
            labels=[label or f"channel {i}" for i, label in enumerate(labels, 1)],
            units=[*units, *[""] * (count - len(units))],
            rate_hz=rate if math.isfinite(rate) and rate > 0 else 0.0,
            words=_FORMATS.get(kind) == "text",
            xml="",
            format=kind,
            source=cleaned(info.source_id(), _NAME),
            key=key_of(info),
        )
        stream.xml = _cleaned_xml(info.as_xml()) or stream.described()
        return stream

    def described(self) -> str:
        """What readers need of it, as LSL's XML: for one whose own is none."""
        each = [
            f"<channel><label>{escape(label)}</label><unit>{escape(unit)}</unit></channel>"
            for label, unit in zip(self.labels, self.units, strict=True)
        ]
        kind = _LSL_FORMATS[self.format]
        return (
            f'<?xml version="1.0"?><info><name>{escape(self.name)}</name><type>{escape(self.kind)}'
            f"</type><channel_count>{len(self.labels)}</channel_count><nominal_srate>"
            f"{self.rate_hz!r}</nominal_srate><channel_format>{kind}</channel_format><desc>"
            f"<channels>{''.join(each)}</channels></desc></info>"
        )

    @property
    def identity(self) -> Identity:
        """What it is known by."""
        return Identity(self.name, self.source, self.kind, tuple(self.labels), self.host)

    @property
    def called(self) -> str:
        """What it is called everywhere."""
        return self.told or self.name

    @property
    def layout(self) -> tuple[object, ...]:
        """What every sample of it looks like: samples of two layouts are two streams."""
        return self.labels, self.units, self.rate_hz, self.format

    @property
    def layout_text(self) -> str:
        """Its layout in words, short."""
        channels = [
            f"{label} [{unit}]" if unit else label
            for label, unit in zip(self.labels[:8], self.units, strict=False)
        ]
        more = f" and {len(self.labels) - 8} more" if len(self.labels) > 8 else ""
        rate = f"{self.rate_hz:g} Hz" if self.rate_hz else "no fixed rate"
        return f"{', '.join(channels)}{more}; {rate}, {_FORMATS.get(self.format, 'unknown')}"

    @property
    def columns(self) -> list[str]:
        """Its channels as the reader of XDF calls them."""
        return [f"{self.called}: {label}" for label in self.labels]

    def mended(self, stamps: FloatArray, now: float) -> FloatArray:
        """Time stamps, those that are none replaced by what their neighbours or our time say."""
        good = np.abs(stamps) < _AGE  # NaN is not
        if good.all():
            return stamps
        self.bad_stamps += int(np.sum(~good))
        index = np.arange(len(stamps))
        after = index / self.rate_hz if self.rate_hz else np.zeros(len(stamps))
        if good.any():
            near = np.interp(index, index[good], (stamps - after)[good])
            return np.where(good, stamps, after + near)
        if self.stamp is not None and self.rate_hz:
            return self.stamp + 1.0 / self.rate_hz + after
        return now - (self.offset_s or 0.0) - after[::-1]

    def health(self, now: float) -> dict[str, Any]:
        """How it does, as plain data."""
        rate = None
        if len(self.rates) > 1 and self.rates[-1][0] > self.rates[0][0]:
            rate = (self.rates[-1][1] - self.rates[0][1]) / (self.rates[-1][0] - self.rates[0][0])
        return {
            "name": self.called,
            "kind": self.kind,
            "channels": self.labels,
            "units": self.units,
            "rate_hz": self.rate_hz,
            "measured_hz": rate,
            "state": self.state,
            "received": self.received,
            "gaps": self.gaps,
            "losses": self.losses,
            "lost_s": self.lost_s,
            "not_finite": self.not_finite,
            "bad_stamps": self.bad_stamps,
            "remark": self.remark,
            "offset_ms": None if self.offset_s is None else 1e3 * self.offset_s,
            "age_s": None if self.last_s is None else max(now - self.last_s, 0.0),
        }


def key_of(info: Any) -> tuple[str, ...]:
    """What LSL tells of a stream before it is asked: name, source, type and computer."""
    return info.name(), info.source_id(), info.type(), info.hostname()


def _cleaned_xml(text: str) -> str:
    """A stream's own description, its texts cleaned; empty where that is no XML of ours."""
    if len(text) > _XML or "<!" in text:
        return ""

    def clean(match: re.Match[str]) -> str:
        name, said = match.groups()
        plain = _NUMBERED.sub(_letter, unescape(said, {"&quot;": '"', "&apos;": "'"}))
        kept = cleaned(plain, _NAME if name in ("name", "type", "label", "unit") else _TEXT)
        kept = kept or (_NAMELESS if name == "name" and said else "")
        return f"<{name}>{escape(kept)}</{name}>"

    made = _ELEMENT.sub(clean, text)
    try:
        ElementTree.fromstring(made)
    except (ElementTree.ParseError, ValueError, RecursionError):
        return ""
    return made


def _letter(match: re.Match[str]) -> str:
    digits = match[1]
    number = int(digits[1:], 16) if digits[0] == "x" else int(digits)
    return chr(number) if number < 0x110000 else "?"
