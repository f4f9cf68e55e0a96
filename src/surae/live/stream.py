"""A stream that is recorded: what it says of itself, and how it does."""

from dataclasses import dataclass, field
from typing import Any


@dataclass(slots=True)
class Stream:
    """A stream that is recorded; one and the same through losses."""

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
    state: str = "good"  #: "good", "silent", "lost": Whether samples come.
    received: int = 0  #: Samples, in all.
    #: `gaps`, `losses`: how often stamps jumped, and how often it was gone.
    gaps: int = 0
    losses: int = 0
    lost_s: float = 0.0  #: For how long together [s].
    offset_s: float | None = None  #: What its clock is behind ours, measured last.
    last_s: float | None = None  #: Our time of its newest sample.
    inlet: Any = None
    uid: str = ""
    lost_at: float = 0.0
    clocks: list[tuple[float, float]] = field(default_factory=list)
    stamp: float | None = None
    rates: list[tuple[float, int]] = field(default_factory=list)

    @property
    def columns(self) -> list[str]:
        """Its channels as the reader of XDF calls them."""
        return [f"{self.name}: {label}" for label in self.labels]

    def health(self, now: float) -> dict[str, Any]:
        """How it does, as plain data."""
        rate = None
        if len(self.rates) > 1 and self.rates[-1][0] > self.rates[0][0]:
            rate = (self.rates[-1][1] - self.rates[0][1]) / (self.rates[-1][0] - self.rates[0][0])
        return {
            "name": self.name, "kind": self.kind, "channels": self.labels, "units": self.units,
            "rate_hz": self.rate_hz, "measured_hz": rate, "state": self.state,
            "received": self.received, "gaps": self.gaps, "losses": self.losses,
            "lost_s": self.lost_s, "offset_ms": None if self.offset_s is None
            else 1e3 * self.offset_s,
            "age_s": None if self.last_s is None else max(now - self.last_s, 0.0),
        }  # fmt: skip
