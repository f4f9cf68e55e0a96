"""Trials of virtual subjects: known parameters, simulated torque, noise of the thesis and more."""

import numpy as np

from surae.base.errors import InputError
from surae.base.units import FloatArray
from surae.model import ModelOptions
from surae.model.jit import compile_all
from surae.protocol import Trajectory
from surae.recording import Recording
from surae.signals import ModelInputs, inputs_as_given
from surae.studies.imperfections import (
    EMG_LOWEST_RATE,
    Imperfections,
    mixed_envelopes,
    mixing,
    raw_emg,
)
from surae.studies.leg import VirtualTrial
from surae.studies.populations import VirtualSubject, stream

_IDEAL = Imperfections()


def virtual_trial(
    subject: VirtualSubject,
    trajectory: Trajectory,
    *,
    model: str = "muscle",
    options: ModelOptions | None = None,
    noise: float = 0.05,
    seed: int = 0,
    imperfections: Imperfections = _IDEAL,
) -> ModelInputs:
    """Simulate a trial of a subject and add the thesis's noise (2.5.3).

    The torque is simulated from the true EMG; then white noise is added to the four EMG channels
    and to the torque, `noise` times the mean magnitude of each.

    Parameters
    ----------
    subject : VirtualSubject
        Whose leg it is.
    trajectory : Trajectory
        Motion and effort.
    model : str
        Model that stands for the truth.
    options : ModelOptions, optional
        Its switches.
    noise : float
        Standard deviation of the noise as a part of each signal's mean magnitude.
    seed : int
        Seed of the noise, beside the subject's own.
    imperfections : Imperfections
        What else is not ideal; by default nothing.

    Returns
    -------
    ModelInputs
        Ready to fit, used as it is.

    Examples
    --------
    >>> protocol = surae.Protocol(profile="multi-sine", duration=20.0)
    >>> leg = surae.virtual_subject(seed=1)
    >>> surae.virtual_trial(leg, surae.generate(protocol)).torque
    """
    compile_all()  # a fit will follow
    trial = VirtualTrial(subject, trajectory, imperfections, seed)
    envelopes, torque = trial.simulated(model, options or ModelOptions())
    rng = np.random.default_rng([subject.seed, seed])
    emg = _noisy(mixed_envelopes(envelopes, imperfections.crosstalk), noise, rng)
    torque = _noisy(torque, noise, rng) + trial.torque_noise()
    return inputs_as_given(
        trial.name,
        trajectory.settings.rate_hz,
        trajectory.time,
        trajectory.motion,
        emg,
        torque=torque,
        steps=(
            f"Simulated with model {model!r}; white noise of {100 * noise:g} % of each signal's "
            "mean magnitude added to EMG and torque.",
            *imperfections.steps,
        ),
    )


def virtual_recording(
    subject: VirtualSubject,
    trajectory: Trajectory,
    *,
    model: str = "muscle",
    options: ModelOptions | None = None,
    seed: int = 0,
    imperfections: Imperfections = _IDEAL,
) -> Recording:
    """A trial of a subject as it would be recorded, with raw EMG, for the whole chain of signals.

    Angle, torque and raw EMG (`surae.studies.imperfections.raw_emg`) at the trajectory's rate, for
    example 2048 Hz. On average, the default preparation gives back the EMG envelopes that drove
    the torque, so that its weights are the subject's; being rectified noise, they fluctuate.

    Parameters
    ----------
    subject, trajectory, model, options
        As in `virtual_trial`; the trajectory at `EMG_LOWEST_RATE` or more.
    seed : int
        Seed of everything random in the trial, beside the subject's own.
    imperfections : Imperfections
        What is not ideal; by default nothing.

    Returns
    -------
    Recording
        As a laboratory would record it.

    Raises
    ------
    InputError
        The trajectory is sampled too slowly for raw EMG.
    """
    rate_hz = trajectory.settings.rate_hz
    if rate_hz < EMG_LOWEST_RATE:
        raise InputError(
            f"raw EMG at {rate_hz:g} Hz is too slow; generate the trajectory at "
            f"{EMG_LOWEST_RATE:g} Hz or more, for example 2048 Hz"
        )
    compile_all()  # a fit will follow
    trial = VirtualTrial(subject, trajectory, imperfections, seed)
    envelopes, torque = trial.simulated(model, options or ModelOptions())
    emg = raw_emg(envelopes, rate_hz, stream(subject, "raw EMG", seed))
    return Recording.from_arrays(
        trajectory.time,
        trajectory.angle,
        torque + trial.torque_noise(),
        emg @ mixing(imperfections.crosstalk).T,
        name=trial.name,
        emg_kind="raw",
    )


def _noisy(signal: FloatArray, noise: float, rng: np.random.Generator) -> FloatArray:
    """A signal, shape (n,) or (n, k), with white noise relative to its mean magnitude."""
    scale = noise * np.abs(signal).mean(axis=0)
    return np.asarray(signal + scale * rng.standard_normal(signal.shape), dtype=np.float64)
