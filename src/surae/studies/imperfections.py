"""What a real measurement has and the thesis's simulated one does not: all off by default."""

import math
from collections.abc import Callable
from dataclasses import dataclass

import numpy as np

from surae.base.setting import Request, documented, setting, settings_of
from surae.base.units import FloatArray
from surae.protocol.profiles import smooth_step
from surae.recording import MUSCLES
from surae.signals import Preparation
from surae.studies.populations import VirtualSubject, stream

#: Log-normal factors of mean 1 of a trial: of which disturbance, their coefficient of variation and
#: how many columns.
Gains = Callable[[str, float, int], FloatArray]


@documented
@dataclass(frozen=True, slots=True, kw_only=True)
class Imperfections(Request):
    """How a virtual measurement departs from the ideal; the default is the thesis's, none.

    Sizes are zero by default; the others say of what kind a disturbance is, and have no effect
    where its size is zero.

    Attributes
    ----------
    {settings}

    Raises
    ------
    InputError
        A value is no finite number, negative or too large.
    """

    torque_noise: float = setting(
        0.0,
        "Standard deviation of the torque's coloured noise [Nm].",
        least=0.0,
    )
    torque_noise_time: float = setting(
        0.1,
        "Its correlation time T [s]: a first-order autoregressive process, of correlation "
        "exp(−τ/T) at the lag τ. 0 for white noise.",
        least=0.0,
    )
    crosstalk: float = setting(
        0.0,
        "Part of the EMG of every other muscle that an electrode picks up, 0…1. Above the "
        "leg, 0.03 to 0.10 of the rectified EMG of a neighbour (De Luca and Merletti 1988, "
        "*Electroencephalogr. Clin. Neurophysiol.* 69).",
        least=0.0,
        most=0.99,
    )
    axis_forward: float = setting(
        0.0,
        "How far the ankle's axis lies from that of the device towards the toes, along the "
        "sole [m]. The foot then turns by another angle than the plate, see "
        "`surae.studies.leg.misaligned`. Torques so measured are 5 to 9 % off (Arampatzis et al. "
        "2007, *J. Biomech.* 40), as by about 10 mm.",
        least=-0.05,
        most=0.05,
    )
    axis_up: float = setting(
        0.0,
        "And how far away from the sole [m].",
        least=-0.05,
        most=0.05,
    )
    knee_motion: float = setting(
        0.0,
        "Standard deviation of the knee's unmeasured, slow flexion [rad], which shortens "
        "the gastrocnemius: see `surae.studies.leg.knee_torque`.",
        least=0.0,
        most=0.5,
    )
    effort_variation: float = setting(
        0.0,
        "Coefficient of variation of the effort: what each muscle does is the target times "
        "a gain of mean 1, log-normal, that wanders within seconds and differs from trial to "
        "trial.",
        least=0.0,
    )
    reflex_gain: float = setting(
        0.0,
        "Stretch reflex of the triceps: effort for each l0/s of stretch velocity above "
        "a threshold, 42 ms later (`surae.studies.leg.reflex`) [1/(l0/s)]. It drives torque and "
        "EMG alike.",
        least=0.0,
    )

    @property
    def steps(self) -> tuple[str, ...]:
        """One plain sentence for each disturbance that is on."""
        units = {
            "torque_noise": " Nm",
            "axis_forward": " m",
            "axis_up": " m",
            "knee_motion": " rad",
            "reflex_gain": " of full effort per l0/s",
        }
        sizes = (each for each, _ in settings_of(type(self)) if each.default == 0.0)
        return tuple(
            f"{each.name.replace('_', ' ').capitalize()}: {size:g}{units.get(each.name, '')}."
            for each in sizes
            if (size := getattr(self, each.name)) != 0.0
        )

    def drive(self, envelopes: FloatArray, gains: Gains) -> FloatArray:
        """What drives the torque, shape (n, 4) [V]: the envelopes, unless a subclass has more."""
        del gains
        return envelopes


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


#: Band of surface EMG [Hz].
EMG_BAND = (20.0, 450.0)
#: Slowest sampling of raw EMG [Hz].
EMG_LOWEST_RATE = 1000.0


def coloured_noise(
    n: int, rate_hz: float, deviation: float, time: float, rng: np.random.Generator
) -> FloatArray:
    """First-order noise, stationary, of correlation exp(−τ/`time`) at the lag τ; 0 for white."""
    from scipy.signal import lfilter

    memory = math.exp(-1.0 / (rate_hz * time)) if time > 0.0 else 0.0
    drive = rng.standard_normal(n)
    drive[1:] *= math.sqrt(1.0 - memory**2)
    return np.asarray(deviation * lfilter([1.0], [1.0, -memory], drive))


def wandering(t: FloatArray, period: float, columns: int, rng: np.random.Generator) -> FloatArray:
    """Slow noise of mean 0 and variance 1 that does not depend on the sampling rate.

    Independent normal numbers every `period` [s] in each column, joined by minimum-jerk steps and
    scaled so that the variance is 1 in between too. A longer trial begins as a shorter one.
    """
    knots = rng.standard_normal((int(t[-1] / period) + 2, columns))
    before = np.minimum((t / period).astype(int), len(knots) - 2)
    share = smooth_step(t / period - before)[:, None]
    joined = (1.0 - share) * knots[before] + share * knots[before + 1]
    return np.asarray(joined / np.hypot(1.0 - share, share))


def mixing(crosstalk: float) -> FloatArray:
    """What electrodes (rows) pick up of muscles (columns): all of their own, part of others."""
    n = len(MUSCLES)
    return np.full((n, n), crosstalk) + (1.0 - crosstalk) * np.eye(n)


def mixed_envelopes(envelopes: FloatArray, crosstalk: float) -> FloatArray:
    """Envelopes behind electrodes with crosstalk: uncorrelated signals add up in squares."""
    return envelopes if crosstalk == 0.0 else np.sqrt(envelopes**2 @ (mixing(crosstalk) ** 2).T)


def raw_emg(envelopes: FloatArray, rate_hz: float, rng: np.random.Generator) -> FloatArray:
    """Raw EMG of which the default preparation makes these envelopes, on average.

    Gaussian noise with a flat spectrum in `EMG_BAND`, modulated. Rectified Gaussian noise of the
    standard deviation σ has the mean √(2/π)·σ = 0.798·σ, and the preparation's high-pass leaves
    `passed` = 0.973 of σ at 2048 Hz: so σ = √(π/2)/0.973 = 1.289 times the envelope.

    The envelopes are expected rectified EMG after the high-pass [V]; the rate is at least
    `EMG_LOWEST_RATE`.
    """
    n = len(envelopes)
    spectrum = np.fft.rfft(rng.standard_normal(envelopes.shape), axis=0)
    frequency = np.fft.rfftfreq(n, 1.0 / rate_hz)
    inside = (frequency >= EMG_BAND[0]) & (frequency <= EMG_BAND[1])
    spectrum[~inside] = 0.0
    # What is left has the variance 2·(bins inside)/n.
    unit = np.fft.irfft(spectrum, n, axis=0) * math.sqrt(n / (2 * np.count_nonzero(inside)))
    return np.asarray(envelopes * unit * (math.sqrt(math.pi / 2) / passed(rate_hz)))


def passed(rate_hz: float, settings: Preparation | None = None) -> float:
    """Root-mean-square gain of a preparation's EMG high-pass, by default ours, for `raw_emg`."""
    settings = settings or Preparation()
    if settings.emg_highpass_hz is None:
        return 1.0
    frequency = np.linspace(*EMG_BAND, 4001)
    ratio = math.tan(math.pi * settings.emg_highpass_hz / rate_hz) / np.tan(
        np.pi * frequency / rate_hz
    )
    # Both passes together, 3 dB at the cut-off.
    gain = 1.0 / (1.0 + (math.sqrt(2.0) - 1.0) * ratio ** (2 * settings.emg_highpass_order))
    return math.sqrt(float((gain**2).mean()))
