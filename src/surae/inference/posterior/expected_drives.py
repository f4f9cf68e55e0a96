"""What is expected of the drives behind envelopes whose noise is known.

Noise of a regressor pulls estimates, muscles seem slower. What is expected of the drive errs
without regard to itself (Berkson), and pulls nowhere (Carroll et al. 2006, chapter 4). It is the
mean: the likeliest drive makes bursts too short, which passes for a slow release and a curve.
"""

from dataclasses import replace

import numpy as np

from surae.base.frozen import read_only
from surae.base.units import FloatArray
from surae.inference.posterior.drive_chain import forward
from surae.signals import ModelInputs

#: Levels of a drive as parts of its greatest, and their distance on the logarithm [1/s, samples].
_LEAST = 1e-3
_MOST = 2.0
_APART = 3.84
#: Levels that it climbs a sample; how often that changes [1/s], half of the time to none; how far
#: it wanders beside [1/√s]. Of virtual legs' efforts.
_SLOPES = (0, 1, -1, 2, -2, 4, -4, 8, -8)
_TURNS = 3.2
_WANDER = 0.25
#: Samples that are looked at together, and those beside them.
_BLOCK = 1024
_BESIDE = 128


def expected_drives(inputs: ModelInputs) -> ModelInputs:
    """The inputs with what is expected of the drives; the same where no noise is known."""
    if not inputs.rectified:
        return inputs
    emg = inputs.emg.copy()
    for column, density in enumerate(inputs.rectified):
        if density > 0.0 and np.percentile(emg[:, column], 99.9) > 0.0:
            emg[:, column] = _expected(emg[:, column], density * inputs.rate_hz, inputs.rate_hz)
    return replace(inputs, emg=read_only(emg))


def _expected(envelope: FloatArray, relative: float, rate_hz: float) -> FloatArray:
    """The mean of the drive behind an envelope with multiplicative noise of this relative variance.

    The envelope has a Gamma distribution about the drive, whose logarithm goes straight and turns
    now and then, and wanders a little (Sanger 2007, J. Neurophysiol. 97:1839, has jumps instead).
    """
    top = float(np.percentile(envelope, 99.9))
    apart = _APART / rate_hz
    levels = np.arange(np.log(_LEAST), np.log(_MOST), apart)
    seen = np.maximum(envelope / top, _LEAST)[:, None]
    fits = -(seen * np.exp(-levels) + levels) / relative
    fits = np.exp(fits - fits.max(axis=1, keepdims=True))
    slopes = np.array(_SLOPES)
    moves = -np.expm1(-_TURNS / rate_hz), min(0.5 * _WANDER**2 / rate_hz / apart**2, 0.25)
    drive = np.empty(len(envelope))
    for begin in range(0, len(envelope), _BLOCK):
        first = max(begin - _BESIDE, 0)
        likely = fits[first : begin + _BLOCK + _BESIDE]
        share = np.zeros_like(likely)
        forwards = np.empty((len(likely), len(slopes), len(levels)))
        forward(likely, slopes, *moves, forwards, share[:0])
        forward(likely[::-1].copy(), -slopes, *moves, forwards, share)
        each = share @ np.exp(levels) / share.sum(axis=1)
        drive[begin : begin + _BLOCK] = each[begin - first :][:_BLOCK]
    return top * drive
