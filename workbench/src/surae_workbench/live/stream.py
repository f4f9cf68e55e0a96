"""A stream that is recorded: what it says of itself, and how it does."""

import math
from dataclasses import dataclass, field
from typing import Any

import numpy as np

from surae.base.units import FloatArray

#: LSL's names of the formats of numbers, by the number that LSL gives them; 3 are words.
_FORMATS = {1: "float32", 2: "float64", 3: "text", 4: "int32", 5: "int16", 6: "int8", 7: "int64"}
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

    @classmethod
    def of(cls, number: int, info: Any) -> "Stream":
        """A stream as LSL describes it."""
        count = info.channel_count()
        labels, units = info.get_channel_labels() or [], info.get_channel_units() or []
        rate = float(info.nominal_srate())
        kind = info.channel_format()
        return cls(
            number=number,
            name=info.name(),
            kind=info.type(),
            host=info.hostname(),
            labels=[
                (labels[i] if i < len(labels) else None) or f"channel {i + 1}" for i in range(count)
            ],
            units=[(units[i] if i < len(units) else None) or "" for i in range(count)],
            rate_hz=rate if math.isfinite(rate) and rate > 0 else 0.0,
            words=_FORMATS.get(kind) == "text",
            xml=info.as_xml(),
            format=kind,
        )

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
        return [f"{self.name}: {label}" for label in self.labels]

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
            "name": self.name, "kind": self.kind, "channels": self.labels, "units": self.units,
            "rate_hz": self.rate_hz, "measured_hz": rate, "state": self.state,
            "received": self.received, "gaps": self.gaps, "losses": self.losses,
            "lost_s": self.lost_s, "not_finite": self.not_finite, "bad_stamps": self.bad_stamps,
            "remark": self.remark, "offset_ms": None if self.offset_s is None
            else 1e3 * self.offset_s,
            "age_s": None if self.last_s is None else max(now - self.last_s, 0.0),
        }  # fmt: skip
