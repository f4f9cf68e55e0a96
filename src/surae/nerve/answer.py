"""The answer of `surae.impedance`: every recording, and what they say of the leg together."""

from collections.abc import Sequence
from dataclasses import dataclass
from math import inf, radians

import numpy as np

from surae.base.formatting import NO_NUMBER, of_interval, percentage
from surae.base.frozen import FrozenDict
from surae.base.records import Saved
from surae.base.tables import Tabular, TextTable
from surae.base.words import N_, Message
from surae.nerve.judged import Number
from surae.nerve.measures import MEASURES, NerveMeasure, number_of
from surae.nerve.perturbed_records import Perturbed, ReflexPath


@dataclass(frozen=True, slots=True, repr=False)
class Impedance(Tabular, Saved):
    """What small random perturbations say of one leg's ankle."""

    recordings: tuple[Perturbed, ...]  #: In the order in which they were given.
    reflex: ReflexPath  #: Of all recordings together.
    #: Of the only recording, or means over several, their differences in the intervals.
    measures: FrozenDict[str, NerveMeasure]

    def as_table(self) -> TextTable:
        """The table, as texts.

        Returns
        -------
        TextTable
            A row for each measure of each recording, the verdict on the reflex above them.
        """
        rows = []
        several = len(self.recordings) > 1
        for recording in self.recordings:
            name = recording.path.replace("\\", "/").rsplit("/", 1)[-1]
            rows += [
                (*((name,) if several else ()), *row) for row in measure_rows(recording.measures)
            ]
        if several:
            rows += [("all, mean", *row) for row in measure_rows(self.measures)]
        above = [f"Reflex: {self.reflex.verdict}: {self.reflex.reason}."]
        below = []
        for r in self.recordings:
            name = f"{r.path.rsplit('/', 1)[-1]}: " if several else ""
            held, alone, other = map(
                percentage, (r.vaf_held_out, r.vaf_held_out_intrinsic, r.vaf_held_out_other)
            )
            below.append(
                f"{name}{held} % of the second half’s torque is predicted by the first ({alone} % "
                f"without a reflex, {other} % with one the other way round); {r.seconds:.3g} s; "
                f"stiffness {'changes' if r.stationarity.verdict == 'changes' else 'is steady'}."
            )
            if (each := in_degrees(r.measures)) is not None:
                low, value, high = (f"{of:.3g}" for of in each)
                below.append(
                    f"{name}stiffness {value} Nm/deg ({low} to {high}), as measures have it."
                )
            below += [f"{name}{note}" for note in r.notes]
        heads = ("measure", "value", "95 % interval", "unit", "verdict", "note")
        return TextTable(
            (*(("recording",) if several else ()), *heads),
            tuple(rows),
            tuple(above),
            tuple(below),
            ("value", "95 % interval"),
        )


def joined(recordings: Sequence[Perturbed]) -> Impedance:
    """Everything that recordings of one leg say."""
    one = recordings[0]
    if len(recordings) == 1:
        return Impedance((one,), one.reflex, one.measures)
    measures = {name: _mean(name, [r.measures[name] for r in recordings]) for name in MEASURES}
    reflex = _together([r.reflex for r in recordings])
    return Impedance(tuple(recordings), reflex, FrozenDict(measures))


def in_degrees(measures: FrozenDict[str, NerveMeasure]) -> tuple[float, float, float] | None:
    """Lower end, value and upper end of the stiffness in the unit of a fit's measures [Nm/deg]."""
    m = measures["intrinsic_stiffness"]
    if m.value is None:
        return None
    return radians(m.ci95[0]), radians(m.value), radians(m.ci95[1])


def measure_rows(measures: FrozenDict[str, NerveMeasure]) -> list[tuple[str, ...]]:
    """Cells of a table: name, value, interval, unit, verdict, note."""
    rows: list[tuple[str, ...]] = []
    for name, m in measures.items():
        value = NO_NUMBER
        interval = f"{m.ci95[0]:.3g} to {m.ci95[1]:.3g}" if m.ci95[1] < inf else NO_NUMBER
        if m.value is not None:
            text = of_interval(m.value, m.ci95)
            value = text.value
            interval = text.interval
        rows.append((name, value, interval, m.unit, m.verdict, m.note))
    return rows


def _mean(name: str, measures: Sequence[NerveMeasure]) -> NerveMeasure:
    """Mean of recordings that have a value, what they differ by in its interval."""
    known = [m for m in measures if m.value is not None]
    if not known:
        ends = [m.ci95 for m in measures]
        return number_of(
            name, None, measures[0].note, (min(e[0] for e in ends), max(e[1] for e in ends))
        )
    values = np.array([m.value for m in known], dtype=np.float64)
    halves = np.array([np.ptp(m.ci95) / 2.0 for m in known])
    value = float(values.mean())
    low = min(value - float(np.sqrt(np.sum(halves**2))) / len(known), float(values.min()))
    high = max(value + float(np.sqrt(np.sum(halves**2))) / len(known), float(values.max()))
    note = known[0].note or (
        Message(N_("of {n} of {all} recordings"), n=str(len(known)), all=str(len(measures)))
        if len(known) < len(measures)
        else ""
    )
    return number_of(name, Number(value, low, high), note)


def _together(each: Sequence[ReflexPath]) -> ReflexPath:
    """One verdict on several recordings: present in one is present, if no other contradicts."""
    present = [reflex for reflex in each if reflex.verdict == "present"]
    ways = {reflex.direction for reflex in present}
    if len(ways) > 1:
        return ReflexPath(
            "cannot tell", None, Message(N_("recordings show reflexes to opposite directions"))
        )
    if present:
        some = Message(
            N_("in {n} of {all} recordings: {reason}"),
            n=str(len(present)),
            all=str(len(each)),
            reason=present[0].reason,
        )
        return ReflexPath("present", present[0].direction, some)
    none = all(reflex.verdict == "none seen" for reflex in each)
    worst = next((r for r in each if r.verdict == "cannot tell"), each[0])
    return (
        ReflexPath(
            "none seen", None, Message(N_("in all recordings: {reason}"), reason=worst.reason)
        )
        if none
        else worst
    )
