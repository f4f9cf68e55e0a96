"""What recordings say against whatever is made of them: errors that stand, and no movement."""

from collections.abc import Iterator, Sequence

import numpy as np

from surae.inference import FitResult
from surae.inference.judging.reasons import Reason, Scope, against
from surae.model.joint import Joint
from surae.quality.finding import NOT_AS_STATED, Quality
from surae.recording import MUSCLES
from surae.signals import ModelInputs, steady_emg

#: Movement [rad] between the 1st and 99th percentile: below the first an ankle holds still.
STILL = np.radians(4.0)
_LITTLE = np.radians(10.0)
#: Findings of which the torque at rest knows nothing.
_OF_EMG = ("electrodes-swapped", "emg-unit")
#: Reasons that are errors of recordings.
OF_RECORDINGS = ("not-as-stated", "error-stands")
#: Findings that a fit meets otherwise: it is of the parts between gaps, and judges what moves.
_MET_OTHERWISE = ("time-gap", "angle-still")


def of_recordings(quality: Sequence[Quality]) -> tuple[Reason, ...]:
    """What errors of its recordings say against whatever is made of them."""
    return (*_not_as_stated(quality), *_errors(quality))


def _not_as_stated(quality: Sequence[Quality]) -> Iterator[Reason]:
    """Grave but for signs and electrodes: of these a quick fit accuses a relaxed leg of forty."""
    for trial in quality:
        for code in sorted(
            NOT_AS_STATED & {f.code for f in trial.findings if f.severity == "error"}
        ):
            scope = Scope.MUSCLES if code in _OF_EMG else Scope.ALL
            yield against(
                "not-as-stated",
                grave="-unit" in code,
                scope=scope,
                trial=trial.recording,
                code=code,
            )


def _errors(quality: Sequence[Quality]) -> Iterator[Reason]:
    """Any other error that stands, of each recording the first."""
    for trial in quality:
        errors = [
            f
            for f in trial.findings
            if f.severity == "error" and f.code not in (*NOT_AS_STATED, *_MET_OTHERWISE)
        ]
        if errors:
            of_emg = all((f.channel or "").startswith("emg") for f in errors)
            scope = Scope.MUSCLES if of_emg else Scope.ALL
            yield against(
                "error-stands", scope=scope, trial=trial.recording, what=errors[0].message
            )


def range_moved(inputs: Sequence[ModelInputs]) -> float:
    """Movement of all recordings together [rad]: several holds at different angles have one."""
    angle = np.concatenate([recording.angle[recording.counts] for recording in inputs])
    return float(np.ptp(np.percentile(angle, [1.0, 99.0])))


def movement(inputs: Sequence[ModelInputs], joint: Joint) -> Iterator[Reason]:
    """An ankle that holds still shows neither stiffness nor an optimal length."""
    moved = range_moved(inputs)
    degrees = float(np.degrees(moved))
    if moved < STILL:
        yield against("still", joint.worded, grave=True, moved=degrees)
    elif moved < _LITTLE:
        yield against("moves-little", joint.worded, moved=degrees)


def effort(result: FitResult) -> Iterator[Reason]:
    """Weights that are free need an EMG that changes."""
    problem = result.problem
    steady = zip(MUSCLES, problem.spec.weights, steady_emg(problem.inputs), strict=True)
    silent = [
        muscle.upper() for muscle, weight, is_so in steady if is_so and weight in problem.free
    ]
    if silent:
        yield against("emg-steady", scope=Scope.MUSCLES, muscles=", ".join(silent))
