"""What each trial of a session is, decided from its signals and from the other trials.

A trial moves, or holds still: a hold cannot show stiffness and lengths, and is never fitted by
itself; holds with effort at several angles are an isometric set, which is fitted together. A trial
is passive where the EMG of every muscle stays near what it is at rest, active where not, and
maximal where its description says so or, of a hold, where a muscle works harder than in any trial
that moves. The reason is reported, and a description overrules it.
"""

from collections.abc import Iterable, Mapping, Sequence
from dataclasses import dataclass, field, replace
from string import digits

import numpy as np

from surae.base.file_form import filed
from surae.base.formatting import check_known
from surae.base.records import FileName
from surae.inference.diagnosis import STILL
from surae.quality.numeric import quantile, smooth
from surae.quality.position import perturbing
from surae.quality.registry import unfit
from surae.quality.trial import Signals, signals_of
from surae.recording import MUSCLES, Recording
from surae.recording.described import ALONE, EFFORTS, EMPTY, TrialDescription
from surae.recording.roles import words_of
from surae.signals.selective import one_at_a_time

__all__ = ["EFFORTS", "Hold", "Reading", "Trial", "is_named_maximal", "sorted_trials"]

#: EMG is averaged over this [s] before its level is judged.
_AVERAGED = 0.25
#: Of the session's largest level of a muscle above rest, what a relaxed muscle stays below.
_RELAXED = 0.1
#: A muscle whose largest level in the session is not so many times that at rest is silent in it.
_SILENT = 2.5
#: A hold in which a muscle works so many times harder than in any moving trial is maximal.
_HARDER = 1.25
#: Holds at so many angles, each so far [rad] from the next, are an isometric set: a parabola's
#: three, and twice what a held foot moves.
_ANGLES = 3
_APART = 2.0 * STILL
#: The problem of a trial whose description says use = false.
LEFT_OUT = "left out by the description"
_MAXIMAL_WORDS = {"mvc", "mvic", "mvcs", "max", "maximal", "maximum"}
_EMPTY_WORDS = {"empty", "tare", "unloaded"}
_USES = {EMPTY: "device", ALONE: "crosstalk"}
#: What `surae.impedance` is to tell of: no model of muscles is fitted to it.
PERTURBED = "small random perturbations"


@dataclass(frozen=True, slots=True)
class Reading:
    """A file as it was read for a session, or why it could not be."""

    name: str  #: The trial's.
    path: str | None  #: Its file, None for a recording that came from no file.
    recording: Recording | None  #: None where it could not be read, and `problem` says why.
    problem: str = ""  #: Empty where there is none.
    #: What its mapping says of it.
    description: TrialDescription = field(default_factory=TrialDescription)


@filed(angle="angle_rad", torque="torque_Nm", sd="sd_Nm")
@dataclass(frozen=True, slots=True)
class Hold:
    """What a trial that holds still tells: mean angle [rad], torque and its deviation [Nm]."""

    angle: float
    torque: float
    sd: float


@filed("recording", path="file", stated="told")
@dataclass(frozen=True, slots=True)
class Trial:
    """One trial of a session."""

    name: str  #: Unique in the session.
    path: FileName | None  #: Its file.
    recording: Recording | None  #: None where it could not be read; `problem` then says why.
    problem: str  #: Why it is not used; empty where it is.
    #: One of `EFFORTS`, or "unknown": what the muscles did.
    effort: str
    moves: bool  #: Whether the ankle moved.
    why: str  #: How effort and movement were decided.
    #: "fit", "hold", "reference", "device", "crosstalk", "nerve", "none": What it is used for: it
    #: is fitted; it gives torque at one angle; its EMG is a reference; it shows what the device
    #: adds to the torque, what electrodes hear of other muscles, what is tissue and what reflex.
    use: str
    hold: Hold | None = None  #: Angle and torque of a trial that holds still.
    #: `condition`, `notes`: as described.
    condition: str | None = None
    notes: str | None = None
    stated: bool = False  #: The effort was described or given, not decided.


@dataclass(frozen=True, slots=True)
class _Level:
    """EMG level of one muscle in a trial: at rest, at most."""

    rest: float
    top: float


def sorted_trials(
    readings: Sequence[Reading], efforts: Mapping[str, str] | None = None
) -> tuple[Trial, ...]:
    """Decide what each trial is; `efforts`, by trial, go before what data and descriptions say."""
    given = dict(efforts or {})
    names = [reading.name for reading in readings]
    for name, effort in given.items():
        check_known("effort of trial", names, name)
        check_known(f"effort of {name}:", EFFORTS, effort)
    levels: dict[str, dict[str, _Level]] = {}
    trials: list[Trial] = []
    steps: dict[str, tuple[str, str]] = {}
    for reading in readings:
        trial = _unsorted(reading)
        stated = given.get(reading.name) or reading.description.effort
        if not trial.problem and reading.recording is not None:
            signals = signals_of(reading.recording)
            trial = _moved(trial, signals)
            levels[trial.name] = {}
            if stated is None and (step := _step(trial, signals)):
                steps[trial.name] = step
            if (stated or steps.get(trial.name, ("",))[0]) == EMPTY:
                trials.append(trial)
                continue  # there is no muscle in it
            for muscle, envelope in signals.fast.items():
                level = smooth(envelope, round(_AVERAGED * signals.rate_hz))
                levels[trial.name][muscle] = _Level(quantile(level, 0.05), float(level.max()))
        trials.append(trial)
    moving = [trial.name for trial in trials if trial.moves]
    sorted_: list[Trial] = []
    for trial, reading in zip(trials, readings, strict=True):
        if trial.name not in levels:
            sorted_.append(trial)
            continue
        stated = given.get(trial.name) or reading.description.effort
        step = steps.get(trial.name) or _effort(trial, levels, moving)
        effort, why = (stated, "as described") if stated else step
        use = _USES.get(effort) or (
            "nerve"
            if trial.why == PERTURBED
            else "fit"
            if trial.moves
            else "reference"
            if effort == "maximal"
            else "hold"
        )
        why = f"{trial.why}; {why}"
        sorted_.append(replace(trial, effort=effort, use=use, why=why, stated=stated is not None))
    return tuple(_isometric(sorted_))


def is_named_maximal(name: str) -> bool:
    """Whether a trial is one of maximal effort by its name, as ``max-1`` or ``mvc_calf``."""
    return bool({word.rstrip(digits) for word in words_of(name)} & _MAXIMAL_WORDS)


def tell_together(angles: Iterable[float]) -> bool:
    """Whether holds at these angles [rad] show torque over angle."""
    apart = np.diff(np.sort(np.fromiter(angles, float)))
    return 1 + int(np.count_nonzero(apart > _APART)) >= _ANGLES


def _isometric(trials: list[Trial]) -> list[Trial]:
    """The same, holds with effort at several angles as one isometric set where no trial moves.

    Together they show torque over angle, which one of them does not.
    """
    active = [
        trial
        for trial in trials
        if trial.hold is not None
        and (trial.effort == "isometric" or (trial.effort == "active" and not trial.stated))
    ]
    if any(trial.moves for trial in trials) or not tell_together(
        trial.hold.angle for trial in active if trial.hold is not None
    ):
        return trials
    why = f"; one of {len(active)} holds at several angles, fitted together"
    return [
        replace(trial, effort="isometric", use="fit", why=trial.why + why)
        if trial in active
        else trial
        for trial in trials
    ]


def _unsorted(reading: Reading) -> Trial:
    """A trial of which nothing is decided yet."""
    problem = reading.problem
    recording = reading.recording
    if not problem and recording is not None:
        no_torque = "" if "torque" in recording.channels else "there is no torque"
        problem = no_torque or unfit(recording) or ""
        problem = problem if reading.description.use else LEFT_OUT
    return Trial(
        reading.name,
        reading.path,
        reading.recording,
        problem,
        "unknown",
        False,
        "",
        "none",
        condition=reading.description.condition,
        notes=reading.description.notes,
    )


def _moved(trial: Trial, signals: Signals) -> Trial:
    low, high = (quantile(signals.angle, share) for share in (0.005, 0.995))
    degrees = f"{np.rad2deg(high - low):.2g}°"
    if perturbing(signals.angle, signals.rate_hz):
        return replace(trial, moves=True, why=PERTURBED)
    if high - low >= STILL:
        return replace(trial, moves=True, why=f"moves over {degrees}")
    assert signals.torque is not None
    hold = Hold(
        float(signals.angle.mean()), float(signals.torque.mean()), float(signals.torque.std())
    )
    moves = f", it moves {degrees}" if high - low > np.radians(0.1) else ""
    return replace(trial, hold=hold, why=f"a static hold{moves}")


def _step(trial: Trial, signals: Signals) -> tuple[str, str] | None:
    """The step of a laboratory that a trial is, and why; None where it is of muscles together."""
    if {word.rstrip(digits) for word in words_of(trial.name)} & _EMPTY_WORDS:
        return EMPTY, "the empty device by its name"
    if not trial.moves and one_at_a_time(signals.fast, signals.rate_hz):
        return ALONE, "muscles contract one after the other"
    return None


def _effort(
    trial: Trial, levels: Mapping[str, Mapping[str, _Level]], moving: Sequence[str]
) -> tuple[str, str]:
    """Effort of a trial, and why."""
    if is_named_maximal(trial.name):
        return "maximal", "maximal by its name"
    of_trial = levels[trial.name]
    if not of_trial:
        return "unknown", "no EMG tells what the muscles did"
    shares: dict[str, float] = {}
    for muscle in (m for m in MUSCLES if m in of_trial):
        every = [levels[name][muscle] for name in levels if muscle in levels[name]]
        rest = min(level.rest for level in every)
        top = max(level.top for level in every)
        if top >= _SILENT * rest:
            shares[muscle] = (of_trial[muscle].top - rest) / (top - rest)
            harder = [levels[name][muscle].top for name in moving if muscle in levels[name]]
            if not trial.moves and harder and of_trial[muscle].top >= _HARDER * max(harder):
                times = of_trial[muscle].top / max(harder)
                return "maximal", (
                    f"the EMG of {muscle.upper()} is {times:.2g} times what it is in any trial "
                    "that moves"
                )
    if not shares:
        return "unknown", "no EMG changes in any trial: whether muscles were active it does not say"
    muscle = max(shares, key=lambda m: shares[m])
    percent = 100 * shares[muscle]
    part = f"reaches {percent:.0f} %" if percent >= 1.0 else "stays below 1 %"
    text = f"the EMG of {muscle.upper()} {part} of its largest in the session"
    return ("active" if shares[muscle] > _RELAXED else "passive"), text
