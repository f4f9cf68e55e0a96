"""Recordings of a virtual cohort, each made from the seed alone, in whatever order."""

from collections.abc import Collection
from dataclasses import replace
from functools import lru_cache

import numpy as np

from surae.errors import ComputationError, InputError
from surae.frozen import read_only
from surae.model import ModelOptions
from surae.protocol import DIRECTIONS, Protocol, Trajectory, generate
from surae.recording import MUSCLES, Recording
from surae.signals import ModelInputs, Preparation, prepare
from surae.studies import stream, virtual_recording
from surae.units import FloatArray
from surae_thesis.cohort.members import COMPLETED, CohortSubject, cohort_protocol

#: Sampling rate of the recordings, and of the signals that models read (thesis 2.1) [Hz].
RECORDED_HZ, FITTED_HZ = 2048.0, 256.0
#: The model that stands for the truth: every tendon parameter is the subject's own.
TRUE_MODEL = "muscle-tendon"
#: What a recording can be made without, to see what it does to a fit, and in words.
REMOVABLE = {
    "tendons": "tendons of the subject's own (those of Table 2 instead)",
    "emg-noise": "noise of rectified raw EMG (envelopes instead)",
    "crosstalk": "crosstalk",
    "unmeasured": "muscles without electrodes",
    "alignment": "ankle axis off the device's",
    "knee": "knee motion",
    "reflex": "stretch reflex",
    "torque-noise": "torque noise",
}
#: A repetition is redone, with less effort, when the device stops at its torque limit (4.4).
_LESS, _ATTEMPTS = 0.85, 12
#: How late a subject follows the target that is shown [s].
_LATE = (0.1, 0.4)
_SIZES = {
    "crosstalk": ("crosstalk",),
    "unmeasured": ("unmeasured",),
    "alignment": ("axis_forward", "axis_up"),
    "knee": ("knee_motion",),
    "reflex": ("reflex_gain",),
    "torque-noise": ("torque_noise",),
}


def cohort_inputs(
    member: CohortSubject,
    protocol: str,
    repetition: int,
    *,
    rate_hz: float = FITTED_HZ,
    without: Collection[str] = (),
) -> ModelInputs:
    """A recording of the cohort as a model reads it, after the default preparation (thesis 2.1)."""
    recording = cohort_recording(member, protocol, repetition, without=without)
    return prepare(recording, Preparation(rate_hz=rate_hz))


def cohort_recording(
    member: CohortSubject, protocol: str, repetition: int, *, without: Collection[str] = ()
) -> Recording:
    """One repetition of one protocol by one subject: raw signals at `RECORDED_HZ`.

    Parameters
    ----------
    member : CohortSubject
        Who.
    protocol : str
        One that the subject completed.
    repetition : int
        From 1.
    without : collection of str
        Names of `REMOVABLE` that this recording is spared; everything else in it stays the same.

    Raises
    ------
    InputError
        The subject did not complete the protocol, or something is unknown.
    """
    if protocol not in member.completed:
        did = ", ".join(member.completed)
        raise InputError(f"cohort: {member.id} did not complete {protocol!r}; completed: {did}")
    if repetition < 1:
        raise InputError(f"cohort: repetition {repetition}; they count from 1")
    unknown = [name for name in without if name not in REMOVABLE]
    if unknown:
        known = ", ".join(REMOVABLE)
        raise InputError(f"cohort: cannot leave out {unknown[0]!r}; use one of: {known}")
    removed = [field for name in without for field in _SIZES.get(name, ())]
    imperfections = replace(member.imperfections, **dict.fromkeys(removed, 0.0))
    subject = member.subject
    if "tendons" in without:
        subject = replace(subject, tendons={})
    settings = cohort_protocol(protocol, member.range_of_motion, RECORDED_HZ)
    limit = settings.device.max_torque if settings.device else None
    trial = 10 * list(COMPLETED).index(protocol) + repetition
    for attempt in range(_ATTEMPTS):
        trajectory = _attempted(member, _motion(settings), trial, attempt)
        recording = virtual_recording(
            subject,
            trajectory,
            model=TRUE_MODEL,
            options=ModelOptions(),
            seed=1000 * attempt + trial,
            imperfections=imperfections,
            raw="emg-noise" not in without,
        )
        highest = float(np.abs(recording.channels["torque"].values).max())
        if limit is None or highest < limit:
            return replace(recording, name=f"{member.id} {protocol} {repetition}")
    raise ComputationError(f"cohort: {member.id} exceeds {limit:g} Nm in {_ATTEMPTS} attempts")


@lru_cache(maxsize=8)
def _motion(settings: Protocol) -> Trajectory:
    return generate(settings)


def _attempted(
    member: CohortSubject, trajectory: Trajectory, trial: int, attempt: int
) -> Trajectory:
    """The trajectory with what this subject makes of its effort this time."""
    rng = stream(member.subject, "repetition", 1000 * attempt + trial)
    late = rng.uniform(*_LATE)
    spread = float(np.sqrt(np.log1p(member.level_variation**2)))
    levels = np.exp(spread * rng.standard_normal(len(DIRECTIONS)) - 0.5 * spread**2)
    done: FloatArray = np.empty_like(trajectory.effort)
    for muscles, level in zip(DIRECTIONS, levels.tolist(), strict=True):
        for muscle in muscles:
            column = MUSCLES.index(muscle)
            asked = np.interp(
                trajectory.time - late, trajectory.time, trajectory.effort[:, column], left=0.0
            )
            done[:, column] = level * _LESS**attempt * asked
    return replace(trajectory, effort=read_only(done))
