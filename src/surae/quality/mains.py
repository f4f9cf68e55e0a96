"""Mains hum, a line in the EMG's spectrum at 50 or 60 Hz; and electrodes that hear nothing else."""

from collections.abc import Iterator

import numpy as np

from surae.base.units import FloatArray
from surae.quality.electrodes import RELAXED, RMS
from surae.quality.finding import Finding, Unjudged, make_finding, quantity
from surae.quality.numeric import runs, span_of
from surae.quality.trial import CheckedTrial
from surae.recording import Channel

#: Frequencies of mains [Hz].
MAINS = (50.0, 60.0)
#: Their multiples that are looked for: what is bent has twice and thrice the frequency, and a notch
#: at the mains leaves them.
_MULTIPLES = (1, 2, 3)
#: How far from them the line may lie [Hz], so many times for a multiple: a grid holds 0.2 Hz.
_NEAR = 0.25
#: Neighbourhood that the line is compared with [Hz].
_AROUND = 6.0
#: Power of the line over the median of its neighbourhood. Of noise, the largest of some 20
#: exponentially distributed values is above 30 medians once in 5e7.
LINE = 30.0
#: Amplitude of the hum as a part of the EMG's root mean square, or of that of efforts in other
#: trials of the leg, below which it does no harm.
SMALLEST = 0.02


def hum(trial: CheckedTrial) -> Iterator[Finding]:
    """Channels with mains hum."""
    slow = None
    heard = False
    for muscle, channel in trial.varying.items():
        if channel.rate_hz < 2.2 * MAINS[-1]:
            slow = channel.rate_hz
            continue
        amplitude, frequency = line(channel)
        # Bursts raise the root mean square but not the harm done at rest.
        rms = max(float(np.std(channel.values)), RMS * trial.electrodes.levels[muscle].top)
        if amplitude < SMALLEST * rms or amplitude == 0.0:
            continue
        heard = True
        yield make_finding(
            "mains-hum",
            channel.role,
            span_of(channel.time),
            amplitude,
            severity="warning" if amplitude < rms else "error",
            unit=channel.unit,
            muscle=trial.names[muscle],
            hz=frequency,
            size=quantity(amplitude, channel),
            part=amplitude / rms,
        )
    if slow is not None and not heard:
        raise Unjudged(f"EMG at {slow:g} Hz cannot show {MAINS[-1]:g} Hz.")


def line(channel: Channel) -> tuple[float, float]:
    """Amplitude and frequency [Hz] of the loudest line of the mains; amplitude 0 without."""
    values: FloatArray = channel.values - float(channel.values.mean())
    n = len(values)
    rate = channel.rate_hz
    loudest = (0.0, MAINS[0])
    if n < 2.0 * rate:
        return loudest
    # Only the bands around the lines are needed: mixing down and averaging is quicker than a long
    # transform of awkward length.
    block = max(1, int(rate / (4.0 * _AROUND)))
    whole = n // block * block
    values *= np.hanning(n)
    waves = [(k * mains, k * _NEAR) for k in _MULTIPLES for mains in MAINS]
    for wave, reach in (each for each in waves if rate >= 2.2 * each[0]):
        turn = -2j * np.pi * wave / rate
        within, begun = (np.exp(turn * np.arange(0, *upto)) for upto in ((block,), (whole, block)))
        blocks = values[:whole].reshape(-1, block)
        mixed = (blocks @ within.real + 1j * (blocks @ within.imag)) * begun
        power = np.abs(np.fft.fft(mixed)) ** 2
        frequency = np.fft.fftfreq(len(mixed), block / rate)
        near = np.abs(frequency) <= reach
        around = np.abs(frequency) <= _AROUND
        usual = float(np.median(power[around & (np.abs(frequency) > 2.0 * reach)]))
        peak = int(np.argmax(np.where(near, power, -1.0)))
        if power[peak] > LINE * usual:
            amplitude = 2.0 * float(np.sqrt(power[peak])) / (0.5 * (n - 1))
            loudest = max(loudest, (amplitude, wave + float(frequency[peak])))
    return loudest


#: Length of the pieces that are compared [s]: whole periods of both mains.
_PIECE = 0.5
#: Shortest time without contact [s].
_SHORTEST = 2.0
#: Part of a piece's power that the mains has where there is no muscle.
_SHARE = 0.5
#: The mains is so many times what it is in the rest of the trial: hum alone does not change.
_TIMES = 3.0


def off(trial: CheckedTrial) -> Iterator[Finding]:
    """Channels that hear nothing but the mains from some instant to the end, and did not before."""
    fast = [c for c in trial.emg.values() if c.rate_hz > 2.2 * MAINS[-1]]
    if trial.emg_kind != "raw" or not fast:
        raise Unjudged("Only raw EMG shows an electrode that hears the mains alone.")
    for channel in fast:
        size = round(_PIECE * channel.rate_hz)
        count = len(channel.values) // size
        if count * _PIECE < 2.0 * _SHORTEST:
            continue
        pieces = channel.values[: count * size].reshape(count, size)
        pieces = pieces - pieces.mean(axis=1, keepdims=True)
        power = np.mean(pieces**2, axis=1)
        waves = np.exp(-2j * np.pi * np.outer(np.arange(size) / channel.rate_hz, MAINS))
        hums = 2.0 * np.abs(pieces @ waves) / size  # amplitude of each line in each piece
        mains = int(np.argmax(hums.sum(axis=0)))
        hum = hums[:, mains]
        alone = 0.5 * hum**2 > _SHARE * np.maximum(power, np.finfo(float).tiny)
        first, last = max(runs(alone), key=lambda run: run[1] - run[0], default=(0, 0))
        heard = (last - first) * _PIECE >= _SHORTEST and (count - last) * _PIECE < _SHORTEST
        if not first or not heard:
            continue  # one that hears its muscle again has not come off
        now = float(np.median(hum[first:last]))
        rest = np.delete(hum, slice(first, last))
        known = trial.electrodes.levels.get(channel.role.removeprefix("emg_"))
        harmless = 0.0 if known is None else RELAXED * known.top
        if now >= max(_TIMES * float(np.median(rest)), harmless):
            start, end = channel.time[[first * size, min(last * size, len(channel.time) - 1)]]
            yield make_finding(
                "electrode-off",
                channel.role,
                (start, end),
                now,
                unit=channel.unit,
                start=start,
                muscle=trial.names[channel.role.removeprefix("emg_")],
                size=quantity(now, channel),
                hz=MAINS[mains],
            )
