"""What a sample brings, filtered without looking ahead: angle and its derivatives, EMG, effort."""

from typing import Any

from surae.base.units import FloatArray
from surae.model.jit import inner

#: Records of `surae.causal.layout`, as numba passes them.
Record = Any


@inner
def follow_angle(n: Record, s: Record, angle: float) -> None:
    """Angle, speed and acceleration, by what is measured beyond what they let expect."""
    if s.count == 0:
        s.angle = angle
        s.velocity = 0.0
        s.acceleration = 0.0
        return
    dt = n.dt
    expected = s.angle + dt * (s.velocity + 0.5 * dt * s.acceleration)
    moving = s.velocity + dt * s.acceleration
    beyond = angle - expected
    gains = n.angle_gains
    s.angle = expected + gains[0] * beyond
    s.velocity = moving + gains[1] * beyond
    s.acceleration = s.acceleration + gains[2] * beyond


@inner
def _section(row: FloatArray, z: FloatArray, x: float) -> float:
    """One second-order section, transposed direct form II."""
    y: float = row[0] * x + z[0]
    z[0] = row[1] * x - row[4] * y + z[1]
    z[1] = row[2] * x - row[5] * y
    return y


@inner
def follow_emg(n: Record, s: Record, emg: FloatArray) -> None:
    """Envelopes of the electrodes, effort, and how fast both change."""
    for c in range(4):
        x = emg[c] * n.emg_scale[c]
        if n.raw:
            for k in range(n.highs):
                x = _section(n.high[k], s.high[c, k], x)
            x = abs(x)
            for k in range(n.lows):
                x = _section(n.low[k], s.low[c, k], x)
            x = max(x, 0.0)
        smooth = s.smooth[c]
        if s.count == 0:
            for k in range(3):
                smooth[k] = x
            s.envelope[c] = x
            s.envelope_rate[c] = 0.0
            s.smooth_rate[c] = 0.0
            continue
        before = smooth[2]
        into = x
        for k in range(3):
            smooth[k] += n.effort_gain * (into - smooth[k])
            into = smooth[k]
        s.smooth_rate[c] = (smooth[2] - before) / n.dt
        s.envelope_rate[c] = (x - s.envelope[c]) / n.dt
        s.envelope[c] = x
