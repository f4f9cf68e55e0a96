"""A protocol of the thesis as something that can be held to a device's torque, like a plan."""

import math
from dataclasses import dataclass, replace
from functools import lru_cache

from surae.frozen import read_only
from surae.planning.limits import Limits
from surae.protocol import Protocol, Trajectory, generate
from surae.protocol.effort import Burst, burst_effort, named_task, task_bursts
from surae.units import FloatArray

#: One movement with its efforts lowered again and again is adapted to its device once.
_moved = lru_cache(maxsize=2)(generate)
#: Samples to each period of a chirp's last and fastest turn, at least.
_PER_PERIOD = 4.0


@dataclass(frozen=True, slots=True)
class ProfilePlan:
    """A protocol of the thesis, whose range and efforts can be given up."""

    settings: Protocol  #: What it is.
    bursts: tuple[Burst, ...]  #: What is asked of the subject.

    @classmethod
    def of(cls, settings: Protocol) -> "ProfilePlan":
        """A protocol with all that its task asks for."""
        end = generate(settings).time[-1]
        return cls(settings, tuple(task_bursts(named_task(settings.task), float(end))))

    def eased(self, part: float) -> "ProfilePlan":
        """The same with all effort times `part`."""
        return replace(self, bursts=tuple(b._replace(level=part * b.level) for b in self.bursts))

    def trajectory(self, limits: Limits, rate_hz: float) -> Trajectory:
        """The protocol over a range, at a multiple of a rate at which its chirp can be sampled."""
        settings = self.settings
        fastest = _PER_PERIOD * settings.chirp_rate * settings.seconds
        times = max(math.ceil(fastest / rate_hz), 1) if settings.chirp_amplitude > 0.0 else 1
        made = _moved(replace(settings, range_of_motion=limits[:2], rate_hz=times * rate_hz))
        return replace(made, effort=self.effort(made.time))

    def effort(self, time: FloatArray) -> FloatArray:
        """What is asked of the subject at increasing times [s], shape (n, 4)."""
        return read_only(burst_effort(time, self.bursts))
