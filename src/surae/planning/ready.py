"""Designed protocols that come with surae: the genes that long searches found, a file each.

Genes are no movement yet: read for another range, device or duration they are a plan that keeps
those limits, so a ready protocol fits whoever is to be measured, and a search may begin with it.
"""

from dataclasses import dataclass
from functools import cache
from pathlib import Path

from surae.base.frozen import Comparable
from surae.base.records import from_plain, read_json
from surae.base.units import FloatArray
from surae.base.words import N_
from surae.planning.genes import Genes
from surae.planning.legs import Legs
from surae.planning.plan import highest_hz, limits_of
from surae.planning.torque import within_torque
from surae.protocol import Device, Trajectory

_FILES = Path(__file__).parent / "ready"
#: What each file is good for.
_GOOD_FOR = {
    "compliant-35": N_("Everything at once on compliant tendons, tendon strain included."),
    "everything-35": N_("Everything at once: slow and quick movement with efforts at many angles."),
    "passive-20": N_("Passive stiffness of a relaxed leg: slow ramps and holds, no effort."),
    "relaxed-35": N_("For a subject who cannot activate: everything that a relaxed leg tells."),
    "tendon-60": N_("How far tendons stretch: a minute of quick and slow movement with efforts."),
}
#: A ready protocol that is this much longer than what is searched is no start: cut off, it is worse
#: than none. A shorter one is repeated.
_LIKE = 1.1


@dataclass(frozen=True, slots=True, eq=False)
class Ready(Comparable):
    """A designed protocol that comes with surae."""

    name: str  #: Name in settings and files.
    description: str  #: What it is good for, in a sentence.
    seconds: float  #: Duration [s].
    #: `model`, `aim`: what it was searched for.
    model: str
    aim: str
    effort: bool  #: Whether it asks the subject for any.
    counts: tuple[int, int, int]  #: How many ramps, bursts and perturbations the genes are of.
    genes: FloatArray  #: As `Genes` reads them, shape (d,).

    def trajectory(
        self,
        device: Device | None,
        angle_range: tuple[float, float],
        rate_hz: float,
        legs: Legs,
    ) -> Trajectory:
        """The protocol on a device: within its limits, and its torque for these legs."""
        limits = limits_of(device, angle_range)
        genes = Genes(self.name, self.seconds, limits, highest_hz(device), self.effort)
        carried = genes.carried(self.genes, self.counts)  # a slow device has time for fewer ramps
        plan, limits, _ = within_torque(genes.plan(carried), limits, legs, device)
        return plan.trajectory(limits, rate_hz, device=device, legs=self.model)


@cache
def ready_protocols() -> dict[str, Ready]:
    """The protocols that come with surae, by name."""
    return {
        name: from_plain(
            Ready, {"name": name, "description": said, **read_json(_FILES / f"{name}.json")}
        )
        for name, said in _GOOD_FOR.items()
    }


def start_for(seconds: float, model: str, aim: str, effort: bool) -> Ready | None:
    """The ready protocol from which a search begins best; None where none is like it."""
    alike = [
        r for r in ready_protocols().values() if r.effort == effort and r.seconds <= _LIKE * seconds
    ]
    return max(alike, key=lambda r: (r.model == model, r.aim == aim, r.seconds), default=None)
