"""What a design is to make known: all parameters, or some parameters and measures by name."""

from collections.abc import Sequence
from dataclasses import dataclass

import numpy as np

from surae.errors import InputError
from surae.frozen import Comparable, read_only
from surae.measures import measures_of_values
from surae.protocol.planning.legs import Legs
from surae.units import FloatArray

#: Aims that are about all parameters: the largest error, or the mean of the errors' logarithms.
WORST, MEAN = "worst", "mean"
#: The p-norm that stands for the largest error: smooth, so that near-worst ones count too.
_NORM = 12.0
#: How much the mean of the logarithms counts beside the largest error.
_BESIDE = 0.3
#: Relative step of the differences that a measure's derivatives are made of.
_STEP = 1e-5


@dataclass(frozen=True, slots=True, eq=False)
class Aim(Comparable):
    """What is to be known well, of each leg."""

    name: str  #: As it was asked.
    wanted: tuple[str, ...]  #: Names of the parameters and measures.
    #: Derivatives of the logarithm of each by what a fit would estimate, shape (n_legs, n_wanted,
    #: p).
    slopes: FloatArray

    def errors(self, covariance: FloatArray) -> FloatArray:
        """Relative standard errors, shape (n_legs, n_wanted), of covariances (n_legs, p, p)."""
        variance = np.einsum("lwp,lpq,lwq->lw", self.slopes, covariance, self.slopes)
        return np.asarray(np.sqrt(np.maximum(variance, 1e-18)))

    def cost(self, covariance: FloatArray) -> float:
        """What a search makes small: about the logarithm of an error, averaged over the legs."""
        logs = np.log(self.errors(covariance))
        mean = float(logs.mean())
        if self.name == MEAN:
            return mean
        highest = logs.max(axis=1)
        norms = highest + np.log(np.exp(_NORM * (logs - highest[:, None])).sum(axis=1)) / _NORM
        return float(norms.mean()) + (_BESIDE * mean if self.name == WORST else 0.0)


def make_aim(name: str, legs: Legs) -> Aim:
    """The aim of that name.

    `name` is ``"worst"``, ``"mean"``, or names of parameters and measures of the legs with commas
    between them, e.g. ``"k_tib,passive_stiffness@10deg"``.
    """
    wanted = legs.own if name in (WORST, MEAN) else tuple(n.strip() for n in name.split(","))
    columns = [legs.spec.names.index(n) for n in legs.free]
    slopes = np.zeros((len(legs.values), len(wanted), len(legs.free)))
    measured = [n for n in wanted if n not in legs.own]
    for k, values in enumerate(legs.values):
        for i, which in enumerate(wanted):
            if which in legs.own:
                at = legs.free.index(which)
                slopes[k, i, at] = 1.0 / values[columns[at]]
        if measured:
            rows = _measure_slopes(measured, legs, values)
            for which, row in zip(measured, rows, strict=True):
                slopes[k, wanted.index(which)] = row
    return Aim(name, wanted, read_only(slopes))


def _measure_slopes(names: Sequence[str], legs: Legs, values: FloatArray) -> FloatArray:
    """Derivatives of the logarithms of measures, shape (n, p), by differences."""
    angles = tuple(sorted({_angle(name) for name in names if name.endswith("deg")})) or (0.0,)
    own = (*legs.own, *(n for n in legs.free if n in ("pt_tri", "pt_tib")))
    base = {n: float(values[legs.spec.names.index(n)]) for n in own}
    model = legs.spec.name

    def measures_at(parameters: dict[str, float]) -> FloatArray:
        measures = measures_of_values(parameters, model, legs.options, angles, names)
        missing = [n for n in names if n not in measures]
        if missing:
            every = measures_of_values(parameters, model, legs.options, angles)
            known = ", ".join((*legs.own, *every))
            raise InputError(f"--aim {missing[0]}: no such parameter or measure; known: {known}")
        return np.array([measures[n] for n in names])

    here, slopes = measures_at(base), np.zeros((len(names), len(legs.free)))
    for name in own:
        step = _STEP * abs(base[name])
        above, below = base | {name: base[name] + step}, base | {name: base[name] - step}
        slopes[:, legs.free.index(name)] = (
            (measures_at(above) - measures_at(below)) / (2.0 * step) / here
        )
    return slopes


def _angle(name: str) -> float:
    text = name.partition("@")[2].removesuffix("deg")
    try:
        return float(text)
    except ValueError:
        raise InputError(f"--aim {name}: write an angle as in passive_stiffness@10deg") from None
