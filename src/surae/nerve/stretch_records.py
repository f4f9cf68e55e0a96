"""What slow and fast stretches say of one leg: records that reports, pages and files read."""

from dataclasses import dataclass
from typing import Any, Literal

from surae.base.errors import InputError
from surae.base.formatting import NO_NUMBER
from surae.base.frozen import FrozenDict
from surae.base.records import Saved
from surae.base.tables import Tabular, TextTable
from surae.base.words import N_, Message
from surae.inference.judging.verdict import Verdict

#: Of which repeats give the smallest detectable change. Elastic, viscous and inertial torque are of
#: one fit to all stretches: what repeats of them differ by is not what they are wrong by.
COMPARED = {"peak_torque_Nm": N_("peak of torque"), "neural_Nm": N_("neural")}


@dataclass(frozen=True, slots=True)
class StretchAnswer:
    """One stretch; torque is counted in its own direction."""

    recording: str  #: Name of its file.
    start_s: float  #: Begin [s].
    direction: Literal["dorsiflexion", "plantarflexion"]  #: Of the movement.
    speed_deg_s: float  #: Median of its middle.
    from_deg: float  #: Angle at its begin.
    to_deg: float  #: Angle at its end.
    peak_torque_Nm: float  #: Largest torque over that before it.
    elastic_Nm: float  #: Rise of tissue's torque, relaxed.
    viscous_Nm: float  #: Largest, of tissue.
    inertial_Nm: float  #: Largest, of foot and device.
    neural_Nm: float | None  #: Largest beyond tissue's; None: not to be told from tissue or will.
    neural_ci95: tuple[float, float] | None  #: Its 95 % interval.
    neural_note: str  #: Whether EMG says so, or time alone.
    emg_onset_deg: FrozenDict[str, float | None]  #: Angle at which each muscle's EMG begins.
    catch_deg: float | None  #: Angle of the largest drop of power after its peak.


@dataclass(frozen=True, slots=True)
class StretchThreshold:
    """Angle at which a muscle would answer an endlessly slow stretch (Levin and Feldman 1994)."""

    angle_deg: float | None  #: None where there are too few onsets.
    ci95: tuple[float, float] | None  #: 95 % interval.
    verdict: Verdict  #: weak or undetermined, by the width of the interval.
    note: str  #: Of how many onsets.


@dataclass(frozen=True, slots=True, repr=False)
class Stretches(Tabular, Saved):
    """What slow and fast stretches say of one leg."""

    stretches: tuple[StretchAnswer, ...]  #: In the order of recordings and time.
    threshold: FrozenDict[str, StretchThreshold]  #: By muscle whose EMG is there.
    #: 1.96·√2·SD of repeats at one speed: what a difference must exceed; None without repeats.
    smallest_detectable_change: FrozenDict[str, float | None]
    notes: tuple[str, ...] = ()  #: What was left out of the recordings, a sentence each.

    def as_table(self) -> TextTable:
        """The table, as texts.

        Returns
        -------
        TextTable
            A row for each stretch, thresholds and smallest changes below.
        """
        rows = []
        for s in self.stretches:
            first = [v for v in s.emg_onset_deg.values() if v is not None]
            numbers = (s.peak_torque_Nm, s.elastic_Nm, s.viscous_Nm, s.inertial_Nm, s.neural_Nm)
            texts = [NO_NUMBER if v is None else f"{v:z.1f}" for v in numbers]
            onset_ = f"{min(first):z.0f}" if first else NO_NUMBER
            catch = NO_NUMBER if s.catch_deg is None else f"{s.catch_deg:z.0f}"
            place = f"{s.start_s:.2f}", s.direction, f"{s.speed_deg_s:.0f}"
            span = f"{s.from_deg:z.0f} to {s.to_deg:z.0f}"
            cells = (each.replace("-", "−") for each in (*place, span, *texts, onset_, catch))
            rows.append((s.recording, *cells, s.neural_note))
        return TextTable(
            (
                "recording",
                "start [s]",
                "direction",
                "speed [°/s]",
                "from, to [°]",
                "peak [Nm]",
                "elastic",
                "viscous",
                "inertial",
                "neural",
                "EMG from [°]",
                "catch [°]",
                "note",
            ),
            tuple(rows),
            below=(*map(str, self.lines()), *self.notes),
            numbers=(
                "start [s]",
                "speed [°/s]",
                "peak [Nm]",
                "elastic",
                "viscous",
                "inertial",
                "neural",
                "EMG from [°]",
                "catch [°]",
            ),
        )

    def lines(self) -> list[str]:
        """Thresholds, smallest changes and notes, as messages without a stop.

        Returns
        -------
        list of str
            One for each.
        """
        lines: list[str] = []
        for muscle, h in self.threshold.items():
            if h.angle_deg is None or h.ci95 is None:
                said = Message(
                    N_("Threshold at rest, {muscle}: none: {note}"), muscle=muscle, note=h.note
                )
            else:
                said = Message(
                    N_(
                        "Threshold at rest, {muscle}: {angle:.1f}° ({low:.1f} to {high:.1f}), "
                        "{verdict}: {note}"
                    ),
                    muscle=muscle,
                    angle=h.angle_deg,
                    low=h.ci95[0],
                    high=h.ci95[1],
                    verdict=Message(h.verdict),
                    note=h.note,
                )
            lines.append(said)
        for n, v in self.smallest_detectable_change.items():
            if v is not None:
                lines.append(
                    Message(
                        N_("Smallest detectable change, {what}: {value:.2g} Nm"),
                        what=Message(COMPARED[n]),
                        value=v,
                    )
                )
        if all(v is None for v in self.smallest_detectable_change.values()):
            lines.append(Message(N_("No stretch was repeated at one speed")))
        return lines

    def to_dataframe(self) -> Any:
        """The stretches as a pandas DataFrame.

        Returns
        -------
        pandas.DataFrame
            A row for each; EMG onsets are columns ``emg_onset_gm_deg`` and the like.

        Raises
        ------
        InputError
            The package pandas is not installed.
        """
        try:
            import pandas as pd
        except ImportError:
            raise InputError("pandas is not installed; pip install pandas") from None
        rows = []
        for plain in self.as_dict()["stretches"]:
            onsets = plain.pop("emg_onset_deg")
            rows.append(plain | {f"emg_onset_{m}_deg": angle for m, angle in onsets.items()})
        return pd.DataFrame(rows)
