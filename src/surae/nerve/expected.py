"""What perturbations and stretches will tell, before anybody is measured: made, then estimated."""

from collections.abc import Mapping
from dataclasses import dataclass
from typing import Any

import numpy as np

from surae.base.errors import InputError
from surae.base.files import PathLike, shown
from surae.base.formatting import NO_NUMBER, of_interval
from surae.base.progress import Progress
from surae.base.records import Saved, read_json, to_plain
from surae.base.tables import Tabular, TextTable
from surae.inference.judging.verdict import Verdict
from surae.nerve.impedance import perturbed
from surae.nerve.judged import Number
from surae.nerve.made import USUAL, perturbed_leg, stretched_leg
from surae.nerve.measures import NerveMeasure, number_of
from surae.nerve.ramps import MOVING, RANGE
from surae.nerve.samples import runs
from surae.nerve.stretch_records import StretchAnswer
from surae.nerve.stretches import ALIKE, answers
from surae.protocol.protocol import Trajectory

#: Shares of reflexes that are looked for: of the torque's variance in perturbations, of the peak
#: of torque in the fastest stretches [%]; and how many recordings of each are made.
SHARES = (2.0, 5.0, 10.0)
OF_PEAK = (5.0, 10.0, 20.0)
DRAWS = 2
#: Stretches of one speed, and of another, that make a series.
REPEATED = 2
#: A sensor's noise [Nm] where none is given.
SENSOR = 0.02
#: What of a leg is told: the reflex's numbers are of the share in the middle.
_INTRINSIC = ("intrinsic_stiffness", "intrinsic_viscosity", "inertia")
_REFLEX = ("reflex_gain", "reflex_delay")


@dataclass(frozen=True, slots=True)
class ExpectedReflex:
    """Whether a reflex would be seen."""

    share: float  #: Its size [%]: of the torque's variance, or of the peak of torque.
    seen: int  #: Recordings, or fastest stretches, that show it.
    of: int  #: Of so many that were made.
    without_emg: int | None = None  #: The same without EMG, of stretches.


@dataclass(frozen=True, slots=True, repr=False)
class NerveExpectation(Tabular, Saved):
    """What perturbations, or slow and fast stretches, will tell of tissue and reflex."""

    protocol: str  #: Its name.
    seconds: float  #: Duration [s].
    leg: str  #: Whose: a usual one, or the file of one that was measured.
    noise: float  #: Standard deviation of the torque's noise [Nm], sample by sample.
    measures: Mapping[str, NerveMeasure]  #: True values and the intervals to expect.
    reflexes: tuple[ExpectedReflex, ...]  #: By their size.
    notes: tuple[str, ...]  #: What to know, a sentence each.

    def to_json(self) -> dict[str, Any]:
        """Give what E.json holds, as plain data."""
        return dict(to_plain(self))

    def as_table(self) -> TextTable:
        """The table, as texts.

        Returns
        -------
        TextTable
            A row for each measure; whether reflexes would be seen below.
        """
        rows = []
        for name, m in self.measures.items():
            assert m.value is not None
            text = of_interval(m.value, m.ci95)
            interval = text.interval if m.verdict != "undetermined" else NO_NUMBER
            rows.append((name, text.value, interval, m.unit, m.verdict, m.note))
        below = []
        for each in self.reflexes:
            silent = each.without_emg
            alone = "" if silent is None else f"; without EMG in {silent}"
            below.append(
                f"A reflex of {each.share:g} % would be seen in {each.seen} of {each.of}{alone}."
            )
        noise = f"noise {self.noise:.2g} Nm"
        return TextTable(
            ("measure", "if it is", "95 % interval to expect", "unit", "verdict", "note"),
            tuple(rows),
            (f"{self.protocol}: {self.seconds:.0f} s, {self.leg}, {noise}",),
            (*below, *self.notes),
            ("if it is", "95 % interval to expect"),
        )


def expects(
    trajectory: Trajectory,
    fit: PathLike | None = None,
    noise: float | None = None,
    progress: Progress | None = None,
) -> NerveExpectation:
    """What a perturbation or a series of stretches will tell.

    Recordings of made legs are estimated as measured ones are; every interval is that of their
    estimate, about the true value. What the equations do not describe is not in them.

    Parameters
    ----------
    trajectory : Trajectory
        What the device will do.
    fit : path, optional
        What `surae impedance` saved: of this leg, else of a usual one.
    noise : float, optional
        Standard deviation of the torque sensor's noise, sample by sample [Nm].
    progress : callable, optional
        Called with how many recordings are estimated, and of how many.

    Raises
    ------
    InputError
        The file is none of `surae impedance`; or one is given for stretches.
    """
    level = SENSOR if noise is None else noise
    name = trajectory.settings.profile
    seconds = float(trajectory.time[-1])
    of_stretches = series(trajectory)
    if fit is None:
        leg = USUAL
        who = "a usual ankle"
    elif of_stretches:
        raise InputError(f"{shown(fit)}: what stretches will tell is of a usual leg; leave it out")
    else:
        leg = _saved(fit)
        who = f"the ankle of {shown(fit)}"
    if not of_stretches:
        measures, reflexes = _of_perturbation(trajectory, leg, level, progress)
        notes = (
            "The size of a reflex is its share of the torque’s variance; its gain and delay are "
            f"those of {SHARES[1]:g} %.",
            "Made by the equations that are fitted: a real leg’s intervals may be wider.",
        )
        return NerveExpectation(name, seconds, who, level, measures, reflexes, notes)
    measures, reflexes = _of_stretches(trajectory, level, progress)
    notes = (
        "The size of a reflex is its part of the torque’s peak in the fastest stretches of the "
        f"calf; numbers are those of {OF_PEAK[1]:g} %, with EMG.",
        "Elastic and viscous torque have no interval.",
    )
    return NerveExpectation(name, seconds, who, level, measures, reflexes, notes)


def series(trajectory: Trajectory) -> bool:
    """Whether a movement is one of slow and fast stretches at rest, each of them repeated."""
    if trajectory.effort.any():
        return False
    moved = [
        run for run in runs(trajectory.velocity > MOVING) if np.ptp(trajectory.angle[run]) > RANGE
    ]
    speeds = np.sort([float(np.median(trajectory.velocity[run])) for run in moved])
    groups = np.split(speeds, np.flatnonzero(speeds[1:] > (1.0 + ALIKE) * speeds[:-1]) + 1)
    repeated = [group for group in groups if len(group) >= REPEATED]
    return len(repeated) > 1


def _of_perturbation(
    trajectory: Trajectory, leg: Mapping[str, float], noise: float, progress: Progress | None
) -> tuple[dict[str, NerveMeasure], tuple[ExpectedReflex, ...]]:
    """Measures and reflexes seen, over `DRAWS` recordings of each share."""
    sides: dict[str, list[tuple[float, float]]] = {n: [] for n in (*_INTRINSIC, *_REFLEX)}
    true: dict[str, float] = {
        "intrinsic_stiffness": leg["stiffness"],
        "inertia": leg["inertia"],
        "intrinsic_viscosity": leg["viscosity"] + leg["branch_1"] * leg["time_1"],
        "reflex_delay": 1e3 * leg["delay"],
    }
    seen = list[ExpectedReflex]()
    for share in SHARES:
        shown = 0
        for draw in range(DRAWS):
            if progress is not None:
                progress(len(seen) * DRAWS + draw, len(SHARES) * DRAWS)
            recording, gain = perturbed_leg(trajectory, leg, share, noise, draw)
            answer = perturbed(recording)
            present = (
                answer.reflex.verdict == "present" and answer.reflex.direction == "dorsiflexion"
            )
            shown += present
            if share == SHARES[1]:
                true["reflex_gain"] = gain
            for name in sides if share == SHARES[1] else _INTRINSIC:
                m = answer.measures[name]
                if m.value is not None:
                    sides[name].append((m.value - m.ci95[0], m.ci95[1] - m.value))
        seen.append(ExpectedReflex(share, shown, DRAWS))
    measures = {}
    for name, each in sides.items():
        below, above = np.median(each, axis=0) if each else (np.inf, np.inf)
        number = Number(true[name], float(true[name] - below), float(true[name] + above))
        why = "" if each else "no reflex of this size is seen"
        measures[name] = number_of(name, number, why)
    return measures, tuple(seen)


def _of_stretches(
    trajectory: Trajectory, noise: float, progress: Progress | None
) -> tuple[dict[str, NerveMeasure], tuple[ExpectedReflex, ...]]:
    """Measures and reflexes seen, with EMG and without."""
    measures: dict[str, NerveMeasure] = {}
    seen = list[ExpectedReflex]()
    for share in OF_PEAK:
        if progress is not None:
            progress(len(seen), len(OF_PEAK))
        recording, silent, truth = stretched_leg(trajectory, share, noise, seed=0)
        answer = answers([recording])
        with_reflex, alone = (_fastest(each.stretches) for each in (answer, answers([silent])))
        shown_in, unheard = (
            sum(s.neural_ci95 is not None and s.neural_ci95[0] > 0.0 for s in each)
            for each in (with_reflex, alone)
        )
        seen.append(ExpectedReflex(share, shown_in, len(with_reflex), unheard))
        if share != OF_PEAK[1]:
            continue
        half = float(np.median([np.ptp(s.neural_ci95) / 2.0 for s in with_reflex if s.neural_ci95]))
        measures["neural_torque"] = _measure(truth["neural"], half, "Nm", "of each stretch")
        change = answer.smallest_detectable_change["neural_Nm"]
        if change is not None:
            measures["neural_torque_change"] = NerveMeasure(
                change,
                "Nm",
                (change, change),
                Verdict.UNDETERMINED,
                "smallest that would be detected",
            )
        sure = [np.ptp(t.ci95) / 2.0 for t in answer.threshold.values() if t.ci95 is not None]
        measures["threshold"] = _measure(
            truth["threshold"], float(min(sure, default=np.inf)), "deg", "of the surest muscle"
        )
    return measures, tuple(seen)


def _measure(value: float, half: float, unit: str, note: str) -> NerveMeasure:
    verdict = Verdict.WEAK if half < np.inf else Verdict.UNDETERMINED
    return NerveMeasure(value, unit, (value - half, value + half), verdict, note)


def _fastest(stretches: tuple[StretchAnswer, ...]) -> list[StretchAnswer]:
    """The fastest stretches of the calf."""
    calf = [s for s in stretches if s.direction == "dorsiflexion"]
    top = max((s.speed_deg_s for s in calf), default=0.0)
    return [s for s in calf if s.speed_deg_s >= (1.0 - ALIKE) * top]


def _saved(path: PathLike) -> dict[str, float]:
    """The leg of a file that `surae impedance` saved."""
    try:
        measures = read_json(path)["measures"]
        tissue = {
            key: float(measures[name]["value"])
            for key, name in (
                ("stiffness", "intrinsic_stiffness"),
                ("viscosity", "intrinsic_viscosity"),
                ("inertia", "inertia"),
            )
        }
        of_reflex = (
            ("delay", "reflex_delay", 1e-3),
            ("omega", "reflex_frequency", 2.0 * np.pi),
            ("zeta", "reflex_damping", 1.0),
        )
        reflex = {
            key: factor * value
            for key, name, factor in of_reflex
            if (value := measures[name]["value"]) is not None
        }
    except (KeyError, TypeError, ValueError):
        raise InputError(
            f"{shown(path)}: no stiffness, viscosity and inertia of surae impedance are in it; "
            "give the I.json that it saved of this leg"
        ) from None
    return {**USUAL, "branch_1": 0.0, **tissue, **reflex}
