"""What an inspection finds: channels, the roles they seem to have, what is left to say."""

from collections.abc import Mapping
from dataclasses import dataclass
from typing import Any, Literal

from surae.recording.emg_kind import Look
from surae.recording.roles import Guess, Side
from surae.records import to_plain


@dataclass(frozen=True, slots=True)
class InspectedChannel:
    """One channel of a data file.

    Attributes
    ----------
    file : str
        Path of its file as given.
    column : str
        Its name there.
    unit : str or None
        The unit that the file states, in its own spelling.
    known_unit : str or None
        That unit as a mapping writes it for the guessed role; None where it is unknown.
    n : int or None
        Number of samples; None where the channel cannot be read.
    rate_hz : float or None
        Sampling rate [Hz]; None where time steps differ.
    start_s, end_s : float or None
        Times of the first and last sample [s].
    low, high : float or None
        Least and greatest finite value, in the file's unit.
    guess : Guess or None
        What it seems to be.
    look : Look or None
        What its samples look like as an EMG.
    remark : str
        What to know of it; why it cannot be used.
    usable : bool
        Whether a mapping can name it.
    """

    file: str
    column: str
    unit: str | None = None
    known_unit: str | None = None
    n: int | None = None
    rate_hz: float | None = None
    start_s: float | None = None
    end_s: float | None = None
    low: float | None = None
    high: float | None = None
    guess: Guess | None = None
    look: Look | None = None
    remark: str = ""
    usable: bool = True


@dataclass(frozen=True, slots=True)
class Inspection:
    """What data files hold; `surae.recording.mapping_text` writes it as a mapping.

    Attributes
    ----------
    channels : tuple of InspectedChannel
        Every channel, file by file.
    formats : mapping of str to str
        Format by file.
    roles : mapping of str to InspectedChannel
        The one channel that each role was found for.
    open : mapping of str to tuple of InspectedChannel
        Roles of which several channels, or only a vague one, could be it: the user decides.
    missing : tuple of str
        Roles of angle, torque and EMG of which there is no channel.
    side : {"left", "right"} or None
        The leg, and `side_rule`: how it is known.
    side_rule : str
        Empty where there is no side.
    emg : {"raw", "envelope"} or None
        What the EMG seems to be, None where it is unclear, and `emg_rule`: why.
    emg_rule : str
        Empty where there is no EMG.
    direction : str
        How the torque goes with the angle, where it does.
    advice : tuple of str
        What to do, one line each.
    """

    channels: tuple[InspectedChannel, ...]
    formats: Mapping[str, str]
    roles: Mapping[str, InspectedChannel]
    open: Mapping[str, tuple[InspectedChannel, ...]]
    missing: tuple[str, ...]
    side: Side | None = None
    side_rule: str = ""
    emg: Literal["raw", "envelope"] | None = None
    emg_rule: str = ""
    direction: str = ""
    advice: tuple[str, ...] = ()

    def to_json(self) -> dict[str, Any]:
        """Give all of it as plain data."""
        plain: dict[str, Any] = to_plain(self)
        return plain
