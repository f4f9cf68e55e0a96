"""Virtual legs richer than each named model, to test what is claimed: within the family of `auto`.

Tendons of their own, electrodes that hear other muscles, a torque that follows the EMG late, a
sensor whose zero is off, noise on EMG and torque; with `drifting` an axis beside the device's and
electrodes whose gain drifts too. The leg is simulated at four times the rate of the recording, and
delay, mixing and drift are applied to the envelopes here, not by what a fit uses. A `foreign` leg
is outside of the family that a fit searches: its muscles have a wider or narrower force-length
curve, another maximum speed, tendons with toes of another form, and antagonists that no electrode
hears.
"""

from collections.abc import Mapping, Sequence
from dataclasses import dataclass
from typing import Any

import numpy as np

from surae.base.files import PathLike
from surae.base.units import FloatArray
from surae.model import ModelOptions, get_model
from surae.model.contraction import CF
from surae.model.geometry import paths
from surae.protocol import Protocol, Trajectory, generate
from surae.recording import MUSCLES
from surae.recording.writing import write_csv
from surae.signals import ModelInputs, inputs_as_given
from surae.studies.imperfections import raw_emg, wandering
from surae.studies.leg import EMG_FULL, EMG_REST, misaligned
from surae.studies.populations import VirtualSubject, stream, virtual_subject

#: Steps of the simulation for each sample of the recording.
_FINER = 4
#: Ranges of ε0 of triceps and tibialis [m].
_TENDONS = {"dlt_tri": (0.012, 0.030), "dlt_tib": (0.005, 0.012)}
_CROSSTALK, _DELAY, _ZERO, _AXIS, _DRIFT = 0.08, (0.020, 0.060), 6.0, 0.006, 0.10
#: F̄toe and ktoe of a tendon (Table 2).
_TOES = {"pt_tri": 0.3, "pt_tib": 0.3, "kt_tri": 4.0, "kt_tib": 4.0}
#: What a foreign leg has: F̄toe and ktoe of its tendons, the width cf of its force-length curve,
#: vmax in optimal lengths a second, and the part of a muscle's effort that its antagonist has too.
_TOE, _BEND, _WIDTH, _VMAX, _UNHEARD = (0.2, 0.4), (2.0, 4.0), (0.08, 0.13), (6.0, 10.0), 0.10
#: What differs from trial to trial in a leg that is not the same in all.
_VARYING = ("k_tri", "k_tib", "k_rel", "tau_rel", "g1", "g2", "g3", "g4")
#: Rate of raw EMG [Hz].
RAW_HZ = 1024.0
_FIRST = 40_000


@dataclass(frozen=True, slots=True)
class RicherLeg:
    """One trial of a leg that no model of a fit is."""

    #: The recording as it is measured, EMG as envelopes that may be negative by their noise.
    inputs: ModelInputs
    raw: FloatArray | None  #: Raw EMG [V] in place of the envelopes, shape (n, 4).
    #: The true parameters of the leg, tendons and their toes included.
    parameters: dict[str, float]
    delay: float  #: From EMG to torque [s].
    zero: float  #: Of the torque sensor [Nm].
    noise: float  #: Standard deviation of the torque's noise [Nm].

    def write(self, path: PathLike, muscles: Sequence[str] = MUSCLES) -> None:
        """Write the trial as a CSV file, as a laboratory that knows nothing of it would have it."""
        inputs = self.inputs
        emg = np.maximum(inputs.emg, 0.0) if self.raw is None else self.raw
        columns = {"time_s": inputs.time, "angle_rad": inputs.angle}
        if inputs.torque is not None:
            columns["torque_Nm"] = inputs.torque
        columns |= {f"emg_{name}_V": emg[:, MUSCLES.index(name)] for name in muscles}
        write_csv(path, columns, [f"emg: {'envelope' if self.raw is None else 'raw'}"])


def richer_leg(
    seed: int,
    *,
    drifting: bool = False,
    foreign: bool = False,
    noise: float = 0.03,
    emg_noise: float | None = None,
    raw: bool = False,
    rate_hz: float = 128.0,
    trial: int = 0,
    mounting: int = 0,
    varying: float = 0.0,
    turned: float = 0.0,
    **motion: Any,
) -> RicherLeg:
    """Draw a leg and one trial of it: 35 s of holds with a chirp and alternating effort.

    Legs of an odd seed are active throughout, the others relaxed to 11 s. `drifting`: the axis is
    beside the device's and the electrodes' gain drifts; `foreign`: the muscles are of another kind
    than those of every model. `noise` is that of EMG and torque as a part of each one's mean
    magnitude, `emg_noise` of EMG where it is another; `raw` EMG is sampled at `RAW_HZ`, as
    everything is then, and its noise is its own. Trials of a leg share all but effort, zero, drift
    and noise; those of another `mounting`, of electrodes and foot, have another crosstalk and axis
    too. `varying` is the part by which stiffness, relaxation and the muscles' strength differ from
    trial to trial, `turned` by how much the angle's zero is off [rad]. `motion` are the settings of
    the `Protocol` that differ.
    """
    rate_hz, finer = (RAW_HZ, 1) if raw else (rate_hz, _FINER)
    drawn = virtual_subject(_FIRST + seed)
    rng = stream(drawn, "richer leg")
    tendons = {name: float(rng.uniform(*limits)) for name, limits in _TENDONS.items()}
    crosstalk = rng.uniform(0.0, _CROSSTALK, (4, 4))
    delay = float(rng.uniform(*_DELAY))
    if mounting:
        rng = stream(drawn, "richer mounting", mounting)
        crosstalk = rng.uniform(0.0, _CROSSTALK, (4, 4))
    np.fill_diagonal(crosstalk, 1.0)
    axis = np.clip(_AXIS * rng.standard_normal(2), -0.015, 0.015) if drifting else np.zeros(2)
    rng = stream(drawn, "richer trial", trial)
    zero = float(rng.uniform(-_ZERO, _ZERO))
    levels = rng.uniform(0.7, 1.0, 4)
    drift = rng.uniform(-_DRIFT, _DRIFT, 4) if drifting else np.zeros(4)

    path = _motion(rate_hz * finer, seed, motion)
    time = path.time
    envelopes = EMG_REST + (EMG_FULL - EMG_REST) * path.effort * levels
    driving, options = _late(envelopes, time, delay), ModelOptions()
    own = {**drawn.parameters, **tendons, **_TOES}
    if foreign:
        driving, options, toes = _foreign(drawn, path, driving, trial)
        own |= toes
    now = _differing(own, varying, stream(drawn, "varying leg", trial))
    torque = zero + _torque(now, path, driving, options, axis)
    gain = 1.0 + drift * (time[:, None] / time[-1] - 0.5)
    heard = envelopes @ crosstalk.T * gain
    sampled = raw_emg(envelopes, rate_hz, rng) @ crosstalk.T * gain if raw else None
    kept = slice(None, None, finer)
    emg, torque = heard[kept], torque[kept]
    deviation = noise * float(np.abs(torque).mean())
    scatter = (noise if emg_noise is None else emg_noise) * emg.mean(axis=0)
    moved = (path.angle[kept] + turned, path.velocity[kept], path.acceleration[kept])
    return RicherLeg(
        inputs=inputs_as_given(
            f"richer leg {seed}",
            rate_hz,
            time[kept],
            moved,
            emg + scatter * rng.standard_normal(emg.shape),
            torque=torque + deviation * rng.standard_normal(len(torque)),
        ),
        raw=sampled,
        parameters=own,
        delay=delay,
        zero=zero,
        noise=deviation,
    )


def _differing(
    own: Mapping[str, float], varying: float, rng: np.random.Generator
) -> Mapping[str, float]:
    """A leg whose stiffness, relaxation and strength differ by such a part in this trial."""
    return {**own, **{n: own[n] * np.exp(varying * rng.standard_normal()) for n in _VARYING}}


def _motion(rate_hz: float, seed: int, settings: Mapping[str, Any]) -> Trajectory:
    usual = {
        "profile": "multiple-holds",
        "task": "active" if seed % 2 else "part-passive",
        "chirp_amplitude": 0.2,
        "chirp_rate": 0.16,
    }
    return generate(Protocol(**{**usual, **settings}, rate_hz=rate_hz))


def _late(envelopes: FloatArray, time: FloatArray, delay: float) -> FloatArray:
    """The envelopes that drive the torque: those of `delay` ago."""
    return np.stack([np.interp(time - delay, time, column) for column in envelopes.T], axis=1)


def _foreign(
    subject: VirtualSubject, motion: Trajectory, emg: FloatArray, trial: int
) -> tuple[FloatArray, ModelOptions, dict[str, float]]:
    """What drives a foreign leg, its options and its tendons' toes.

    The force-length curve of another width is that of the model times a factor of the length on a
    rigid tendon, which is put on what drives the muscle.
    """
    rng = stream(subject, "foreign leg")
    toes = {f"pt_{group}": float(rng.uniform(*_TOE)) for group in ("tri", "tib")}
    toes |= {f"kt_{group}": float(rng.uniform(*_BEND)) for group in ("tri", "tib")}
    narrower = 1.0 / rng.uniform(*_WIDTH) - 1.0 / CF
    options = ModelOptions(vmax_factor=float(rng.uniform(*_VMAX)))
    unheard = rng.uniform(0.0, _UNHEARD, 2)
    wave = wandering(motion.time, 1.0, 2, stream(subject, "unheard", trial))
    driven = emg.copy()
    driven[:, 0] += unheard[0] * np.exp(0.5 * wave[:, 0]) * emg[:, 1:].mean(axis=1)
    driven[:, 1:] += (unheard[1] * np.exp(0.5 * wave[:, 1]) * emg[:, 0])[:, None]
    both = paths(angle=motion.angle, velocity=motion.velocity, options=options)
    for columns, path, name in zip((slice(1, 4), slice(0, 1)), both, ("tri", "tib"), strict=True):
        u = path.length / subject.parameters[f"l0_{name}"] - 1.0
        driven[:, columns] *= np.exp(-narrower * u**2)[:, None]
    return driven, options, toes


def _torque(
    parameters: Mapping[str, float],
    motion: Trajectory,
    emg: FloatArray,
    options: ModelOptions,
    axis: FloatArray,
) -> FloatArray:
    ankle, turn = misaligned(motion.motion, float(axis[0]), float(axis[1]))
    spec = get_model("muscle-tendon")
    inputs = inputs_as_given("richer leg", motion.settings.rate_hz, motion.time, ankle, emg)
    torque = spec.simulator(inputs, options).torque(spec.vector(parameters, options))
    return torque if turn is None else turn * torque
