"""Recordings of a virtual cohort, each made from the seed alone, in whatever order."""

from dataclasses import replace
from functools import lru_cache

import numpy as np

from surae.base.errors import ComputationError, InputError
from surae.base.frozen import read_only
from surae.base.units import FloatArray
from surae.model import ModelOptions
from surae.protocol import DIRECTIONS, Protocol, Trajectory, generate
from surae.recording import MUSCLES, Recording
from surae.studies import stream, virtual_recording
from surae_thesis.cohort.members import COMPLETED, CohortSubject, cohort_protocol

#: Sampling rate of the recordings [Hz] (2.1).
RECORDED_HZ = 2048.0
#: The model that stands for the truth: every tendon parameter is the subject's own.
TRUE_MODEL = "muscle-tendon"
#: A repetition is redone, with less effort, when the device stops at its torque limit (4.4).
_LESS = 0.85
_ATTEMPTS = 12
#: How late a subject follows the target that is shown [s].
_LATE = (0.1, 0.4)


def cohort_recording(member: CohortSubject, protocol: str, repetition: int) -> Recording:
    """One repetition, counted from 1, of one protocol by one subject: raw signals.

    Raises
    ------
    InputError
        The subject did not complete the protocol.
    ComputationError
        The subject cannot stay below the device's torque limit.
    """
    if protocol not in member.completed:
        did = ", ".join(member.completed)
        raise InputError(f"cohort: {member.id} did not complete {protocol!r}; completed: {did}")
    settings = cohort_protocol(protocol, member.angle_range, RECORDED_HZ, measured=member.measured)
    limit = settings.device.max_torque if settings.device else None
    trial = 10 * list(COMPLETED).index(protocol) + repetition
    for attempt in range(_ATTEMPTS):
        recording = virtual_recording(
            member.subject,
            _attempted(member, _motion(settings), trial, attempt),
            model=TRUE_MODEL,
            options=ModelOptions(),
            seed=1000 * attempt + trial,
            imperfections=member.imperfections,
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
