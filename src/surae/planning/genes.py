"""From the numbers that a search moves to a plan that a device and a subject can follow.

Every vector is a plan: what must be above or below something is squashed into it, holds and rests
share the time that is left, speeds rise until the ramps fit the trial, and efforts are lowered to
the budget. So the search has no constraint to violate but the torque of the legs.
"""

from dataclasses import dataclass

import numpy as np

from surae.base.errors import InputError
from surae.base.units import FloatArray
from surae.planning.plan import Limits, Plan, Shake
from surae.protocol import DIRECTIONS, TASKS
from surae.protocol.effort import GAP, Burst, head_share, task_bursts
from surae.protocol.profiles import BLEND, Ramp

#: Still and relaxed at both ends of a trial [s].
REST = 0.5
#: Bursts of effort are no shorter and no longer [s].
SHORTEST = 0.5
LONGEST = 2.5
#: Seconds of a trial for each ramp, burst and perturbation that a plan may have.
_PER_RAMP = 2.6
_PER_BURST = 1.7
_PER_SHAKE = 5.0
#: Smallest speed [rad/s], and ranges of a perturbation: amplitude [rad], length [s], Hz.
_SLOWEST = 0.05
_AMPLITUDES = (0.002, 0.25)
_LENGTHS = (1.0, 12.0)
_SLOWEST_HZ = 0.2
_FASTEST_HZ = 8.0
#: Where ramps go at first, as parts of the range.
_TARGETS = (1.0, 0.0, 0.5, 0.8, 0.3, 1.0, 0.65, 0.1, 0.9, 0.4, 0.7, 0.0)


def effort_budget(seconds: float) -> tuple[float, float]:
    """Effort times time [s] by direction: for each second as much as *part-passive* asks for."""
    spent = _spent(tuple(task_bursts(TASKS["part-passive"], 35.0)))
    return spent[0] * seconds / 35.0, spent[1] * seconds / 35.0


def _spent(bursts: tuple[Burst, ...]) -> tuple[float, float]:
    """Effort times time of bursts by direction [s], heads averaged; a burst's mean is half."""
    spent = [0.0, 0.0]
    for k, burst in enumerate(bursts):
        heads = len(DIRECTIONS[burst.direction])
        share = sum(head_share(k, i)[0] for i in range(heads)) / heads
        spent[burst.direction] += 0.5 * burst.level * burst.length * share
    return spent[0], spent[1]


@dataclass(frozen=True, slots=True)
class Genes:
    """How a vector of numbers is read as a plan."""

    name: str  #: What the plans are called.
    seconds: float  #: Duration [s].
    limits: Limits  #: Of the movement.
    highest_hz: float  #: Highest frequency of the device [Hz].
    effort: bool  #: Whether the subject is asked for any.

    def __post_init__(self) -> None:
        """Refuse what leaves no time to move."""
        if self.seconds - 2.0 * REST < 4.0 * (self.blend + 0.5):
            raise InputError(
                f"{self.seconds:g} s are too short for this device, which needs {self.blend:.2g} s "
                "to start and to stop; design a longer trial"
            )

    @property
    def blend(self) -> float:
        """Time in which a ramp gains its speed [s]: what acceleration and bandwidth allow."""
        jerky = 1.875 * self.limits.velocity / self.limits.acceleration
        return float(max(BLEND, jerky, 1.0 / self.highest_hz))

    @property
    def counts(self) -> tuple[int, int, int]:
        """How many ramps, bursts and perturbations."""
        moving = self.seconds - 2.0 * REST
        ramps = max(int(min(moving / _PER_RAMP, 0.4 * moving / self.blend)), 2)
        bursts = max(int(moving / _PER_BURST), 2) if self.effort else 0
        return ramps, bursts, max(round(moving / _PER_SHAKE), 1)

    @property
    def size(self) -> int:
        """How many numbers a plan is made of."""
        return sum(_sizes(self.counts))

    def start(self) -> FloatArray:
        """Where a search begins: holds reached at various speeds, relaxed at first."""
        ramps, bursts, shakes = self.counts
        targets = np.resize(np.array(_TARGETS), ramps)
        rows = [
            np.array([-3.0, 0.0]),
            np.clip(_unsquash(targets), -3.0, 3.0),
            np.resize(np.array([1.0, 0.0, 0.5, -0.5, 0.8]), ramps),
            np.zeros(ramps),
        ]
        if bursts:
            rows += [
                np.array([np.log(0.45 * bursts)]),
                np.full(bursts, 0.0),
                np.full(bursts, -0.8),
                np.full(bursts, 0.5),
            ]
        rows += [
            _unsquash((np.arange(shakes) + 0.5) / shakes),
            np.zeros(shakes),
            np.zeros(shakes),
            np.zeros(shakes),
            np.full(shakes, 0.5),
        ]
        return np.concatenate(rows)

    def carried(self, genes: FloatArray, counts: tuple[int, int, int]) -> FloatArray:
        """Genes of so many ramps, bursts and perturbations as a start here: repeated or cut off."""
        old = _split(genes, counts)
        sizes = _sizes(self.counts)
        shakes = self.counts[2]
        if len(sizes) != len(old):
            return self.start()
        blocks_here = [np.resize(block, size) for block, size in zip(old, sizes, strict=True)]
        times = shakes / len(old[-5])
        if times > 1.0:  # each repetition of the perturbations has its own part of the trial
            turn = np.arange(shakes) // len(old[-5])
            blocks_here[-5] = _unsquash(np.minimum((_squash(blocks_here[-5]) + turn) / times, 1.0))
        return np.concatenate(blocks_here)

    def plan(self, genes: FloatArray) -> Plan:
        """The plan of a vector of `size` numbers."""
        blocks = _split(np.clip(genes, -30.0, 30.0), self.counts)
        (origin, first), targets, speeds, holds, *efforts = blocks[:-5]
        begin = float(_squash(origin))
        return Plan(
            self.name,
            self.seconds,
            begin,
            self.blend,
            ramps=self._ramps(begin, float(first), targets, speeds, holds),
            shakes=self._shakes(*blocks[-5:]),
            bursts=self._bursts(float(efforts[0][0]), *efforts[1:]) if efforts else (),
        )

    def _ramps(
        self,
        origin: float,
        first: float,
        targets: FloatArray,
        speeds: FloatArray,
        holds: FloatArray,
    ) -> tuple[Ramp, ...]:
        span = self.limits.high - self.limits.low
        fastest = self.limits.velocity / span
        to = _squash(targets)
        free = self.seconds - 2.0 * REST - len(to) * self.blend
        distance = np.abs(np.diff(to, prepend=origin))
        least = float(distance.sum()) / fastest
        if least > 0.9 * free:  # a slow device: all goes less far
            to = origin + (to - origin) * 0.9 * free / least
            distance = np.abs(np.diff(to, prepend=origin))
        slowest = min(_SLOWEST / span, 0.5 * fastest)
        speed = slowest * (fastest / slowest) ** _squash(speeds)
        low = 1.0
        high = fastest / slowest
        if float((distance / speed).sum()) > free:
            for _ in range(30):
                middle = (low * high) ** 0.5
                fits = float((distance / np.minimum(middle * speed, fastest)).sum()) <= free
                low, high = (low, middle) if fits else (middle, high)
            speed = np.minimum(high * speed, fastest)
        moving = distance / speed
        waits = np.exp(np.clip(np.append(first, holds), -6.0, 6.0))
        waits *= max(free - float(moving.sum()), 0.0) / float(waits.sum())
        at = REST
        ramps = []
        for k in range(len(to)):
            at += float(waits[k])
            ramps.append(Ramp(at, float(to[k]), float(speed[k])))
            at += float(moving[k]) + self.blend
        return tuple(ramps)

    def _bursts(
        self, first: float, gaps: FloatArray, lengths: FloatArray, levels: FloatArray
    ) -> tuple[Burst, ...]:
        count = len(gaps)
        free = self.seconds - 2.0 * REST - 2.0 * GAP * count
        length = SHORTEST + (LONGEST - SHORTEST) * _squash(lengths)
        extra = float(length.sum()) - count * SHORTEST
        room = free - count * SHORTEST
        if extra > room:
            length = SHORTEST + (length - SHORTEST) * max(room, 0.0) / extra
        waits = np.exp(np.clip(np.append(first, gaps), -6.0, 6.0))
        waits *= max(free - float(length.sum()), 0.0) / (float(waits.sum()) + 1.0)
        level = _squash(levels)
        at = REST
        bursts = []
        for k in range(count):
            at += float(waits[k])
            bursts.append(Burst(at, float(length[k]), float(level[k]), k % 2))
            at += float(length[k]) + 2.0 * GAP
        spent = _spent(tuple(bursts))
        allowed = effort_budget(self.seconds)
        part = [min(1.0, a / s) if s > 0.0 else 1.0 for s, a in zip(spent, allowed, strict=True)]
        return tuple(b._replace(level=b.level * part[b.direction]) for b in bursts)

    def _shakes(
        self,
        places: FloatArray,
        lengths: FloatArray,
        sizes: FloatArray,
        lows: FloatArray,
        highs: FloatArray,
    ) -> tuple[Shake, ...]:
        moving = self.seconds - 2.0 * REST
        longest = min(_LENGTHS[1], moving)
        length = _between(lengths, (min(_LENGTHS[0], longest), longest))
        fastest = min(_FASTEST_HZ, self.highest_hz)
        bounds = (min(_SLOWEST_HZ, 0.5 * fastest), fastest)
        return tuple(
            Shake(
                REST + float(place) * (moving - float(long)),
                float(long),
                float(size),
                float(low),
                float(high),
            )
            for place, long, size, low, high in zip(
                _squash(places),
                length,
                _between(sizes, _AMPLITUDES),
                _between(lows, bounds),
                _between(highs, bounds),
                strict=True,
            )
        )


def _sizes(counts: tuple[int, int, int]) -> list[int]:
    """How many numbers each kind of gene has, with so many ramps, bursts and perturbations."""
    ramps, bursts, shakes = counts
    return [2, *3 * [ramps], *([1, *3 * [bursts]] if bursts else []), *5 * [shakes]]


def _split(genes: FloatArray, counts: tuple[int, int, int]) -> list[FloatArray]:
    return np.split(np.asarray(genes), np.cumsum(_sizes(counts))[:-1])


def _squash(x: FloatArray) -> FloatArray:
    """Bring any number to 0…1; ends are reached."""
    return np.clip(1.06 / (1.0 + np.exp(-x)) - 0.03, 0.0, 1.0)


def _unsquash(u: FloatArray) -> FloatArray:
    """What `_squash` makes `u` of."""
    inner = np.clip((u + 0.03) / 1.06, 1e-3, 1.0 - 1e-3)
    return np.asarray(np.log(inner / (1.0 - inner)))


def _between(x: FloatArray, bounds: tuple[float, float]) -> FloatArray:
    """Bring any number to a geometric place between two bounds."""
    low, high = bounds
    return np.asarray(low * (high / low) ** _squash(x))
