"""What a session's stretches and perturbations say of reflexes."""

from collections.abc import Sequence

from surae.nerve.leg import Nerve, of_session
from surae.quality.position import relaxed_speeds, slow_and_fast
from surae.quality.trial import signals_of
from surae.recording import Recording
from surae.trials.sorting import Trial


def nerve_of(trials: Sequence[Trial]) -> Nerve | None:
    """What stretches at two speeds and perturbations say; None where nothing tells of reflexes."""
    perturbed = [t.recording for t in trials if t.use == "nerve" and t.recording is not None]
    moved = list[Recording]()
    speeds = list[float]()
    for trial in trials:
        if trial.use == "fit" and trial.recording is not None:
            speeds_of = relaxed_speeds(signals_of(trial.recording))
            speeds += speeds_of
            moved += [trial.recording][: len(speeds_of)]
    stretched = moved if slow_and_fast(speeds) else []
    return of_session(perturbed, stretched) if perturbed or stretched else None
