"""What excites the muscles at a sample, and their active states, as `surae.model.excitation`."""

import math

from surae.base.units import FloatArray
from surae.causal.signals import Record
from surae.model.activation import curved_over_effort
from surae.model.compliant import advanced
from surae.model.crosstalk import SILENT
from surae.model.jit import inner


@inner
def _kept(n: Record, s: Record, c: int) -> float:
    """Part of an electrode's envelope that is its own muscle's, where powers add up."""
    power = s.smooth[c, 2] ** 2 + 1e-300
    power_of_muscle = 0.0
    for k in range(4):
        power_of_muscle += n.inverse[c, k] * (s.smooth[k, 2] ** 2 + 1e-300)
    part = power_of_muscle / power
    size = part * part + SILENT**2
    kept: float = part * math.sqrt(math.sqrt((1.0 + SILENT**2) / size))
    return kept


@inner
def _heard(n: Record, s: Record, c: int) -> tuple[float, float]:
    """What an electrode hears beyond its rest, and as smooth as effort is."""
    envelope = s.envelope[c] + n.lag * s.envelope_rate[c] - n.rest[c]
    return envelope, s.smooth[c, 2] + n.lag * s.smooth_rate[c] - n.rest[c]


@inner
def own_envelopes(n: Record, s: Record) -> None:
    """Envelopes of the muscles themselves."""
    for c in range(4):
        envelope, smooth = _heard(n, s, c)
        if n.unmix == 2:
            part = _kept(n, s, c)
            envelope *= part
            smooth *= part
        elif n.unmix == 1:
            envelope = smooth = 0.0
            for k in range(4):
                other, other_smooth = _heard(n, s, k)
                envelope += n.inverse[c, k] * other
                smooth += n.inverse[c, k] * other_smooth
        if n.curved:
            envelope = curved_over_effort(envelope, smooth, n.reference[c], n.shape, n.power)
        s.own[c] = envelope + n.release * 0.5 * abs(s.smooth_rate[c])


@inner
def stretch_drive(n: Record, group: int, length: float, speed: float) -> float:
    """What a reflex answers to speed, to length beyond slack and to the tissue's force."""
    gains = n.reflexes[group]
    drive = 0.0
    if gains[0] != 0.0:
        drive += gains[0] * max(speed, 0.0)
    beyond = length - n.groups[group, 1]
    if gains[1] != 0.0:
        drive += gains[1] * max(beyond, 0.0)
    if gains[2] != 0.0:
        drive += gains[2] * math.exp(n.groups[group, 0] * beyond)
    return drive


@inner
def hold(n: Record, s: Record, active: FloatArray) -> None:
    """What drives that stay at their first sample make of each N: the step response."""
    v, w = s.held[0], s.held[1]
    if s.count == 0:
        active[0] = active[1] = 0.0
        return
    for stage in range(2):
        active[stage] = advanced(n.held[stage], v, w, 1.0, 1.0)
    s.held[0] = advanced(n.whole[0], v, w, 1.0, 1.0)
    s.held[1] = advanced(n.whole[1], v, w, 1.0, 1.0)


@inner
def respond(
    n: Record, s: Record, where: tuple[int, int], x: float, late: FloatArray, held: FloatArray
) -> None:
    """Add what a group's drive, `where`, makes of its active state at both stages.

    `late` remembers the drive, `held` is the response to what was there at first.
    """
    group, drive = where
    first = s.first[group]
    count = s.count
    if count == 0:
        first[drive] = x if n.late[drive] else 0.0
    size = len(late)
    late[count % size] = x - first[drive]
    for stage in range(2):
        s.active[stage] += first[drive] * held[stage]
        at = count - n.back[drive, stage] - 1
        if at < 0:
            continue
        before = late[at % size]
        now = late[(at + 1) % size]
        z = s.filter[group, drive, stage]
        v, w = z[0], z[1]
        s.active[stage] += advanced(n.part[drive, stage], v, w, before, now)
        z[0] = advanced(n.whole[0], v, w, before, now)
        z[1] = advanced(n.whole[1], v, w, before, now)
