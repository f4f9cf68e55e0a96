"""A virtual leg on the device: what its muscles do, and the torque that the device feels."""

from dataclasses import dataclass, replace

import numpy as np

from surae.base.frozen import read_only
from surae.base.units import FloatArray
from surae.model import ModelOptions, get_model
from surae.model.geometry import JointAxis, moment_arm, paths
from surae.protocol import Trajectory
from surae.protocol.adaptation import Motion
from surae.recording import MUSCLES
from surae.signals import ModelInputs, inputs_as_given
from surae.studies.imperfections import Imperfections, coloured_noise, wandering
from surae.studies.populations import VirtualSubject, stream

#: EMG envelope at full effort and at rest [V]; the thesis's figures reach 6e-4 V.
EMG_FULL = 6e-4
EMG_REST = 1e-6

#: Moment arm of the gastrocnemius at the knee [m]: 12 to 20 mm (Spoor and van Leeuwen 1992,
#: *J. Biomech.* 25).
KNEE_ARM = 0.016
#: The gastrocnemius's part of the passive force of the triceps; no source, half is assumed.
KNEE_TISSUE = 0.5
#: Delay of the stretch reflex [s]: 42 ± 3 ms in the soleus (Sinkjær et al. 1996, *J. Neurophysiol.*
#: 76); its threshold [l0/s], about 15°/s at the ankle; and the largest effort that it reaches.
REFLEX_DELAY = 0.042
REFLEX_THRESHOLD = 0.1
REFLEX_LIMIT = 0.5
#: Seconds between the independent values of the knee's angle, and of the gains of the effort.
KNEE_PERIOD = 2.0
EFFORT_PERIOD = 1.0

_HEADS = [MUSCLES.index(muscle) for muscle in ("gl", "sol", "gm")]
_NOT_GASTROCNEMIUS = [MUSCLES.index(muscle) for muscle in ("ta", "sol")]


@dataclass(frozen=True, slots=True)
class VirtualTrial:
    """A trial: whose leg it is of, what is asked for, what is not ideal, and the trial's seed."""

    subject: VirtualSubject
    trajectory: Trajectory
    imperfections: Imperfections
    seed: int

    @property
    def name(self) -> str:
        """What it is called."""
        subject = self.subject
        settings = self.trajectory.settings
        return (
            f"virtual subject {subject.seed} ({subject.population}), {settings.profile}, "
            f"{settings.task}"
        )

    def simulated(self, model: str, options: ModelOptions) -> tuple[FloatArray, FloatArray]:
        """EMG envelopes [V], shape (n, 4), and torque [Nm], (n,), without the sensors' faults."""
        spec = get_model(model)
        trajectory = self.trajectory
        of = self.imperfections
        ankle, turn = misaligned(trajectory.motion, of.axis_forward, of.axis_up)
        done = trajectory.effort
        variation = of.effort_variation
        if variation > 0.0:
            done = done * self.gains("effort", variation, len(MUSCLES))
        if of.reflex_gain > 0.0:
            triceps, _ = paths(angle=ankle[0], velocity=ankle[1], options=options)
            stretch = triceps.speed / self.subject.parameters["l0_tri"]
            done = done.copy()
            done[:, _HEADS] += reflex(trajectory.time, stretch, of.reflex_gain)[:, None]
        envelopes = EMG_REST + (EMG_FULL - EMG_REST) * done
        inputs = inputs_as_given(
            self.name,
            trajectory.settings.rate_hz,
            trajectory.time,
            ankle,
            of.drive(envelopes, self.gains),
        )
        values = spec.vector(self.subject.truth(model, options), options)
        torque = spec.simulator(inputs, options).torque(values)
        if of.knee_motion > 0.0:
            knee = of.knee_motion * self._wandering("knee", 1, KNEE_PERIOD)[:, 0]
            torque = torque + knee_torque(inputs, model, options, values, knee)
        return envelopes, torque if turn is None else turn * torque

    def gains(self, of: str, variation: float, columns: int) -> FloatArray:
        """Log-normal factors of mean 1, shape (n, columns), that wander within seconds."""
        spread = np.sqrt(np.log1p(variation**2))
        gains = np.exp(spread * self._wandering(of, columns, EFFORT_PERIOD) - 0.5 * spread**2)
        return np.asarray(gains)

    def torque_noise(self) -> FloatArray | float:
        """Noise of the torque's sensor [Nm]."""
        of = self.imperfections
        settings = self.trajectory.settings
        if of.torque_noise == 0.0:
            return 0.0
        return coloured_noise(
            len(self.trajectory.time),
            settings.rate_hz,
            of.torque_noise,
            of.torque_noise_time,
            stream(self.subject, "torque", self.seed),
        )

    def _wandering(self, what: str, columns: int, period: float) -> FloatArray:
        return wandering(
            self.trajectory.time, period, columns, stream(self.subject, what, self.seed)
        )


def reflex(time: FloatArray, stretch: FloatArray, gain: float) -> FloatArray:
    """Effort of the reflex: the triceps's stretch [l0/s], delayed, above a threshold, limited."""
    delayed = np.interp(time - REFLEX_DELAY, time, stretch, left=0.0)
    return np.minimum(gain * np.maximum(delayed - REFLEX_THRESHOLD, 0.0), REFLEX_LIMIT)


def misaligned(plate: Motion, forward: float, up: float) -> tuple[Motion, FloatArray | None]:
    """Motion of an ankle whose axis is elsewhere [m], and dθ_ankle/dθ; None where it is not."""
    if forward == up == 0.0:
        return plate, None
    angle, velocity, acceleration = plate
    joint = JointAxis(angle=angle, forward=forward, up=up).joint
    swinging = joint.factor * acceleration + joint.bend * velocity**2
    return (joint.angle, joint.factor * velocity, swinging), joint.factor


def knee_torque(
    inputs: ModelInputs, model: str, options: ModelOptions, values: FloatArray, flexion: FloatArray
) -> FloatArray:
    """What knee flexion changes of the ankle torque, through the gastrocnemius.

    `flexion` [rad] by φ pays out φ·`KNEE_ARM` of the gastrocnemius, as much as plantarflexion by
    φ·`KNEE_ARM`/r(θ) would. So the force that a leg with an active gastrocnemius alone (and
    `KNEE_TISSUE` of the passive force) has at that angle takes the place of the force at θ; the
    moment arm stays that of θ. Compliant heads count as having tendons of their own.
    """
    emg = np.array(inputs.emg)
    emg[:, _NOT_GASTROCNEMIUS] = 0.0
    alone = replace(inputs, emg=read_only(emg))
    arm = moment_arm(inputs.angle, 0)
    slack = -flexion * KNEE_ARM / arm
    shifted = replace(
        alone,
        angle=read_only(inputs.angle + slack),
        velocity=read_only(inputs.velocity + np.gradient(slack, 1.0 / inputs.rate_hz)),
    )

    def force(of: ModelInputs) -> FloatArray:
        parts = get_model(model).simulator(of, options).parts(values)
        pulled: FloatArray = parts.neural_tri + KNEE_TISSUE * parts.tissue_tri
        return pulled / moment_arm(of.angle, 0)

    return arm * (force(shifted) - force(alone))
