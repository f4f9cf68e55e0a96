"""Virtual legs that are richer than every model which is fitted to them, to test what is claimed.

Tendons of their own, electrodes that hear other muscles, a torque that follows the EMG late, a
sensor whose zero is off, noise on EMG and torque; with `drifting` an axis beside the device's and
electrodes whose gain drifts too. The leg is simulated at four times the rate of the recording, and
delay, mixing and drift are applied to the envelopes here, not by what a fit uses.
"""

from dataclasses import dataclass, replace

import numpy as np

from surae.frozen import read_only
from surae.model import ModelOptions, get_model
from surae.protocol import Protocol, Trajectory, generate
from surae.signals import ModelInputs
from surae.studies.leg import EMG_FULL, EMG_REST, misaligned
from surae.studies.populations import VirtualSubject, stream, virtual_subject
from surae.units import FloatArray

#: Steps of the simulation for each sample of the recording.
_FINER = 4
#: Ranges of ε0 of triceps and tibialis [m].
_TENDONS = {"dlt_tri": (0.012, 0.030), "dlt_tib": (0.005, 0.012)}
_CROSSTALK, _DELAY, _ZERO, _AXIS, _DRIFT = 0.08, (0.020, 0.060), 6.0, 0.006, 0.10
_FIRST = 40_000


@dataclass(frozen=True, slots=True)
class RicherLeg:
    """One trial of a leg that no model of a fit is.

    Attributes
    ----------
    inputs : ModelInputs
        The recording, prepared.
    parameters : mapping of str to float
        The true parameters of the leg, tendons included.
    delay : float
        From EMG to torque [s].
    zero : float
        Of the torque sensor [Nm].
    noise : float
        Standard deviation of the torque's noise [Nm].
    """

    inputs: ModelInputs
    parameters: dict[str, float]
    delay: float
    zero: float
    noise: float


def richer_leg(
    seed: int,
    *,
    drifting: bool = False,
    noise: float = 0.03,
    rate_hz: float = 128.0,
    trial: int = 0,
) -> RicherLeg:
    """Draw a leg and one trial of it: 35 s of holds with a chirp and alternating effort.

    Parameters
    ----------
    seed : int
        Of the leg; odd ones are active throughout, the others relaxed to 11 s.
    drifting : bool
        Whether the axis is beside the device's and the electrodes' gain drifts.
    noise : float
        Of EMG and torque, as a part of each one's mean magnitude.
    rate_hz : float
        Of the recording.
    trial : int
        Trials of a leg share all but effort, zero, drift and noise.
    """
    drawn = virtual_subject(_FIRST + seed)
    rng = stream(drawn, "richer leg")
    tendons = {name: float(rng.uniform(*limits)) for name, limits in _TENDONS.items()}
    crosstalk = rng.uniform(0.0, _CROSSTALK, (4, 4))
    np.fill_diagonal(crosstalk, 1.0)
    delay = float(rng.uniform(*_DELAY))
    axis = np.clip(_AXIS * rng.standard_normal(2), -0.015, 0.015) if drifting else np.zeros(2)
    rng = stream(drawn, "richer trial", trial)
    zero = float(rng.uniform(-_ZERO, _ZERO))
    levels = rng.uniform(0.7, 1.0, 4)
    drift = rng.uniform(-_DRIFT, _DRIFT, 4) if drifting else np.zeros(4)

    motion = _motion(rate_hz * _FINER, "active" if seed % 2 else "part-passive")
    time = motion.time
    envelopes = EMG_REST + (EMG_FULL - EMG_REST) * motion.effort * levels
    torque = zero + _torque(drawn, tendons, motion, _late(envelopes, time, delay), axis)
    heard = envelopes @ crosstalk.T * (1.0 + drift * (time[:, None] / time[-1] - 0.5))
    kept = slice(None, None, _FINER)
    emg, torque = heard[kept], torque[kept]
    deviation = noise * float(np.abs(torque).mean())
    return RicherLeg(
        inputs=ModelInputs(
            name=f"richer leg {seed}",
            rate_hz=rate_hz,
            time=read_only(time[kept]),
            angle=read_only(motion.angle[kept]),
            velocity=read_only(motion.velocity[kept]),
            acceleration=read_only(motion.acceleration[kept]),
            emg=read_only(emg + noise * emg.mean(axis=0) * rng.standard_normal(emg.shape)),
            emg_unit="V",
            torque=read_only(torque + deviation * rng.standard_normal(len(torque))),
            prepared=True,
        ),
        parameters={**drawn.parameters, **tendons},
        delay=delay,
        zero=zero,
        noise=deviation,
    )


def _motion(rate_hz: float, task: str) -> Trajectory:
    return generate(
        Protocol(
            profile="multiple-holds", task=task, chirp_amplitude=0.2, chirp_rate=0.16,
            rate_hz=rate_hz,
        )
    )  # fmt: skip


def _late(envelopes: FloatArray, time: FloatArray, delay: float) -> FloatArray:
    """The envelopes that drive the torque: those of `delay` ago."""
    return np.stack([np.interp(time - delay, time, one) for one in envelopes.T], axis=1)


def _torque(
    subject: VirtualSubject,
    tendons: dict[str, float],
    motion: Trajectory,
    emg: FloatArray,
    axis: FloatArray,
) -> FloatArray:
    plate = (motion.angle, motion.velocity, motion.acceleration)
    ankle, turn = misaligned(plate, float(axis[0]), float(axis[1]))
    spec, options = get_model("muscle-tendon"), ModelOptions()
    inputs = ModelInputs(
        name="richer leg",
        rate_hz=motion.settings.rate_hz,
        time=motion.time,
        angle=read_only(np.array(ankle[0])),
        velocity=read_only(np.array(ankle[1])),
        acceleration=read_only(np.array(ankle[2])),
        emg=read_only(emg),
        emg_unit="V",
        torque=None,
        prepared=True,
    )
    values = spec.vector(replace(subject, tendons=tendons).truth("muscle-tendon", options), options)
    torque = spec.simulator(inputs, options).torque(values)
    return torque if turn is None else turn * torque
