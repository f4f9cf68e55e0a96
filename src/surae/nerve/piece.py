"""A piece of a recording without gaps, as the fit sees it: spectra and bins that forget drift."""

from functools import lru_cache

import numpy as np
from scipy import fft

from surae.base.units import ComplexArray, FloatArray
from surae.nerve.cascade import stretched, stretched_slope

#: Highest frequency that is fitted [Hz]: reflexes end by 15 Hz, inertia is known by 40.
TOP = 45.0
#: Lowest [Hz]: below it the torque drifts with the effort.
LOWEST = 0.15
#: Lowest frequency of which shares of the torque are given [Hz]: below it the effort wanders.
SLOW = 0.5
#: Ends that the reflex's and the tissue's memory spoil [s]: filters run around the ends.
BEGIN = 0.4
END = 0.15
#: Multiple of the usual change between samples from which torque jumps: 8 standard deviations.
JUMP = 12.0
#: Samples by which its time is unknown: half of one, and a fifth more since its slope jumps too.
UNTIMED = 0.6
#: Part of the length over which the bins are tapered at each end.
_TAPER = 0.02


def _roll(f: FloatArray, last: float, none: float) -> FloatArray:
    """Low-pass: 1 up to `last`, 0 from `none` on, half a cosine between them."""
    inside = np.clip((f - last) / (none - last), 0.0, 1.0)
    rolled: FloatArray = 0.5 + 0.5 * np.cos(np.pi * inside)
    return rolled


class Piece:
    """Angle and torque of n samples at one rate, and what is computed of them.

    Everything is computed as spectra, low-passed and sampled at `rate`, and judged in `bins`: first
    differences, by which drift becomes white, tapered, and of those frequencies that are fitted.
    """

    def __init__(
        self,
        time: FloatArray,
        angle: FloatArray,
        torque: FloatArray,
        rate_hz: float,
        band: float,
        *,
        anchor: float,
        span: tuple[float, float],
    ) -> None:
        """Angle [rad] about `anchor`; `span` are first and last time of the whole recording."""
        n = len(angle)
        while fft.next_fast_len(n, real=True) != n or n % 2:
            n -= 1
        time = time[:n]
        angle = angle[:n] - anchor
        torque = torque[:n]
        f = fft.rfftfreq(n, 1.0 / rate_hz)
        cut = 4.0 / 3.0 * band
        self.n, self.full_rate, self.time0 = n, rate_hz, float(time[0])
        self.m = min(
            fft.next_fast_len(int(np.ceil(2.2 * cut * n / rate_hz)) // 2, real=True) * 2, n
        )
        self.rate = self.m * rate_hz / n
        half = self.m // 2 + 1
        self.s = 2j * np.pi * f[:half]
        self._pass = _roll(f[:half], band, cut) * (self.m / n)
        spectrum = fft.rfft(angle)
        smooth = _roll(f, min(100.0, 0.3 * rate_hz), min(150.0, 0.45 * rate_hz))
        s = 2j * np.pi * f
        self.moved, self.velocity, self.acceleration = (
            np.asarray(fft.irfft(s**k * smooth * spectrum, n)) for k in range(3)
        )
        middle = 0.5 * (span[0] + span[1])
        length = max(span[1] - span[0], 1e-9)
        self.angle: ComplexArray = spectrum[:half] * self._pass
        self.squared = self.spectrum(angle**2)
        self.drifting = self.spectrum(angle * 2.0 * (time - middle) / length)
        self.torque = self.spectrum(torque - torque.mean())
        self.jumps = self._jumps(torque)
        whole = fft.rfft(torque) * (f >= SLOW)
        #: Variance of the torque [Nm²] at all frequencies but those below `SLOW`.
        inside = slice(round(BEGIN * rate_hz), n - round(END * rate_hz))
        self.variance = float(np.var(fft.irfft(whole, n)[inside]))
        first = round(BEGIN * self.rate)
        kept = self.m - round(END * self.rate) - first
        while fft.next_fast_len(kept - 1, real=True) != kept - 1:
            kept -= 1
        self.keep = slice(first, first + kept)
        self.length = kept - 1
        self.times: FloatArray = time[0] + (np.arange(self.m)[self.keep][:-1] + 0.5) / self.rate
        edge = max(4, round(_TAPER * kept))
        window = np.ones(self.length)
        window[:edge] = 0.5 - 0.5 * np.cos(np.pi * np.arange(edge) / edge)
        window[-edge:] = window[:edge][::-1]
        self._window = window * self.rate / np.sqrt(self.rate * np.sum(window**2))
        frequencies = fft.rfftfreq(self.length, 1.0 / self.rate)
        self.used = (frequencies >= max(LOWEST, 2.5 * self.rate / kept)) & (frequencies <= band)
        self.f: FloatArray = frequencies[self.used]
        self.stretched = lru_cache(24)(self._stretched)

    def spectrum(self, signal: FloatArray) -> ComplexArray:
        """Of a signal at the full rate, low-passed as all are."""
        spectrum: ComplexArray = fft.rfft(signal)[: len(self.s)] * self._pass
        return spectrum

    def _jumps(self, torque: FloatArray) -> ComplexArray:
        """Spectrum of the torque's jumps times what is unknown of when they are.

        A torque that jumps between two samples, as inertia's does where the device begins to move
        at once and no filter stands before the sampling, is known in time to half a sample.
        """
        change = np.diff(torque, prepend=torque[0])
        size = np.abs(change)
        jumps = np.zeros(len(change))
        before = np.maximum(np.roll(size, 2), np.roll(size, 3))
        top = (size >= np.roll(size, 1)) & (size > np.roll(size, -1))
        at = top & (size > JUMP * np.median(size)) & (size > 3.0 * before)
        near = np.abs(change + np.roll(change, 1) + np.roll(change, -1))
        jumps[at] = UNTIMED * np.sign(change[at]) * np.maximum(size, near)[at]
        return self.spectrum(jumps)

    def _stretched(
        self, direction: int, threshold: float, beside: tuple[float, float] = (0.0, 0.0)
    ) -> tuple[ComplexArray, ComplexArray]:
        """Spectra of what the reflex answers, and of its slope over the threshold.

        It is the velocity, and `beside` by so much length [1/s] and acceleration [s].
        """
        answered = self.velocity + beside[0] * self.moved + beside[1] * self.acceleration
        return tuple(
            self.spectrum(of(answered, direction, threshold)) for of in (stretched, stretched_slope)
        )  # type: ignore[return-value]

    def signals(self, spectra: ComplexArray) -> FloatArray:
        """Signals in time without the ends; (k, half) → (k, kept + 1)."""
        return np.asarray(fft.irfft(spectra, self.m)[..., self.keep])

    def bins(self, spectra: ComplexArray) -> ComplexArray:
        """What is fitted: (k, half) → (k, bins); power is that of the differences by s and Hz."""
        differences = np.diff(self.signals(spectra)) * self._window
        return np.asarray(fft.rfft(differences)[..., self.used])

    def in_time(self, bins: ComplexArray) -> FloatArray:
        """Series in time with the given bins, (k, bins) → (k, kept); Σ over time is Σ over bins."""
        every = np.zeros((*bins.shape[:-1], self.length // 2 + 1), complex)
        every[..., self.used] = bins
        return np.asarray(fft.irfft(every, self.length) * np.sqrt(self.length / 2.0))
