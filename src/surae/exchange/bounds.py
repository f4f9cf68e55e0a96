"""Intervals of a fit as bounds of parameters, for Moco and for system identification in MuJoCo.

What a fit knows is in degrees and Nm; each bound is such an interval in the muscle's own numbers:
an optimum angle times the arm is a length of the tendon, a width in degrees a scale of the curve.
"""

from collections.abc import Iterator, Mapping
from dataclasses import dataclass

import numpy as np

from surae.base.files import csv_row
from surae.exchange.edited import ADDED
from surae.exchange.into import FittedHead, LegForModel
from surae.measures.measure import Measure

#: Columns of the table.
COLUMNS = (
    "component_path",
    "property",
    "nominal",
    "min_value",
    "max_value",
    "unit",
    "verdict",
    "known_by",
    "mujoco",
)
_DEGREE = np.pi / 180.0


@dataclass(frozen=True, slots=True)
class Bound:
    """A parameter of a model with what a fit says of it."""

    component: str  #: Path of its component in the model, as `MocoParameter` takes it.
    name: str  #: The component's property.
    nominal: float
    low: float | None  #: Ends of the 95 % interval; None where the fit says nothing.
    high: float | None
    unit: str
    verdict: str
    known_by: str  #: The measure that its interval is; or why there is none.
    mujoco: str = ""  #: What it is in a converted model of MuJoCo; empty where it is nothing there.

    def line(self) -> str:
        """Its line in the table."""
        values = (self.nominal, self.low, self.high, self.unit, self.verdict, self.known_by)
        return csv_row((self.component, self.name, *values, self.mujoco))


def bounds_of(leg: LegForModel, measures: Mapping[str, Measure], strength: str) -> list[Bound]:
    """Bounds of what was written into a model."""
    made = [bound for of in leg.heads for bound in _of_head(of, measures, strength)]
    joint = f"/forceset/{ADDED}_{leg.into.coordinate}_tissue"
    stiffness = measures.get("joint_stiffness")
    if leg.tissue.stiffness and stiffness is not None and stiffness.ci95 is not None:
        low, high = (end / _DEGREE for end in stiffness.ci95)
        made.append(
            Bound(
                joint,
                "expression (factor of q)",
                leg.tissue.stiffness,
                low,
                high,
                "Nm/rad",
                str(stiffness.verdict),
                "joint_stiffness",
                f"joint {leg.into.coordinate} stiffness",
            )
        )
    return made


def table_of(bounds: list[Bound]) -> str:
    """The table, as CSV."""
    return csv_row(COLUMNS) + "".join(bound.line() for bound in bounds)


def _of_head(of: FittedHead, measures: Mapping[str, Measure], strength: str) -> Iterator[Bound]:
    """Bounds of a head: of its strength, tendon and curve."""
    group = of.head.group
    path = f"/forceset/{of.head.name}"
    muscle = of.muscle
    actuator = f"actuator {of.head.name}"
    strong = measures.get(f"maximal_torque_{group}")
    if strength == "measured":
        yield _scaled(
            path, "max_isometric_force", muscle.peak, "N", strong, f"{actuator} gainprm[2]"
        )
    else:
        why = "the group has the model’s own: the fit knows force for EMG"
        name = "max_isometric_force"
        yield Bound(path, name, muscle.peak, None, None, "N", "", why, f"{actuator} gainprm[2]")
    kept = "the model’s own is kept: torque does not tell it"
    yield Bound(path, "optimal_fiber_length", muscle.optimal, None, None, "m", "", kept)
    best = measures.get(f"optimal_angle_{group}")
    if best is not None and best.ci95 is not None and best.value is not None:
        arm = float(of.arm(best.value * _DEGREE))
        ends = sorted(muscle.slack + arm * (end - best.value) * _DEGREE for end in best.ci95)
        yield Bound(
            path,
            "tendon_slack_length",
            muscle.slack,
            max(ends[0], 0.0),
            ends[1],
            "m",
            str(best.verdict),
            best.name,
        )
    wide = measures.get(f"active_width_{group}")
    yield _scaled(path, "active_force_width_scale", muscle.width, "1", wide, least=1.0)
    if muscle.strain:
        tight = next(
            (
                m
                for n, m in measures.items()
                if n.startswith(f"tendon_rotational_stiffness_{group}")
            ),
            None,
        )
        name = "tendon_strain_at_one_norm_force"
        yield _scaled(path, name, muscle.strain, "1", tight, inverse=True)


def _scaled(
    path: str,
    name: str,
    value: float,
    unit: str,
    by: Measure | None,
    mujoco: str = "",
    *,
    least: float = 0.0,
    inverse: bool = False,
) -> Bound:
    """A number that is proportional, or inverse, to a measure."""
    if by is None or by.ci95 is None or not by.value:
        why = "the fit has no interval of it"
        return Bound(path, name, value, None, None, unit, "", why, mujoco)
    low, high = (end / by.value for end in by.ci95)
    if inverse:
        low, high = (1.0 / high if high > 0.0 else 0.0), (1.0 / low if low > 0.0 else np.inf)
    ends = max(value * low, least), value * high
    top = max(ends[1], least) if np.isfinite(ends[1]) else None
    return Bound(path, name, value, ends[0], top, unit, str(by.verdict), by.name, mujoco)
