"""The motion that a device was to follow: from a file, or recognised in the angle itself.

A trial that follows one of the protocols of `surae.protocol` is ``low + gain·profile(t − delay)
+ A·sin(πst²)``, filtered if it was adapted to a device. Only s and the filter are non-linear; s
shows as a line in the spectrum over u = t²/2, in which the chirp is a sine.
"""

from dataclasses import dataclass
from functools import cache

import numpy as np

from surae.base.frozen import Comparable, read_only
from surae.base.units import FloatArray
from surae.protocol import PROFILES
from surae.protocol.adaptation import low_pass, spectrum_of
from surae.quality.numeric import BoolArray, quantile
from surae.recording import Channel

#: Samples [Hz] on which a profile is recognised.
_RATE = 85.0
#: Residual of a recognised profile, root mean square over the span. Of virtual trials, the right
#: profile has 1e-6 to 0.01, with overshoots or steps up to 0.06; a wrong one more than 0.12.
_RECOGNISED = 0.08
#: Without a filter, this is already the right profile.
_EXACT = 1e-3
#: Where a residual is beyond this, the next best profile must leave so many times more: of excerpts
#: of another motion two profiles leave about as much.
_DOUBTFUL = 0.02
_APART = 1.5
#: In a shorter trial [s] any profile fits.
_SHORTEST = 15.0
#: This close, no other profile and no other chirp is tried.
_CLOSE = 4e-3
#: Of so many samples, one says which profiles are worth a closer look.
_SCREEN = 8
#: Steps of the axis on which the cut-off of a filter is searched.
_COARSE = 1024
#: A chirp whose part of the remaining variance is smaller is none.
_CHIRP_SHARE = 0.05
#: Samples of the axis on which its line is looked for, enough for 3 Hz/s in a minute, and the part
#: of the distance of two lines to which it is found.
_CHIRP_SAMPLES = 8192
_CHIRP_LINE = 0.005
#: Chirps rise faster than this [Hz/s]; what is slower is a misfit of the profile.
_SLOWEST = 0.08


@dataclass(frozen=True, slots=True, eq=False)
class Commanded(Comparable):
    """A commanded motion, arrays read-only."""

    name: str  #: Where it comes from, for messages.
    time: FloatArray  #: [s], shape (n,).
    angle: FloatArray  #: [rad], shape (n,).
    #: The requested effort, 0…1, if the file says, shape (n, 4).
    effort: FloatArray | None = None
    given: bool = True  #: Whether a file gave it; otherwise it was recognised in the angle.


def recognised(channel: Channel) -> Commanded | None:
    """The known protocol that an angle follows, in any unit and on any zero; or None."""
    step = max(1, round(channel.rate_hz / _RATE))
    seconds = channel.time[::step] - channel.time[0]
    angle = channel.values[::step]
    span = float(np.ptp(angle))
    if len(angle) < 200 or float(seconds[-1]) < _SHORTEST or span == 0.0:
        return None
    candidates = []
    few = slice(None, None, _SCREEN)
    for profile in PROFILES.values():
        stretches = {1.0} if seconds[-1] < profile.duration + 0.5 else set()
        if abs(seconds[-1] - profile.duration) > 0.5:
            stretches.add(profile.duration / float(channel.time[-1] - channel.time[0]))
        for stretch in stretches:
            base = np.interp(seconds[few] * stretch, *_shape(profile.name))
            if float(np.ptp(base)) > 0.1:
                residual = _trimmed_fit(angle[few], _columns(base, seconds[few]))[0]
                candidates.append((float(np.std(residual)), profile.name, stretch))
    candidates.sort(key=lambda candidate: candidate[0])
    tried: list[tuple[float, str, FloatArray]] = []
    for _, name, stretch in candidates[:2]:
        base = PROFILES[name].position(seconds * stretch)
        spread, fitted = _with_chirp(angle, base, seconds)
        tried.append((spread, name, fitted))
        if spread < _CLOSE * span:
            break
    if not tried:
        return None
    best = min(tried, key=lambda each: each[0])
    beside = min((spread for spread, name, _ in tried if name != best[1]), default=np.inf)
    clear = best[0] < _DOUBTFUL * span or beside > _APART * best[0]
    if best[0] > _RECOGNISED * span or not clear:
        return None
    time = read_only(channel.time[::step])
    return Commanded(f"the {best[1]} profile", time, read_only(best[2]), given=False)


@cache
def _shape(name: str) -> tuple[FloatArray, FloatArray]:
    """A profile at a few times [s], for a first comparison."""
    time = np.linspace(0.0, PROFILES[name].duration, _COARSE)
    return read_only(time), read_only(PROFILES[name].position(time))


def _with_chirp(
    angle: FloatArray, base: FloatArray, seconds: FloatArray
) -> tuple[float, FloatArray]:
    """Spread of what a profile, its chirp and its filter leave of an angle, and their fit."""
    span = float(np.ptp(angle))
    residual, fitted = _trimmed_fit(angle, _columns(base, seconds))
    chirp = _chirp(residual, seconds)
    if chirp is not None:
        residual, fitted = _trimmed_fit(angle, [*_columns(base, seconds), chirp])
    best = _spread(residual), fitted
    if best[0] < _EXACT * span:
        return best
    filtered = _filtered(angle, base, chirp, seconds)
    best = min(best, filtered, key=lambda tried: tried[0])
    if best[0] < _CLOSE * span:
        return best
    # What the filter did to the profile may have hidden the chirp.
    alone = filtered if chirp is None else _filtered(angle, base, None, seconds)
    hidden = _chirp(angle - alone[1], seconds)
    if hidden is not None:
        both = _filtered(angle, base, hidden, seconds)
        best = min(best, both, key=lambda tried: tried[0])
    return best


def _filtered(
    angle: FloatArray, base: FloatArray, chirp: FloatArray | None, seconds: FloatArray
) -> tuple[float, FloatArray]:
    """Spread and fit for a motion adapted to a device: one low-pass for profile and chirp.

    The cut-off is searched on a coarser axis whose length suits the transform.
    """
    grid = np.linspace(0.0, float(seconds[-1]), _COARSE + 1)
    rate = _COARSE / float(seconds[-1])
    coarse = np.interp(grid, seconds, angle)
    moving = [base] if chirp is None else [base, chirp]
    spectra = [spectrum_of(np.interp(grid, seconds, wave)) for wave in moving]
    frequency = np.arange(_COARSE + 1) * (rate / (2 * _COARSE))

    def spread(log_cutoff: float) -> float:
        gain = 1.0 / np.sqrt(1.0 + (frequency / np.exp(log_cutoff)) ** 2)
        waves = [np.fft.irfft(gain * spectrum, 2 * _COARSE)[: _COARSE + 1] for spectrum in spectra]
        columns = [*_columns(waves[0], grid), *waves[1:]]
        return _spread(coarse - _solved(np.column_stack(columns), coarse))

    logs = np.log(np.geomspace(0.03, 12.0, 11))
    least, best = min((spread(x), x) for x in logs.tolist())
    width = float(logs[1] - logs[0])
    for _ in range(7):
        width /= 2.0
        least, best = min((least, best), *((spread(x), x) for x in (best - width, best + width)))
    exact = (len(seconds) - 1) / float(seconds[-1])
    passed = [low_pass(spectrum_of(wave), float(np.exp(best)), exact)[0] for wave in moving]
    residual, fitted = _trimmed_fit(angle, [*_columns(passed[0], seconds), *passed[1:]])
    return _spread(residual), fitted


def _columns(base: FloatArray, seconds: FloatArray) -> list[FloatArray]:
    """Offset, profile, and its slope, which stands for a delay of the device."""
    return [np.ones_like(base), base, np.gradient(base, seconds)]


def _trimmed_fit(angle: FloatArray, columns: list[FloatArray]) -> tuple[FloatArray, FloatArray]:
    """Residual and fit of a least-squares fit that leaves out the worst tenth of the samples."""
    matrix = np.column_stack(columns)
    kept = np.ones(len(angle), dtype=bool)
    residual = angle
    fitted = np.zeros_like(angle)
    for _ in range(2):
        fitted = _solved(matrix, angle, kept)
        residual = angle - fitted
        kept = np.abs(residual) <= quantile(np.abs(residual), 0.9)
    return residual, fitted


def _solved(
    matrix: FloatArray, angle: FloatArray, kept: BoolArray | slice = slice(None)
) -> FloatArray:
    """The combination of the columns that is closest to the angle in the samples `kept`."""
    part = matrix[kept]
    gram = part.T @ part
    scale = np.sqrt(np.diag(gram))
    scale[scale == 0.0] = 1.0
    weights = np.linalg.lstsq(gram / np.outer(scale, scale), part.T @ angle[kept] / scale, None)[0]
    return np.asarray(matrix @ (weights / scale))


def _spread(residual: FloatArray) -> float:
    return float(np.sqrt(np.mean(residual**2)))


def _chirp(residual: FloatArray, seconds: FloatArray) -> FloatArray | None:
    """The chirp sin(πst²) of unit amplitude that a residual holds, or None."""
    u = np.linspace(0.0, 0.5 * float(seconds[-1]) ** 2, _CHIRP_SAMPLES)
    # A filtered chirp falls as 1/t; times t it is a sine again, if not a whole one.
    at = np.sqrt(2.0 * u)
    even = np.interp(at, seconds, residual) * at
    spectrum = np.abs(np.fft.rfft(even, 2 * len(even)))
    resolution = 1.0 / (2 * len(even) * float(u[1]))
    lowest = int(np.ceil(_SLOWEST / resolution))
    if lowest >= len(spectrum):  # so long that even the slowest chirp would leave the axis
        return None
    top = int(np.argmax(spectrum[lowest:])) + lowest
    if 2.0 * float(spectrum[top] ** 2) < _CHIRP_SHARE * float(even @ even) * len(even) * 0.5:
        return None
    # Between the lines of the spectrum, finer and finer.
    phase = np.pi * resolution * seconds**2
    weighted = residual * seconds
    width = 0.5

    def alike(line: float) -> float:
        return abs(float(np.sin(line * phase) @ weighted))

    best = max(np.linspace(top - 1.0, top + 1.0, 5).tolist(), key=alike)
    while width > _CHIRP_LINE:
        width /= 2.0
        best = max((best - width, best, best + width), key=alike)
    return np.asarray(np.sin(best * phase))
