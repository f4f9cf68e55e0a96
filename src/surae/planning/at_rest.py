"""What a planned movement will tell of the relaxed leg, by the posterior of its relaxed curve.

No information matrix has the flexible curve: a few of the legs are recorded as planned, with the
torque's noise, and their rest is read as it will be.
"""

from collections.abc import Mapping
from dataclasses import dataclass, replace

import numpy as np

from surae.base.frozen import FrozenDict, read_only
from surae.inference.relaxed.build import curve_of
from surae.inference.relaxed.context import UNKNOWN
from surae.inference.relaxed.curve import RelaxedCurve
from surae.measures.measure import Measure
from surae.measures.rest.judged import measures_of_rest
from surae.model.joint import ANKLE
from surae.planning.information import model_inputs
from surae.planning.legs import Legs
from surae.protocol import Trajectory

#: Legs that are recorded, and the seed of their noise.
_LEGS = 4
_SEED = 29
#: Samples a second at which they are recorded [Hz].
_RATE = 64.0
#: Measures that are expected, where rest tells them in most of the legs.
_NAMES = ("slow_stiffness", "passive_stiffness", "end_stiffness", "torque_rise")


@dataclass(frozen=True, slots=True)
class ExpectedAtRest:
    """What is expected of one measure of rest."""

    unit: str
    value: float  #: Middle of the legs' values.
    #: Half of the 95 % interval as a part of the value, middle of the legs: at the ankle's own
    #: angle, whose zero nobody stated; and at that of the device, None where it is at none.
    half_width: float
    half_width_device: float | None


def expected_at_rest(
    trajectory: Trajectory, legs: Legs, noise: float
) -> Mapping[str, ExpectedAtRest]:
    """What the rest of a planned trial will tell, by name of the measure.

    Parameters
    ----------
    trajectory : Trajectory
        The movement and its efforts.
    legs : Legs
        Who may be measured; the first few of them are recorded.
    noise : float
        Of the torque [Nm], white, sample by sample of the trajectory.

    Returns
    -------
    mapping of str to ExpectedAtRest
        Empty where rest tells nothing, and of another joint than the ankle.
    """
    if legs.options.anatomy != ANKLE:
        return FrozenDict()
    inputs = model_inputs(trajectory, legs, min(_RATE, trajectory.settings.rate_hz))
    simulator = legs.spec.simulator(inputs, legs.options)
    sd = noise * np.sqrt(inputs.rate_hz / trajectory.settings.rate_hz)
    random = np.random.default_rng(_SEED)
    by_leg: list[dict[str, Measure]] = []
    for values in legs.values[:_LEGS]:
        torque = simulator.torque(np.array(values)) + sd * random.standard_normal(inputs.n)
        trial = replace(inputs, torque=read_only(torque))
        curve = curve_of((trial,), UNKNOWN)
        if isinstance(curve, RelaxedCurve):
            by_leg.append({m.name: m for m in measures_of_rest(curve)})
    return FrozenDict(_middling(by_leg))


def _middling(by_leg: list[dict[str, Measure]]) -> dict[str, ExpectedAtRest]:
    """The middle of what was found, where most of the legs have it."""
    made = {}
    for name in dict.fromkeys(name for each in by_leg for name in each):
        if not name.startswith(_NAMES):
            continue
        known = [m for each in by_leg if (m := each[name]).value and m.ci95 is not None]
        if 2 * len(known) <= len(by_leg):
            continue
        half = [_half(m.ci95, m.value) for m in known]
        shown = [_half(m.ci95_device, m.value) for m in known if m.ci95_device is not None]
        made[name] = ExpectedAtRest(
            known[0].unit,
            float(np.median([m.value for m in known if m.value is not None])),
            float(np.median(half)),
            float(np.median(shown)) if shown else None,
        )
    return made


def _half(ci95: tuple[float, float] | None, value: float | None) -> float:
    assert ci95 is not None
    assert value
    return 0.5 * (ci95[1] - ci95[0]) / abs(value)
