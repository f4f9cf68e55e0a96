"""Torque that EMG drives: envelopes, their noise, and laws from EMG to torque."""

import math
from collections.abc import Iterator, Sequence
from typing import NamedTuple

import numpy as np
from scipy.signal import butter, hilbert, lfilter, sosfiltfilt, sosfreqz

from surae.base.units import FloatArray
from surae.nerve.ramps import RATE, SMOOTH, Stretched, at_rate, low

#: Natural frequencies of critically damped muscles [rad/s] (calves: 8 to 25, slow with spasticity).
OMEGAS = (5.0, 6.3, 8.0, 10.0, 12.5, 15.5, 19.0, 24.0, 30.0, 40.0, 60.0)
#: Torque over EMG: (exp(A·u) − 1)/(exp(A) − 1); 0: in proportion. Lloyd and Besier (2003) have −3
#: to 0; −6 is a power of 0.6; above 0 where large EMG was cut off.
BENDS = (-6.0, -3.0, -1.5, 0.0, 2.0)
#: Samples by which torque is later than EMG: 0 to 60 ms (Cavanagh and Komi 1979).
LAGS = (0, 1, 3, 6)
#: Band in which an envelope's noise is seen [Hz]: faster than a muscle is called up, slower than
#: what smooths an envelope; and time over which its size is taken [s].
NOISY = (9.0, 15.0)
AVERAGED = 0.25
#: Quantiles of an envelope that are its rest and its largest; |u| beyond which no law bends more.
REST = 0.3
LARGEST = 0.9995
TOP = 1.5


class Law(NamedTuple):
    """How EMG becomes torque."""

    bend: float
    omega: float
    lag: int


class Envelopes:
    """Envelopes of the muscles that all recordings have, at `RATE`."""

    def __init__(self, every: Sequence[Stretched]) -> None:
        self.muscles = sorted(set.intersection(*({*of.emg} for of in every)))
        # smoothed as torque is: corners of the movement would else be left
        self.heard = [
            [at_rate(of, low(of.emg[m], of.rate, SMOOTH)) for m in self.muscles] for of in every
        ]
        self.lengths = [len(at_rate(of, of.time)) for of in every]
        joined = [np.concatenate([h[j] for h in self.heard]) for j in range(len(self.muscles))]
        self.joined = joined
        self.rest = [float(np.quantile(h, REST)) for h in joined]
        self.span = [
            float(np.quantile(h, LARGEST)) - r + 1e-30
            for h, r in zip(joined, self.rest, strict=True)
        ]
        self.noise = [noise_power(every, m) for m in self.muscles]

    def laws(self) -> Iterator[Law]:
        """Those that compete; one where no EMG is there."""
        if not self.muscles:
            yield Law(0.0, OMEGAS[0], 0)
            return
        yield from (Law(b, o, n) for b in BENDS for o in OMEGAS for n in LAGS)

    def bent(self, bend: float) -> list[list[FloatArray]]:
        """What calls muscles up, by recording and muscle, by a law."""
        return [
            [
                _bent((h - r) / s, bend)
                for h, r, s in zip(envelopes, self.rest, self.span, strict=True)
            ]
            for envelopes in self.heard
        ]

    def noisy(self, law: Law) -> FloatArray:
        """Variance that an envelope's noise has behind a law and its muscle, by muscle.

        That of a critically damped muscle passes ω/8 Hz of it.
        """
        return (
            np.array(
                [
                    n
                    / (np.mean(h**2) + 1e-100)
                    * np.mean((_slope((h - r) / s, law.bend) * h / s) ** 2)
                    for n, h, r, s in zip(
                        self.noise, self.joined, self.rest, self.span, strict=True
                    )
                ]
            )
            * law.omega
            / 8.0
        )

    def unseen(self, law: Law) -> FloatArray:
        """What activity as small as the EMG's scatter at rest would call up, by muscle."""
        return np.array(
            [
                float(_bent(np.std(h[h <= np.median(h)]) / s, law.bend))
                for h, s in zip(self.joined, self.span, strict=True)
            ]
        )


def driven(called: Sequence[FloatArray], law: Law, n: int) -> FloatArray:
    """Torque of muscles that are called up so, per unit, (n, muscles)."""
    keep = math.exp(-law.omega / RATE)
    b = [1.0 - keep]
    a = [1.0, -keep]
    out = np.zeros((n, len(called)))
    for j, each in enumerate(called):
        out[law.lag :, j] = lfilter(b, a, lfilter(b, a, each))[: n - law.lag]
    return out


def noise_power(every: Sequence[Stretched], muscle: str) -> float:
    """Power of an envelope's noise [1/Hz], its mean over all recordings.

    EMG is noise that a muscle's activity modulates: its envelope has noise in proportion to itself,
    of one power at all frequencies below the smoother's. Where activity begins or ends something
    else is in the band: the median is taken, which of a narrow band's power is ln 2 of the mean.
    """
    ratios = list[FloatArray]()
    squares = list[FloatArray]()
    for of in every:
        sections = butter(2, NOISY, "bandpass", fs=of.rate, output="sos")
        f, gain = sosfreqz(sections, 4096, fs=of.rate)
        width = float(np.sum(np.abs(gain) ** 4) * (f[1] - f[0]))
        noise = 0.5 * np.abs(hilbert(sosfiltfilt(sections, of.emg[muscle]))) ** 2 / width
        size = low(of.emg[muscle], of.rate, 1.0 / AVERAGED) ** 2
        ratios.append(noise / (size + 1e-100))
        squares.append(size)
    usual = float(np.median(np.concatenate(ratios))) / math.log(2.0)
    return usual * float(np.mean(np.concatenate(squares)))


def _bent(u: FloatArray, bend: float) -> FloatArray:
    if bend == 0.0:
        return u
    return np.asarray(np.expm1(bend * np.clip(u, -TOP, TOP)) / math.expm1(bend))


def _slope(u: FloatArray, bend: float) -> FloatArray:
    if bend == 0.0:
        return np.ones_like(u)
    return np.asarray(bend * np.exp(bend * np.clip(u, -TOP, TOP)) / math.expm1(bend))
