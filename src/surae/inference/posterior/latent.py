"""What differs from moment to moment in one recording: slow gains, drift, and what no model has.

    T = T_model(z, E·exp(Σ c_g·hat)) + Σ c_d·hat + Σ c_m·hat(angle, velocity)·T_active
        + Σ c_s·exp(−travel/settles)·T_tissue

The gain of each electrode wanders within a trial, as skin and gel warm and muscles tire; so does
the torque's zero; and what a model cannot express of a muscle's force is a smooth function of its
length and velocity times that force. Tissue that has rested is stiffer for its first stretches
(thixotropy): parameters are of tissue as it stays. All are Gaussian, of sizes that the data tell
(`surae.inference.posterior.log_posterior`).
"""

from collections.abc import Mapping
from dataclasses import dataclass

import numpy as np
from scipy.linalg import block_diag, solveh_banded

from surae.base.units import FloatArray
from surae.inference.posterior.banded import lifted
from surae.inference.posterior.film import FilmView, hats, slices_of, views
from surae.model.activation import IntArray
from surae.recording import MUSCLES
from surae.signals import ModelInputs, smooth_effort

#: Correlation time and distance of the hats [s]: of an electrode's gain, and of the torque's zero.
GAIN_S = 6.0
GAIN_STEP_S = 3.0
DRIFT_S = 8.0
DRIFT_STEP_S = 4.0
#: Most hats over time of one kind: those of long recordings lie farther apart.
MOST = 40
MOST_FAST = 3000
#: Hats over angle and over velocity of what the model cannot express, each group its own.
ANGLES = 5
VELOCITIES = 3
#: Time [s] for which a change of the drive is followed.
TAIL_S = 1.5
SOURCES = ("gain", "drift", "misfit", "softening")
#: Travel after which a softening has fallen to a third, in parts of the range that is moved; set
#: while four virtual legs that soften were looked at.
SETTLES = (0.5, 1.5, 4.5)


@dataclass(frozen=True, slots=True)
class Latents:
    """The latent values of one recording, and their correlation."""

    #: `gain`, `drift`: hats over time, shape (k, n); `misfit`: over angle and velocity, (15, n).
    gain: FloatArray
    drift: FloatArray
    misfit: FloatArray
    softening: FloatArray  #: What is left of it after each sample's travel, shape (k, n).
    muscles: tuple[int, ...]  #: Channels whose gain wanders.
    #: By source: where its values are, and the inverse of their correlation.
    slices: Mapping[str, slice]
    inverses: Mapping[str, FloatArray]
    fast: "Fast"
    films: tuple[FilmView, ...] = ()

    @classmethod
    def of(
        cls, recording: ModelInputs, silent: frozenset[str], seconds: float, *, perfect: bool
    ) -> "Latents":
        """The latents of a recording that lasts so long before it is thinned.

        Muscles that are silent, and all of a `perfect` laboratory, have no gain.
        """
        muscles = tuple(
            i
            for i, m in enumerate(MUSCLES)
            if m not in silent and m not in recording.missing_emg and not perfect
        )
        gain, at_gain = _hats_over_time(recording, seconds, GAIN_STEP_S)
        drift, at_drift = _hats_over_time(recording, seconds, DRIFT_STEP_S)
        misfit = _hats_over_movement(recording)
        softening = _left_to_soften(recording)
        sizes = (len(muscles) * len(gain), len(drift), 2 * len(misfit), 2 * len(softening))
        ends = np.cumsum(sizes)
        slices = {
            source: slice(int(end - size), int(end))
            for source, size, end in zip(SOURCES, sizes, ends, strict=True)
        }
        of_gain = np.kron(np.eye(len(muscles)), _inverse_correlation(at_gain, GAIN_S))
        inverses: dict[str, FloatArray] = {
            "gain": of_gain.astype(float),
            "drift": _inverse_correlation(at_drift, DRIFT_S),
            "misfit": np.eye(sizes[2]),
            "softening": np.eye(sizes[3]),
        }
        films = views(recording)
        seen = slices_of(films, int(ends[-1]))
        if films:
            slices["film"] = slice(seen[0].start, seen[-1].stop)
            inverses["film"] = block_diag(*(film.inverse for film in films))
        fast = Fast.of(recording, muscles)
        return cls(gain, drift, misfit, softening, muscles, slices, inverses, fast, films)

    def of_parts(self, active: FloatArray, tissue: FloatArray) -> FloatArray:
        """What each value of misfit and softening adds, of the groups' torques [Nm], (36, n)."""
        of_tissue = [self.softening * part for part in tissue]
        return np.concatenate([*(self.misfit * part for part in active), *of_tissue])

    @property
    def of_model(self) -> slice:
        """Where the values of misfit and softening are."""
        return slice(self.slices["misfit"].start, self.slices["softening"].stop)

    def own_of_films(self) -> tuple[slice, ...]:
        """Where the latent values of each film are."""
        return slices_of(self.films, self.slices[SOURCES[-1]].stop)

    @property
    def size(self) -> int:
        """Number of latent values."""
        return max(int(at.stop) for at in self.slices.values())

    def log_gain(self, c: FloatArray) -> FloatArray:
        """Logarithmic gain of the four muscles over time, shape (4, n)."""
        gains = np.zeros((len(MUSCLES), self.gain.shape[1]))
        by_muscle = c[self.slices["gain"]].reshape(len(self.muscles), len(self.gain))
        for row, muscle in zip(by_muscle, self.muscles, strict=True):
            gains[muscle] = row @ self.gain
        return gains

    def precision(self, sizes: Mapping[str, float]) -> FloatArray:
        """Inverse of the values' covariance, shape (m, m), for these standard deviations."""
        whole = np.zeros((self.size, self.size))
        for source, at in self.slices.items():
            whole[at, at] = self.inverses[source] / sizes.get(source, 1.0) ** 2
        return whole


#: Distance of the hats of the drive's fast error [s], its correlation time, and the drive's own.
FAST_STEP_S = 0.05
FAST_S = 0.11
DRIVE_S = 0.6
#: Band [Hz] in which an envelope is taken for noise, at most these parts of the sampling rate, and
#: the time [s] over which its size is averaged; samples below which nothing is said of it.
_NOISE_HZ = (10.0, 40.0)
_NOISE_PART = (0.1, 0.35)
_AVERAGED_S = 0.25
_FEWEST = 30
#: Inverse covariance of hats whose sum is white noise up to 0.4 of their rate, on and beside the
#: diagonal: hats that have nothing in common are half as strong at 0.3 of it (fitted to sinc⁴).
_WHITE = 0.645, 0.185
#: RecordingBlock of a muscle's effort below which its logarithm is not taken further.
_QUIET = 0.02


@dataclass(frozen=True, slots=True)
class Fast:
    """Errors of the muscles' drives at the muscles' own frequencies, as logarithmic gains.

    log E = s + w, where s is the drive and w the envelope's error, both Ornstein–Uhlenbeck: given
    the envelope the drive's gain exp(−w) has the precision K_w⁻¹ + K_s⁻¹ and a mean. Noise that is
    seen in the envelope itself adds to it. All is interleaved: time first, then muscle.
    """

    first: IntArray  #: First sample of each hat, shape (k,).
    shapes: FloatArray  #: The hats, shape (k, width).
    step: float  #: Distance of the hats [s].
    log_effort: FloatArray  #: Logarithm of each muscle's envelope at the hats, shape (m, k).
    noise: FloatArray  #: Its standard error there by what noise is seen, shape (m, k).
    n: int
    known: bool = False  #: Whether that noise is white, and known beforehand.

    @classmethod
    def of(cls, recording: ModelInputs, muscles: tuple[int, ...]) -> "Fast":
        """The hats of a recording."""
        rate = recording.rate_hz
        n = recording.n
        count = min(max(3, round(n / rate / FAST_STEP_S) + 1), MOST_FAST)
        knots = np.linspace(0.0, (n - 1) / rate, count)
        step = knots[1] - knots[0]
        first = np.maximum(np.ceil((knots - step) * rate - 1e-9).astype(np.int64), 0)
        width = int(np.ceil(2 * step * rate)) + 1
        time = (first[:, None] + np.arange(width)) / rate
        shapes = np.maximum(1.0 - np.abs(time - knots[:, None]) / step, 0.0)
        effort = np.maximum(smooth_effort(recording.emg.T, rate)[list(muscles)], 0.0)
        at = np.minimum((knots * rate).round().astype(int), n - 1)
        top = np.percentile(effort, 99.0, axis=1, keepdims=True) + 1e-300
        level = np.maximum(effort[:, at], _QUIET * top)
        known = bool(recording.rectified)
        if known:  # and the same part of an envelope whatever its size
            density = np.array(recording.rectified)[list(muscles), None]
            noise = np.sqrt(density / step) * np.ones_like(level)
        else:
            white = emg_noise(recording).T[list(muscles)][:, at]
            noise = white / np.sqrt(max(step * rate, 1.0)) / level
        return cls(first, shapes, step, np.log(level), np.clip(noise, 1e-3, 0.5), n, known)

    def precision(self, size: float) -> tuple[FloatArray, FloatArray]:
        """Inverse covariance of the gains, lower band (m + 1, k·m), and their mean (k·m,).

        `size` is the standard deviation of the error at the muscles' frequencies; 0 for none.
        """
        m, k = self.log_effort.shape
        band = np.zeros((m + 1, k * m))
        mean = np.zeros((m, k))
        for i in range(m):
            if not size:
                alone, beside = _WHITE if self.known else (1.0, 0.0)
                band[0, i::m] = alone / self.noise[i] ** 2
                band[m, i : (k - 1) * m : m] = beside / (self.noise[i, 1:] * self.noise[i, :-1])
                continue
            deviation = np.sqrt(size**2 + self.noise[i] ** 2)
            error = _ornstein(k, self.step / FAST_S)
            error = np.stack(
                [
                    error[0] / deviation**2,
                    np.append(error[1][:-1] / (deviation[1:] * deviation[:-1]), 0),
                ]
            )
            spread = float(np.var(self.log_effort[i]))
            drive = _ornstein(k, self.step / DRIVE_S) / max(spread - size**2, 0.25 * spread, 1e-4)
            both = error + drive
            away = self.log_effort[i] - self.log_effort[i].mean()
            pull = drive[0] * away
            pull[1:] += drive[1][:-1] * away[:-1]
            pull[:-1] += drive[1][:-1] * away[1:]
            mean[i] = -solveh_banded(both, pull, lower=True)
            band[0, i::m], band[m, i::m] = both[0], both[1]
        return band, mean.T.ravel()

    def log_gain(self, w: FloatArray, muscles: tuple[int, ...]) -> FloatArray:
        """Logarithmic gain of the four muscles over time, shape (4, n)."""
        gains = np.zeros((len(MUSCLES), self.n))
        by_muscle = np.zeros((self.n, len(muscles)))
        lifted(self.shapes, self.first, w.reshape(len(self.first), -1), by_muscle)
        gains[list(muscles)] = by_muscle.T
        return gains


def _ornstein(k: int, step: float) -> FloatArray:
    """Inverse correlation of a stationary Ornstein–Uhlenbeck process, lower band (2, k)."""
    r = np.exp(-step)
    band = np.zeros((2, k))
    band[0], band[1, :-1] = (1 + r * r) / (1 - r * r), -r / (1 - r * r)
    band[0, 0] = band[0, -1] = 1.0 / (1 - r * r)
    return band


def _hats_over_time(
    recording: ModelInputs, seconds: float, step: float
) -> tuple[FloatArray, FloatArray]:
    """Hat functions over the recording, shape (k, n), and where they peak [s]."""
    knots = np.linspace(0.0, seconds, min(max(2, round(seconds / step) + 1), MOST))
    return hats(np.arange(recording.n) / recording.rate_hz, knots), knots


def _hats_over_movement(recording: ModelInputs) -> FloatArray:
    """Hat functions of angle times such of velocity, shape (15, n)."""
    angle = recording.angle
    speed = np.asarray(recording.velocity)
    low, high = np.percentile(angle, [1.0, 99.0])
    fast = max(float(np.percentile(np.abs(speed), 98.0)), 1e-6)
    over_angle = np.linspace(low, max(high, low + 1e-6), ANGLES)
    over_speed = np.linspace(-1.0, 1.0, VELOCITIES)
    by_speed = hats(np.tanh(speed / fast), over_speed)
    return np.stack([a * v for a in hats(angle, over_angle) for v in by_speed])


def _left_to_soften(recording: ModelInputs) -> FloatArray:
    """What the travel before each sample leaves of a softening, shape (k, n)."""
    angle = recording.angle
    span = max(float(np.ptp(np.percentile(angle, [1.0, 99.0]))), 1e-6)
    travel = np.append(0.0, np.cumsum(np.abs(np.diff(angle)))) / span
    return np.asarray(np.exp(-travel / np.array(SETTLES)[:, None]))


def _inverse_correlation(at: FloatArray, time: float) -> FloatArray:
    """Inverse of the correlation of a Matérn process (3/2) at these times [s]."""
    apart = np.sqrt(3.0) * np.abs(at[:, None] - at) / time
    correlation = (1.0 + apart) * np.exp(-apart) + 1e-6 * np.eye(len(at))
    return np.asarray(np.linalg.inv(correlation))


def emg_noise(recording: ModelInputs) -> FloatArray:
    """Standard deviation of white noise as strong as that of the envelopes, shape (n, 4)."""
    from scipy.ndimage import uniform_filter1d
    from scipy.signal import butter, sosfiltfilt, sosfreqz

    if recording.n < _FEWEST:
        return np.zeros_like(recording.emg)
    rate = recording.rate_hz
    band = [min(hz, part * rate) for hz, part in zip(_NOISE_HZ, _NOISE_PART, strict=True)]
    sos = butter(2, band, btype="bandpass", fs=rate, output="sos")
    passed = np.abs(sosfreqz(sos, 2048)[1]) ** 4  # of both passes, on power
    fast = sosfiltfilt(sos, recording.emg, axis=0)
    size = max(3, int(_AVERAGED_S * rate))
    power = uniform_filter1d(fast**2, size, axis=0, mode="nearest") / passed.mean()
    return np.asarray(np.sqrt(np.maximum(power, 0.0)))  # a running sum may end below zero
