"""Muscles and tendons of one recording in numbers: how long, how fast, how strong."""

from dataclasses import dataclass

import numpy as np

from surae.report.formatting import NO_NUMBER, signed, significant
from surae.report.traces import Traces
from surae.units import FloatArray

_MILLI = 1e3
#: Names of the two muscle groups, in the order of their rows.
GROUPS = ("Triceps surae", "Tibialis anterior")


@dataclass(frozen=True, slots=True)
class TendonRow:
    """Ranges of one muscle and its tendon as text."""

    group: str  #: The muscle group.
    #: `length`, `velocity`: of the muscle [l0, l0/s].
    length: str
    velocity: str
    #: `elongation`, `force`: of the tendon [mm, N].
    elongation: str
    force: str
    toe: str  #: Force at which the toe ends, and how far the recording went [N].

    @property
    def text(self) -> str:
        """The row as a sentence."""
        return (
            f"{self.group}: muscle length {self.length} l0, velocity {self.velocity} l0/s; tendon "
            f"elongation {self.elongation} mm, force {self.force} N, end of toe {self.toe}."
        )


def tendon_rows(traces: Traces) -> tuple[TendonRow, ...]:
    """What muscle and tendon of each group do; nothing where tendons are rigid."""
    state = traces.tendon
    if state is None:
        return ()
    return tuple(
        TendonRow(
            group=name,
            length=_range(state.muscle_length[row] / traces.optimal[row], 2),
            velocity=_range(state.muscle_velocity[row] / traces.optimal[row], 1),
            elongation=_range(_MILLI * state.elongation[row], 1),
            force=_range(state.tendon_force[row], 0),
            toe=_toe(state.tendon_force[row], state.laws[row].toe_force),
        )
        for row, name in enumerate(GROUPS)
    )


def _range(values: FloatArray, decimals: int) -> str:
    known = values[np.isfinite(values)]
    if not known.size:
        return NO_NUMBER
    return f"{signed(float(known.min()), decimals)} … {signed(float(known.max()), decimals)}"


def _toe(force: FloatArray, toe: float) -> str:
    known = force[np.isfinite(force)]
    end = f"{significant(toe, 3)} N"
    if not known.size:
        return end
    highest = float(known.max())
    if highest > toe:
        return f"{end}, exceeded"
    return f"{end}, {significant(100 * highest / toe, 2)} % of it reached"
