"""The leg of a fit, and the range that it was measured in."""

from dataclasses import replace

import numpy as np

from surae.inference import FitResult
from surae.measures.leg import Leg
from surae.model.symmetry import with_paths
from surae.signals.resample import thinned, thinning_factor

#: Percentiles of the angle between which the ankle was moved.
_MOVED = (1.0, 99.0)
#: Rate [Hz] at which sums over recordings tell how they change with the leg, and the samples that
#: are left of each at least.
_RATE_HZ = 64.0
_SAMPLES = 400


def measured_range(
    result: FitResult, percentiles: tuple[float, float] = (0.5, 99.5)
) -> tuple[float, float]:
    """Lowest and highest angle of the samples that count, by the ankle's zero as given [deg]."""
    angles = [recording.angle[recording.counts] for recording in result.problem.inputs]
    zero = result.values.get("angle_zero", 0.0)
    low, high = np.degrees(np.percentile(np.concatenate(angles), percentiles) + zero)
    return float(low), float(high)


def leg_of(result: FitResult) -> Leg:
    """The leg of a fit."""
    problem = result.problem
    moved = measured_range(result, _MOVED)
    gained = result.solution.gained
    return Leg(problem.spec, problem.options, result.values, problem.inputs, moved, gained)


def thinned_leg(leg: Leg) -> Leg:
    """The leg whose torque is split at a rate that tells how it changes, if not of every sample.

    Of sums over a recording the derivatives are the same from half of the samples or an eighth.
    Percentiles of active states stay those of all: what is left where their derivatives cancel is
    less than a rate changes them.
    """
    thin = tuple(thinned(r, thinning_factor(r, _RATE_HZ, _SAMPLES)) for r in leg.inputs)
    return replace(leg, thin=thin, _ties={}, _holds={}, _muscles={}, _angles={})


def of_any_path(leg: Leg) -> Leg:
    """The leg in a model whose arms and paths may be others, now as they are."""
    spec = with_paths(leg.spec)
    values = {**dict.fromkeys(spec.names, 0.0), **leg.values}
    return replace(leg, spec=spec, values=values, _ties={}, _holds={}, _muscles={}, _angles={})
