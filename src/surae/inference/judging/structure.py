"""What a residual has of angle, velocity and activation, which belongs to the leg."""

from collections.abc import Iterator, Sequence

import numpy as np

from surae.base.units import FloatArray
from surae.inference.judging.reasons import Reason, against
from surae.signals import ModelInputs

#: Part of the torque's variance [%] that a structured residual may have, and from which on it is
#: too much; and from which part of the residual on it is called structured.
_LEFT_OUT = 0.5
_TOO_MUCH = 5.0
_STRUCTURED = 0.3
#: Below this cut-off [Hz] EMG is taken for what the muscle makes of it.
_ACTIVATION_HZ = 2.0


def structured(
    inputs: Sequence[ModelInputs], residuals: Sequence[FloatArray], r2: float
) -> Iterator[Reason]:
    """What angle, velocity and activation explain of the residual belongs to the leg."""
    share = structure(inputs, residuals)
    left_out = share * (100.0 - r2)
    if share >= _STRUCTURED and left_out >= _LEFT_OUT:
        grave = left_out > _TOO_MUCH
        yield against("left-out", grave=grave, share=100.0 * share, left_out=left_out)


def structure(inputs: Sequence[ModelInputs], residuals: Sequence[FloatArray]) -> float:
    """Part of the residual's variance that angle, velocity and activation explain, 0 … 1.

    A linear regression in each recording on the angle to its third power, on velocity and its size
    and sign, and on each muscle's activation and its product with the angle; lessened by what as
    many regressors explain of noise that is as correlated as the residual [Nm].
    """
    explained = total = 0.0
    for recording, residual in zip(inputs, residuals, strict=True):
        mask = recording.counts
        e = residual[mask] - residual[mask].mean()
        sse = float(e @ e)
        if not np.isfinite(sse) or sse <= 0.0:
            continue
        features = _features(recording)[mask]
        features -= features.mean(axis=0)
        norms = np.linalg.norm(features, axis=0)
        features = features[:, norms > 0] / norms[norms > 0]
        u, s, _ = np.linalg.svd(features, full_matrices=False)
        basis = u[:, s > 1e-6 * s[0]] if len(s) else u
        lag1 = float(np.clip((e[1:] @ e[:-1]) / sse, 0.0, 0.999))
        independent = len(e) * (1.0 - lag1) / (1.0 + lag1)
        k = basis.shape[1]
        if independent > k + 2:
            share = float(np.sum((basis.T @ e) ** 2)) / sse
            share = 1.0 - (1.0 - share) * (independent - 1.0) / (independent - k - 1.0)
            explained += max(share, 0.0) * sse
        total += sse
    return explained / total if total > 0.0 else 0.0


def _features(recording: ModelInputs) -> FloatArray:
    """What a residual should not follow, shape (n, k)."""
    from scipy.signal import butter, sosfiltfilt

    angle = recording.angle - recording.angle.mean()
    speed = recording.velocity
    top = max(float(np.abs(speed).max()), 1e-12)
    columns = [angle, angle**2, angle**3, speed, np.abs(speed), np.tanh(10.0 * speed / top)]
    active = recording.emg
    if recording.rate_hz > 2.5 * _ACTIVATION_HZ and recording.n > 20:
        sos = butter(2, _ACTIVATION_HZ, fs=recording.rate_hz, output="sos")
        active = sosfiltfilt(sos, active, axis=0)
    for channel in active.T:
        columns += [channel, channel * angle]
    return np.stack(columns, axis=1)
