"""Virtual subjects and their trials: known parameters, simulated torque, noise of the thesis."""

from collections.abc import Mapping
from dataclasses import dataclass, replace

import numpy as np

from surae.errors import InputError
from surae.model import ModelOptions, get_model
from surae.protocol import Trajectory
from surae.recording import read_only
from surae.signals import ModelInputs
from surae.units import FloatArray

#: EMG envelope at full effort and at rest [V]; the thesis's figures reach 6e-4 V.
EMG_FULL = 6e-4
EMG_REST = 1e-6

#: Ranges from which a subject's parameters are drawn, uniformly and independently.
#: Passive torque of the triceps at 10° dorsiflexion: 6.2 ± 3.6 Nm healthy, 9.5 ± 4.8 Nm spastic
#: (Chung 2004); active torque up to about 80 Nm; patients have less mass, stiffer muscles, shorter
#: slack and optimal lengths (thesis 2.5.4).
POPULATIONS: dict[str, dict[str, tuple[float, float]]] = {
    "healthy": {
        "m": (1.5, 2.7),
        "k_tri": (170.0, 230.0),
        "k_tib": (90.0, 130.0),
        "x0_tri": (0.016, 0.018),
        "x0_tib": (0.062, 0.067),
        "tau_rel": (1.0, 6.0),
        "k_rel": (0.2, 0.6),
        "g1": (4e5, 8e5),
        "g2": (6e5, 1.2e6),
        "g3": (9e5, 1.7e6),
        "g4": (7e5, 1.3e6),
        "l0_tri": (0.040, 0.050),
        "l0_tib": (0.070, 0.090),
        "f0": (1.6, 2.4),
        "beta": (0.8, 1.2),
    },
}
POPULATIONS["patient"] = POPULATIONS["healthy"] | {
    "m": (1.25, 2.0),
    "k_tri": (190.0, 235.0),
    "k_tib": (120.0, 160.0),
    "x0_tri": (0.0145, 0.0165),
    "x0_tib": (0.058, 0.062),
    "l0_tri": (0.034, 0.042),
    "l0_tib": (0.060, 0.075),
}


@dataclass(frozen=True, slots=True)
class VirtualSubject:
    """A subject whose parameters are known.

    Attributes
    ----------
    population : str
        A name of `POPULATIONS`.
    seed : int
        The same population and seed always give the same subject.
    parameters : mapping of str to float
        The fifteen parameters of the muscle model.
    """

    population: str
    seed: int
    parameters: Mapping[str, float]


def virtual_subject(seed: int, population: str = "healthy") -> VirtualSubject:
    """Draw a subject.

    Raises
    ------
    InputError
        The population is not known.
    """
    if population not in POPULATIONS:
        known = ", ".join(POPULATIONS)
        raise InputError(f"unknown population {population!r}; known populations: {known}")
    rng = np.random.default_rng([seed, list(POPULATIONS).index(population)])
    ranges = POPULATIONS[population]
    return VirtualSubject(
        population, seed, {name: float(rng.uniform(*limits)) for name, limits in ranges.items()}
    )


def virtual_trial(
    subject: VirtualSubject,
    trajectory: Trajectory,
    *,
    model: str = "muscle",
    options: ModelOptions | None = None,
    noise: float = 0.05,
    seed: int = 0,
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

    Returns
    -------
    ModelInputs
        Ready to fit, used as it is.
    """
    options = options or ModelOptions()
    spec = get_model(model)
    emg = EMG_REST + (EMG_FULL - EMG_REST) * trajectory.effort
    clean = ModelInputs(
        name=f"virtual subject {subject.seed} ({subject.population}), "
        f"{trajectory.settings.profile}, {trajectory.settings.task}",
        rate_hz=trajectory.settings.rate_hz,
        time=trajectory.time,
        angle=trajectory.angle,
        velocity=trajectory.velocity,
        acceleration=trajectory.acceleration,
        emg=read_only(emg),
        emg_unit="V",
        torque=None,
        prepared=True,
    )
    values = spec.vector(subject.parameters, options)
    torque = spec.simulator(clean, options).torque(values)
    rng = np.random.default_rng([subject.seed, seed])
    return replace(
        clean,
        emg=read_only(_noisy(emg, noise, rng)),
        torque=read_only(_noisy(torque, noise, rng)),
        steps=(
            f"Simulated with model {model!r}; white noise of {100 * noise:g} % of each signal's "
            "mean magnitude added to EMG and torque.",
        ),
    )


def _noisy(signal: FloatArray, noise: float, rng: np.random.Generator) -> FloatArray:
    """A signal, shape (n,) or (n, k), with white noise relative to its mean magnitude."""
    scale = noise * np.abs(signal).mean(axis=0)
    return np.asarray(signal + scale * rng.standard_normal(signal.shape), dtype=np.float64)
