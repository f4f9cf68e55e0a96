"""What a TOML mapping may say, one field each: its reader and its documentation are made of them.

`surae.recording.mapping` reads it.
"""

from collections.abc import Mapping
from dataclasses import dataclass
from typing import Literal

import tomli_w

from surae.base.errors import InputError
from surae.base.file_form import filed
from surae.base.files import shown
from surae.base.frozen import FrozenDict
from surae.base.packed import brief
from surae.base.setting import setting
from surae.base.units import clock_seconds, clock_units
from surae.recording.recording import MUSCLES, ROLES, weight_of

#: Longest gap that a straight line may fill [s]: what passes the filter of an envelope (2.7 Hz)
#: unseen, and is no part of a movement.
LONGEST_BRIDGE_S = 0.05
#: What stands for the trial's name in the name of a file.
TRIAL = "{trial}"
#: Of a trial in a file: every one, each a recording of its own.
EACH = "*"
#: More a clock is not wrong by [millionths]: it is another rate.
MOST_PPM = 100_000.0
#: Kinds of trials that show the device alone, and how electrodes hear other muscles.
EMPTY = "empty device"
ALONE = "one muscle at a time"
EFFORTS = ("passive", "active", "isometric", "maximal", EMPTY, ALONE)
#: A setting that whoever uses it knows by its name.
Setting = str | bool | int | float | tuple[str | bool | int | float, ...]


@filed(strict=True)
@dataclass(frozen=True, slots=True, kw_only=True)
class MappedTime:
    """A column of times and the unit that it is in."""

    column: str = setting("", "Its name in the file.")
    unit: str | None = setting(
        None, "s, ms, us, ns, min, h, d (days) or 100ns, where the file does not state it."
    )

    def __post_init__(self) -> None:
        """Refuse what is no column, or no unit of time."""
        if not self.column:
            raise InputError("time: column is missing")
        if self.unit is not None and clock_seconds(self.unit) is None:
            known = ", ".join(clock_units())
            raise InputError(f"time: unit {self.unit!r} is not known; use one of: {known}")


@filed(strict=True)
@dataclass(frozen=True, slots=True, kw_only=True)
class MappedTrial:
    """What tells apart the trials in one file; `value` or `index` choose one of them."""

    column: str | None = setting(None, "A column that says of each sample which trial it is of.")
    sheet: str | None = setting(
        None, "The sheet of a workbook that holds the trial; `*` for one in each."
    )
    group: str | None = setting(
        None, "The group, structure or block that holds it; `*` for one in each."
    )
    value: str | float | None = setting(None, "What the column says of the trial.")
    index: Literal["*"] | int | None = setting(
        None, "Or which of them it is, counted from 1; `*` for each, where times fall back."
    )

    def __post_init__(self) -> None:
        """Refuse what names nothing, or two things."""
        named = [n for n in ("column", "sheet", "group") if getattr(self, n) is not None]
        if len(named) > 1:
            raise InputError(f"trial: {' and '.join(named)} both say where the trials are")
        if not named and self.index is None:
            raise InputError("trial: name a column, a sheet, a group, or an index from 1 on")
        if self.value is not None and self.column is None:
            raise InputError("trial: value is that of a column; name the column")
        if isinstance(self.index, int) and self.index < 1:
            raise InputError(f"trial: index is {self.index}; trials are counted from 1")

    @property
    def inside(self) -> str | None:
        """The sheet or group that holds the trial; None where rows do."""
        return self.sheet if self.group is None else self.group

    @property
    def several(self) -> bool:
        """Whether no single trial is chosen."""
        if self.inside is not None:
            return self.inside == EACH
        return self.index == EACH or (self.value is None and self.index is None)


@filed(strict=True)
@dataclass(frozen=True, slots=True, kw_only=True)
class MappedChannel:
    """A channel: ``sign * (scale * raw + offset)`` in its unit, which is then brought to SI."""

    file: str | None = setting(
        None,
        "Its file, as seen from the mapping; in a mapping of many trials with `{trial}` in "
        "it, or left out where each trial is one file.",
    )
    column: str = setting("", "Its name in that file.")
    unit: str | None = setting(None, "Its unit, where the file does not state it.")
    sign: Literal[1, -1] = setting(1, "-1 where the file counts the other direction as positive.")
    scale: float = setting(1.0, "What the file's numbers are multiplied by first.")
    offset: float = setting(0.0, "What is added then, before the sign.")
    wrap: float | None = setting(
        None,
        "A period of which it jumps at the end of its range, as 360, in its unit; the jumps "
        "are taken out first.",
    )
    zero: str | tuple[float, float] | None = setting(
        None,
        "Instead of an offset: a file in which it is zero, or `[start, end]` of such a "
        "stretch in s.",
    )
    time: str | MappedTime | None = setting(
        None, "The column with its times, where it has a clock of its own; as at the top."
    )
    start_s: float | None = setting(None, "Or the time of its first sample.")
    rate_hz: float | None = setting(None, "And its samples a second.")
    clock_ppm: float = setting(
        0.0,
        "How fast its clock is, in millionths: 2000 where it counts 1.002 s in a second, "
        "negative where it is slow. True times are stamps / (1 + ppm / 10⁶).",
    )
    bridge_s: float = setting(
        0.0, "Longest gap [s] of samples that cannot be read which a straight line may fill."
    )

    def __post_init__(self) -> None:
        """Refuse what contradicts itself."""
        if self.file == "":
            raise InputError("file is empty; name it, or leave it out")
        if self.scale == 0.0:
            raise InputError("scale is 0, which would erase the signal")
        if self.wrap is not None and self.wrap <= 0.0:
            raise InputError(f"wrap is {self.wrap:g}; give a period, as 360")
        if self.zero is not None and self.offset:
            raise InputError("zero and offset both say where the zero is; give one")
        if self.zero == "":
            raise InputError('zero is empty; name a quiet trial, as "Pas_0.mat"')
        if isinstance(self.zero, tuple) and self.zero[1] <= self.zero[0]:
            start, end = self.zero
            raise InputError(f"zero: {start:g} to {end:g} s is no stretch of time")
        if not 0.0 <= self.bridge_s <= LONGEST_BRIDGE_S:
            raise InputError(
                f"bridge_s is {self.bridge_s:g}; a straight line may fill {LONGEST_BRIDGE_S:g} s "
                "at most"
            )
        if self.rate_hz is not None and self.rate_hz <= 0.0:
            raise InputError(f"rate_hz is {self.rate_hz:g}; it must be above 0")
        if self.time is not None and (self.start_s, self.rate_hz) != (None, None):
            raise InputError("time and start_s or rate_hz both say when; give one")
        if not abs(self.clock_ppm) <= MOST_PPM:
            raise InputError(
                f"clock_ppm is {self.clock_ppm:g}; a clock is wrong by {MOST_PPM:g} at most, else "
                "its rate is: give rate_hz"
            )


@dataclass(frozen=True, slots=True, kw_only=True)
class TrialDescription:
    """What a mapping says of a trial beside its signals; None where it says nothing."""

    side: Literal["left", "right"] | None = setting(None, "The leg.")
    date: str | None = setting(None, "Of the session.")
    condition: str | None = setting(None, "What was done to the leg, or where, in a few words.")
    notes: str | None = setting(None, "Anything else.")
    effort: (
        Literal["passive", "active", "isometric", "maximal", "empty device", "one muscle at a time"]
        | None
    ) = setting(None, "What the subject did, where the data are not to decide it.")
    use: bool = setting(True, "False leaves the trial out.")


@filed(strict=True)
@dataclass(frozen=True, slots=True, kw_only=True)
class MappedRecording(TrialDescription):
    """All that a mapping says of one recording, or of every trial of a session."""

    name: str | None = setting(None, "What the recording or session is called.")
    emg: Literal["raw", "envelope"] = setting("raw", "Whether EMG is as measured or smoothed.")
    fixed: Mapping[str, float] = setting(
        FrozenDict, "Parameters that are known, with their values."
    )
    device: Mapping[str, Setting] = setting(FrozenDict, "Of the robot.")
    prepare: Mapping[str, Setting] = setting(FrozenDict, "Settings of `surae.Preparation`.")
    swap: tuple[str, ...] | tuple[tuple[str, str], ...] = setting(
        (), 'Two muscles whose electrodes were exchanged, as `["ta", "sol"]`, or several pairs.'
    )
    open: tuple[str, ...] = setting(
        (),
        "Signals that the files hold but that are not settled: nothing is read before each is "
        "a channel, left out by its weight in `fixed`, or taken out of this list.",
    )
    time: str | MappedTime | None = setting(
        None,
        'The column with the times of all channels, as `"Czas [s]"` or `{ column = "Czas", '
        'unit = "s" }`, where the file does not say it.',
    )
    trial: MappedTrial | None = setting(
        None,
        'Where a file holds several trials: `{ column = "trial" }`, `{ sheet = "walk 2" }`, '
        '`{ group = "trial2" }`; each is a recording. One of them: with `value` or `index`.',
    )
    channels: Mapping[str, MappedChannel] = setting(
        FrozenDict, "A table for each signal: `[channels.angle]`, `[channels.torque]`, …"
    )
    trials: Mapping[str, Mapping[str, object]] = setting(
        FrozenDict, "What differs in single trials, as `b.torque.sign = -1` or `b.emg_ta = false`."
    )

    def __post_init__(self) -> None:
        """Refuse what is no signal, or no recording."""
        for role in self.channels:
            if role not in ROLES:
                raise InputError(
                    f"channels: key {brief(role)} is not known; use: {', '.join(ROLES)}"
                )
        weights = {f"emg_{muscle}": weight_of(muscle) for muscle in MUSCLES}
        settled = {*self.channels, *(r for r, weight in weights.items() if weight in self.fixed)}
        if left := [role for role in self.open if role not in settled]:
            known = f", or fix its weight ({weights[left[0]]} = 0.0)" if left[0] in weights else ""
            raise InputError(
                f"open: {', '.join(left)} {'are' if len(left) > 1 else 'is'} in the files but not "
                f"settled; complete [channels.{left[0]}]{known}, or take it out of `open`"
            )
        if not self.channels:
            raise InputError("channels.angle is missing; every recording needs the angle")


def toml_text(table: Mapping[str, object]) -> str:
    """A table as TOML.

    Raises
    ------
    InputError
        TOML cannot hold a character in it.
    """
    text = tomli_w.dumps(table)
    try:
        text.encode()
    except UnicodeEncodeError:
        raise InputError(f"{shown(text.strip())}: TOML cannot hold it; rename it") from None
    return text


def toml_value(value: object) -> str:
    """A text, number or switch as TOML says it, on one line."""
    return toml_text({"value": value}).removeprefix("value = ").rstrip("\n")
