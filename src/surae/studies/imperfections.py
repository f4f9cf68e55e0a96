"""What a real measurement has and the thesis's simulated one does not: settings, all off."""

import math
from dataclasses import dataclass, fields
from numbers import Real

from surae.errors import InputError
from surae.studies.populations import VirtualSubject, stream

#: Settings that may be negative.
_SIGNED = ("axis_forward", "axis_up")
#: Values that a setting must stay below: those that make no sense, or no equation.
_BELOW = {
    "axis_forward": 0.05, "axis_up": 0.05, "crosstalk": 1.0, "knee_motion": 0.5, "unmeasured": 1.0,
}  # fmt: skip


@dataclass(frozen=True, slots=True, kw_only=True)
class Imperfections:
    """How a virtual measurement departs from the ideal; the default is the thesis's, none.

    Sizes are zero by default; the others say of what kind a disturbance is, and have no effect
    where its size is zero.

    Attributes
    ----------
    torque_noise : float
        Standard deviation of the torque's coloured noise [Nm].
    torque_noise_time : float
        Its correlation time T [s]: a first-order autoregressive process, of correlation exp(−τ/T)
        at the lag τ. 0 for white noise.
    crosstalk : float
        Part of the EMG of every other muscle that an electrode picks up, 0…1. Above the leg, 0.03
        to 0.10 of the rectified EMG of a neighbour (De Luca and Merletti 1988, *Electroencephalogr.
        Clin. Neurophysiol.* 69).
    axis_forward, axis_up : float
        Where the ankle's axis lies from that of the device [m]: towards the toes along the sole,
        and away from the sole. The foot then turns by another angle than the plate, see
        `surae.studies.leg.misaligned`. Torques so measured are 5 to 9 % off (Arampatzis et al.
        2007, *J. Biomech.* 40), as by about 10 mm.
    knee_motion : float
        Standard deviation of the knee's unmeasured, slow flexion [rad], which shortens the
        gastrocnemius: see `surae.studies.leg.knee_torque`.
    effort_variation : float
        Coefficient of variation of the effort: what each muscle does is the target times a gain of
        mean 1, log-normal, that wanders within seconds and differs from trial to trial.
    gain_variation : float
        Coefficient of variation of the force that a muscle makes of its EMG: a gain of mean 1,
        log-normal, that wanders within seconds and differs from trial to trial, as by fatigue or
        an electrode that sees a part of the muscle.
    unmeasured : float
        Torque of muscles without electrodes (deep plantarflexors, toe extensors), as a part of that
        of the measured muscles that they help. Their activity follows that of their helpers only
        roughly, see `surae.studies.leg.drive`; it is in the torque and in no EMG.
    reflex_gain : float
        Stretch reflex of the triceps: effort for each l0/s of stretch velocity above
        `reflex_threshold`, `reflex_delay` later [1/(l0/s)]. It drives torque and EMG alike.
    reflex_delay : float
        [s]; 42 ± 3 ms in the soleus (Sinkjær et al. 1996, *J. Neurophysiol.* 76).
    reflex_threshold : float
        [l0/s]; 0.1 l0/s is about 15°/s at the ankle.
    reflex_limit : float
        Largest effort that the reflex reaches.

    Raises
    ------
    InputError
        A value is no finite number, negative or too large.
    """

    torque_noise: float = 0.0
    torque_noise_time: float = 0.1
    crosstalk: float = 0.0
    axis_forward: float = 0.0
    axis_up: float = 0.0
    knee_motion: float = 0.0
    effort_variation: float = 0.0
    gain_variation: float = 0.0
    unmeasured: float = 0.0
    reflex_gain: float = 0.0
    reflex_delay: float = 0.042
    reflex_threshold: float = 0.1
    reflex_limit: float = 0.5

    def __post_init__(self) -> None:
        """Check every value."""
        for setting in fields(self):
            name = setting.name
            untyped: object = getattr(self, name)
            number = isinstance(untyped, Real) and not isinstance(untyped, bool)
            if not number:
                raise InputError(f"imperfections: {name} is {untyped!r}; give a number")
            value = float(getattr(self, name))
            below = _BELOW.get(name, math.inf)
            size = abs(value) if name in _SIGNED else value
            if not (math.isfinite(size) and 0.0 <= size < below):
                low = f"above {-below:g}" if name in _SIGNED else "0 or more"
                high = "" if math.isinf(below) else f" and below {below:g}"
                raise InputError(f"imperfections: {name} is {value:g}; use {low}{high}")

    @property
    def steps(self) -> tuple[str, ...]:
        """One plain sentence for each disturbance that is on."""
        sentences = {
            "effort_variation": f"Effort varies by {100 * self.effort_variation:g} %.",
            "gain_variation": f"Force for the same EMG varies by {100 * self.gain_variation:g} %.",
            "unmeasured": f"Muscles without electrodes: {100 * self.unmeasured:g} % of the "
            "activity of the others, following it roughly.",
            "reflex_gain": f"Stretch reflex of the triceps: {self.reflex_gain:g} of full effort "
            f"per l0/s above {self.reflex_threshold:g} l0/s, {1e3 * self.reflex_delay:g} ms later, "
            f"at most {self.reflex_limit:g}.",
            "axis_forward": f"Ankle axis {1e3 * self.axis_forward:g} mm forward of the device's.",
            "axis_up": f"Ankle axis {1e3 * self.axis_up:g} mm above the device's.",
            "knee_motion": f"Knee flexion of {self.knee_motion:g} rad (standard deviation).",
            "crosstalk": f"Crosstalk of {100 * self.crosstalk:g} % between all muscles.",
            "torque_noise": f"Torque noise of {self.torque_noise:g} Nm, correlated over "
            f"{self.torque_noise_time:g} s.",
        }
        return tuple(text for name, text in sentences.items() if getattr(self, name) != 0.0)


def realistic_imperfections(subject: VirtualSubject) -> Imperfections:
    """Imperfections of a measurement of a subject, the same in all its trials.

    Drawn once for each subject: crosstalk 3 to 10 %; the ankle's axis off by 6 mm in both
    directions (standard deviation, at most 15 mm); torque noise 0.3 to 1 Nm; knee flexion of 0.02
    to 0.06 rad; effort varying by 10 to 30 %; in patients, a reflex of 0.1 to 0.5 of full effort
    per l0/s. The sources are those of `Imperfections`; where it names none, a plausible choice.
    """

    def uniform(name: str, low: float, high: float) -> float:
        return float(stream(subject, f"size of {name}").uniform(low, high))

    def normal(name: str, deviation: float, most: float) -> float:
        drawn = deviation * float(stream(subject, f"size of {name}").standard_normal())
        return min(max(drawn, -most), most)

    return Imperfections(
        torque_noise=uniform("torque_noise", 0.3, 1.0),
        crosstalk=uniform("crosstalk", 0.03, 0.10),
        axis_forward=normal("axis_forward", 0.006, 0.015),
        axis_up=normal("axis_up", 0.006, 0.015),
        knee_motion=uniform("knee_motion", 0.02, 0.06),
        effort_variation=uniform("effort_variation", 0.1, 0.3),
        reflex_gain=uniform("reflex_gain", 0.1, 0.5) if subject.population == "patient" else 0.0,
    )
