"""What was found in data files, as a table and as plain data."""

from collections.abc import Mapping
from dataclasses import dataclass
from typing import Literal

from surae.base.files import shown
from surae.base.formatting import listed
from surae.base.frozen import FrozenDict
from surae.base.records import Plain
from surae.base.tables import Tabular, TextTable
from surae.recording.emg_kind import Look
from surae.recording.recording import MUSCLES
from surae.recording.roles import Guess, Side
from surae.recording.table import Clock, some
from surae.recording.trials import TrialsInFile


@dataclass(frozen=True, slots=True)
class InspectedChannel:
    """One channel of a data file."""

    file: str  #: Path of its file as given.
    column: str  #: Its name there.
    unit: str | None = None  #: The unit that the file states, in its own spelling.
    #: That unit as a mapping writes it for the guessed role; None where it is unknown.
    known_unit: str | None = None
    scale: float = 1.0  #: What its numbers are multiplied by to be in `known_unit`.
    n: int | None = None  #: Number of samples; None where the channel cannot be read.
    rate_hz: float | None = None  #: Sampling rate [Hz]; None where time steps differ.
    #: `start_s`, `end_s`: times of the first and last sample [s].
    start_s: float | None = None
    end_s: float | None = None
    #: `low`, `high`: least and greatest finite value, in the file's unit.
    low: float | None = None
    high: float | None = None
    guess: Guess | None = None  #: What it seems to be.
    look: Look | None = None  #: What its samples look like as an EMG.
    remark: str = ""  #: What to know of it; why it cannot be used.
    usable: bool = True  #: Whether a mapping can name it as it is.
    #: Longest gap [s] that a straight line would have to fill for it to be usable; 0 where
    #: that would not do.
    bridge_s: float = 0.0
    alive: bool = True  #: False where its samples never change, as of an input with no sensor.


@dataclass(frozen=True, slots=True, repr=False)
class Inspection(Tabular, Plain):
    """What data files hold; `surae.recording.mapping_text` writes it as a mapping."""

    channels: tuple[InspectedChannel, ...]  #: Every channel, file by file.
    formats: Mapping[str, str]  #: Format by file.
    roles: Mapping[str, InspectedChannel]  #: The one channel of each role that was found.
    #: Roles that several channels, only a vague one, or one that is there but unusable could be:
    #: the user decides, and a mapping is not read before.
    open: Mapping[str, tuple[InspectedChannel, ...]]
    missing: tuple[str, ...]  #: Roles of angle, torque and EMG of which there is no channel.
    side: Side | None = None  #: The leg.
    side_rule: str = ""  #: How it is known; empty where there is no side.
    #: What the EMG seems to be; None where it is unclear.
    emg: Literal["raw", "envelope"] | None = None
    emg_rule: str = ""  #: Why; empty where there is no EMG.
    direction: str = ""  #: How the torque goes with the angle, where it does.
    advice: tuple[str, ...] = ()  #: What to do, one line each.
    #: The columns that are offered as times where no name says them, by file.
    clocks: Mapping[str, Clock] = FrozenDict()
    #: The trials that a file holds, where they are several, by file; channels are of the first.
    trials: Mapping[str, TrialsInFile] = FrozenDict()

    @property
    def unusable(self) -> Mapping[str, str]:
        """Why what is there cannot be used, by role: none of its channels can as they are."""
        return {
            role: f"{some([several[0].column])}: {several[0].remark}"
            for role, several in self.open.items()
            if not any(channel.usable for channel in several)
        }

    @property
    def faults(self) -> tuple[str, ...]:
        """What is there but unusable and why, in a line for each reason, with what helps."""
        alike: dict[str, list[str]] = {}
        for role in self.unusable:
            alike.setdefault(self.open[role][0].remark, []).append(role)
        lines = []
        for reason, roles in alike.items():
            bridge = max(channel.bridge_s for role in roles for channel in self.open[role])
            how = f", or give it bridge_s = {bridge:g} in its mapping" if bridge else ""
            who = f"{listed(roles)} are there, but unusable: {reason}"
            if len(roles) == 1:
                who = f"{roles[0]} is there, but unusable: {self.unusable[roles[0]]}"
            lines.append(f"{who}; correct the file{how}")
        return tuple(lines)

    @property
    def remarks(self) -> tuple[str, ...]:
        """What reading the channels has shown, a line for what several have alike."""
        alike: dict[str, list[str]] = {}
        for channel in self.channels:
            for remark in filter(None, channel.remark.split("; ")):
                alike.setdefault(remark, []).append(channel.column)
        return tuple(f"{some(names, 3)}: {remark}" for remark, names in alike.items())

    def as_table(self) -> TextTable:
        """The channels as a table, then what was found and what is left to say.

        Returns
        -------
        TextTable
            A row for each channel; with a file of its own where there are several.
        """
        heads: tuple[str, ...] = (
            "channel",
            "unit",
            "Hz",
            "samples",
            "start [s]",
            "least",
            "greatest",
            "role",
        )
        rows: list[tuple[str, ...]] = [
            (
                c.column,
                c.unit or "–",
                _number(c.rate_hz, 6),
                "–" if c.n is None else str(c.n),
                _number(c.start_s, 4),
                _number(c.low, 4),
                _number(c.high, 4),
                self._role(c),
            )
            for c in self.channels
        ]
        if len(self.formats) > 1:
            heads = ("file", *heads)
            rows = [(shown(c.file), *r) for c, r in zip(self.channels, rows, strict=True)]
        below = [
            f"{role} = {channel.column} ({guess.confidence}: {guess.rule})"
            for role, channel in self.roles.items()
            if (guess := channel.guess) is not None
        ]
        below += [f"time = {c.column} in {c.unit} ({c.rule})" for c in self.clocks.values()]
        below += [f"side = {self.side} ({self.side_rule})"] if self.side else []
        below += [f"EMG = {self.emg} ({self.emg_rule})"] if self.emg else []
        below += [f"- {line}" for line in (*self.remarks, *self.advice)]
        return TextTable(
            heads,
            tuple(rows),
            tuple(f"{shown(path)}: {form}" for path, form in self.formats.items()),
            tuple(below),
            heads[-6:-1],
        )

    def _role(self, channel: InspectedChannel) -> str:
        """The role that a channel has, or with a question mark could have."""
        role = next((role for role, chosen in self.roles.items() if chosen is channel), None)
        left = [role for role, several in self.open.items() if any(c is channel for c in several)]
        if role is None and len(left) == len(MUSCLES) and all(r.startswith("emg_") for r in left):
            return "emg_?"
        return role or " or ".join(f"{each}?" for each in left) or "–"


def _number(value: float | None, digits: int) -> str:
    return "–" if value is None else f"{value:.{digits}g}"
