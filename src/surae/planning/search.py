"""The search for the plan that tells most, by an evolution strategy.

The cost of a plan is that of its information on several legs at once, for nobody knows
whose leg comes. It has many valleys and kinks where limits are met: covariance matrix adaptation
with a diagonal matrix (Ros and Hansen 2008) crosses them. Torque beyond the device's limit costs;
what is left of it is taken out afterwards.
"""

import math
import time
from collections.abc import Sequence
from dataclasses import dataclass

import numpy as np

from surae.base.errors import InputError
from surae.base.frozen import Comparable, read_only
from surae.base.progress import SearchProgress
from surae.base.threads import one_blas_thread
from surae.base.units import FloatArray
from surae.inference.interrupt import checkpoint, postponed_interrupt
from surae.inference.relaxed.pair import REMOUNTED
from surae.measures import measures_of_values
from surae.measures.plain import PLAIN
from surae.planning.genes import Genes
from surae.planning.information import information
from surae.planning.legs import Legs

#: Aims that are about all parameters: the largest error, or the mean of the errors' logarithms.
WORST = "worst"
MEAN = "mean"
#: The p-norm that stands for the largest error: smooth, so that near-worst ones count too.
_NORM = 12.0
#: How much the mean of the logarithms counts beside the largest error.
_BESIDE = 0.3
#: How a change is asked for, of a parameter or measure.
CHANGE = "change in "
#: The last of a range, over which its end is as stiff as its mean, and half of the turn by which
#: slopes over the angle are taken [deg].
_LAST = 10.0
_TURN = 0.5
#: How parameters begin that are of the leg's paths and curves.
_OF_LEG = ("arm_", "path_", "length_", "fl_", "fv_")
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
    #: Relative standard deviation that another visit adds, shape (n_legs, n_wanted); what is
    #: wanted is a change then, and errors are those of a difference. Zeros where it is a value.
    anew: FloatArray | None = None

    def errors(self, covariance: FloatArray) -> FloatArray:
        """Relative standard errors, shape (n_legs, n_wanted), of covariances (n_legs, p, p)."""
        variance = np.einsum("lwp,lpq,lwq->lw", self.slopes, covariance, self.slopes)
        if self.anew is not None:
            variance = variance * (1.0 + self.is_change) + self.anew**2
        return np.asarray(np.sqrt(np.maximum(variance, 1e-18)))

    @property
    def is_change(self) -> FloatArray:
        """1 where a change is wanted, 0 where a value is, shape (n_wanted,)."""
        return np.array([float(name.startswith(CHANGE)) for name in self.wanted])

    def cost(self, covariance: FloatArray) -> float:
        """What a search makes small: about the logarithm of an error, averaged over the legs."""
        logs = np.log(self.errors(covariance))
        mean = float(logs.mean())
        if self.name == MEAN:
            return mean
        highest = logs.max(axis=1)
        norms = highest + np.log(np.exp(_NORM * (logs - highest[:, None])).sum(axis=1)) / _NORM
        return float(norms.mean()) + (_BESIDE * mean if self.name == WORST else 0.0)


def make_aim(name: str, legs: Legs, moved: tuple[float, float] | None = None) -> Aim:
    """The aim ``worst``, ``mean``, or of names, e.g. ``"k_tib,change in end_stiffness"``.

    Parameters
    ----------
    name : str
        With commas between; ``"change in NAME"`` is the difference of two such visits, the foot
        mounted anew between them.
    legs : Legs
        Whose.
    moved : (float, float), optional
        The range that is moved [deg], which what is of its end asks for.

    Returns
    -------
    Aim
        Derivatives of logarithms.

    Raises
    ------
    InputError
        There is no such parameter or measure.
    """
    asked = (
        legs.leg_parameters if name in (WORST, MEAN) else tuple(n.strip() for n in name.split(","))
    )
    wanted = tuple(n.removeprefix(CHANGE) for n in asked)
    columns = [legs.spec.names.index(n) for n in legs.free]
    slopes = np.zeros((len(legs.values), len(wanted), len(legs.free)))
    anew = np.zeros((len(legs.values), len(wanted)))
    measured = [n for n in dict.fromkeys(wanted) if n not in legs.leg_parameters]
    for k, values in enumerate(legs.values):
        for i, which in enumerate(wanted):
            if which in legs.leg_parameters:
                at = legs.free.index(which)
                slopes[k, i, at] = 1.0 / values[columns[at]]
        if measured:
            rows, turned = _measure_slopes(measured, legs, values, moved)
            for i, which in enumerate(wanted):
                if which in measured:
                    slopes[k, i] = rows[measured.index(which)]
                    anew[k, i] = math.sqrt(2.0) * REMOUNTED * turned[measured.index(which)]
    anew *= [name.startswith(CHANGE) for name in asked]
    return Aim(name, asked, read_only(slopes), read_only(anew))


def _measure_slopes(
    names: Sequence[str], legs: Legs, values: FloatArray, moved: tuple[float, float] | None
) -> tuple[FloatArray, FloatArray]:
    """Derivatives of the logarithms of measures, shape (n, p), and by the angle [1/deg], (n,)."""
    # arms and paths that a fit estimates along act on a measure as they do on its parameters, and
    # mostly cancel: without them a torque would seem as unsure as the arms are
    also = [n for n in legs.free if n.startswith(_OF_LEG) or n in ("pt_tri", "pt_tib")]
    varied = (*legs.leg_parameters, *also)
    base = {n: float(values[legs.spec.names.index(n)]) for n in varied}

    def measures_at(parameters: dict[str, float], turned: float = 0.0) -> FloatArray:
        return _measured(names, parameters, legs, moved, turned)

    here = measures_at(base)
    turned = np.abs(measures_at(base, _TURN) - measures_at(base, -_TURN)) / (2.0 * _TURN)
    slopes = np.zeros((len(names), len(legs.free)))
    for name in varied:
        step = _STEP * max(abs(base[name]), legs.priors[name].sd if name in legs.priors else 0.0)
        above = base | {name: base[name] + step}
        below = base | {name: base[name] - step}
        slopes[:, legs.free.index(name)] = (
            (measures_at(above) - measures_at(below)) / (2.0 * step) / here
        )
    return slopes, turned / np.abs(here)


def _measured(
    names: Sequence[str],
    parameters: dict[str, float],
    legs: Legs,
    moved: tuple[float, float] | None,
    turned: float,
) -> FloatArray:
    """Measures of a leg by their names, the foot `turned` on its plate [deg], shape (n,)."""
    ends = {} if moved is None else _of_range(moved)
    stated = {
        n: f"{n.partition('@')[0]}@{_angle(n) + turned:g}deg" for n in names if n.endswith("deg")
    }
    parts = {
        n: [(f"passive_torque@{at + turned:.6g}deg", by) for at, by in ends[n]]
        for n in names
        if n in ends
    }
    asked = [*stated.values(), *(one for pairs in parts.values() for one, _ in pairs)]
    angles = tuple(sorted({_angle(name) for name in asked})) or (0.0,)
    plain = [n for n in names if n not in stated and n not in parts]
    values_of = measures_of_values(
        parameters, legs.spec.name, legs.options, angles, [*asked, *plain]
    )
    made = []
    for name in names:
        if name in parts and all(one in values_of for one, _ in parts[name]):
            made.append(sum(by * values_of[one] for one, by in parts[name]))
        elif stated.get(name, name) in values_of:
            made.append(values_of[stated.get(name, name)])
        else:
            every = measures_of_values(parameters, legs.spec.name, legs.options, angles)
            if name.partition("@")[0] in PLAIN:
                raise InputError(
                    f"--aim {name}: it is read from recordings, or of another model, so that no "
                    "plan tells it beforehand; aim at torque_rise or end_stiffness"
                )
            known = ", ".join(dict.fromkeys((*legs.leg_parameters, *ends, *every)))
            raise InputError(f"--aim {name}: no such parameter or measure; known: {known}")
    return np.array(made)


def _of_range(moved: tuple[float, float]) -> dict[str, tuple[tuple[float, float], ...]]:
    """What is of a range [deg], as relaxed torques at angles and by what each counts."""
    low, high = moved
    last = max(low, high - _LAST)
    # a foot that is held still has a torque, and no range
    over = 1.0 / (high - last) if high > last else math.nan
    once = 1.0 if high > low else math.nan
    return {
        "end_torque": ((high, 1.0),),
        "torque_rise": ((high, once), (low, -once)),
        "end_stiffness": ((high, over), (last, -over)),
    }


def _angle(name: str) -> float:
    text = name.partition("@")[2].removesuffix("deg")
    try:
        return float(text)
    except ValueError:
        raise InputError(f"--aim {name}: write an angle as in passive_stiffness@10deg") from None


#: Rate at which plans are judged while they are searched [Hz].
SEARCH_RATE = 32.0
#: Plans of a generation, the first step from nowhere, and that from a plan of a like question.
_POPULATION = 20
_SIGMA = 0.7
_NEAR = 0.25
#: Relative standard deviation with which a leg's parameters are known before any trial: so vague
#: that it matters only where a plan says nothing of one, and keeps such plans comparable.
VAGUE = 1.0
#: What the square of the part by which a torque exceeds its limit costs; a plan without numbers.
_BEYOND = 20.0
_NOTHING = 1e3


@dataclass(frozen=True, slots=True, eq=False)
class Search(Comparable):
    """Where a search ended."""

    genes: FloatArray  #: The best plan, shape (d,).
    evaluations: int  #: Plans that were judged.
    #: Evaluations, seconds and the best cost, each time that it fell by a hundredth.
    curve: tuple[tuple[int, float, float], ...]
    stopped: bool  #: Whether Ctrl-C ended it.


@dataclass(frozen=True, slots=True)
class SearchBudget:
    """How long a protocol is searched."""

    evaluations: int  #: Plans that are judged, at most.
    seed: int  #: Of the search.
    #: Called with plans judged, of how many, and the best cost.
    progress: SearchProgress | None = None


class _SpentError(Exception):
    """All evaluations have been made."""


def search(
    genes: Genes,
    legs: Legs,
    aim: Aim,
    *,
    noise: float,
    torque: float,
    budget: SearchBudget,
    known: FloatArray | None = None,
    start: FloatArray | None = None,
) -> Search:
    """Search the plan of the smallest cost; the same arguments always find the same one.

    `noise` [Nm] is that of one sample at `SEARCH_RATE`, `torque` [Nm] what no leg should exceed;
    `known`, shape (p, p), is information without the trial, `start` are genes where it begins.
    """
    from cmaes import SepCMA

    scale = np.abs(legs.estimated)
    for j, name in enumerate(legs.free):
        if name in legs.priors:
            scale[:, j] = legs.priors[name].sd
    scale = np.where(scale > 0.0, scale, 1.0)
    units = scale[:, :, None] * scale[:, None, :]
    before = np.eye(len(legs.free)) * VAGUE**-2.0 + (0.0 if known is None else known * units)
    begin = time.perf_counter()
    best = genes.start() if start is None else np.array(start)
    lowest = np.inf
    count = 0
    curve: list[tuple[int, float, float]] = []

    def cost(x: FloatArray) -> float:
        trial = genes.plan(x).trajectory(genes.limits, SEARCH_RATE, fine_hz=SEARCH_RATE)
        tells = information(trial, legs, noise, SEARCH_RATE)
        matrices = tells.matrices * units + before
        if not np.isfinite(matrices).all():
            return _NOTHING
        beyond = max(float(np.abs(tells.torque).max()) / torque - 1.0, 0.0)
        return aim.cost(np.linalg.inv(matrices) * units) + _BEYOND * beyond**2

    def judge(x: FloatArray) -> float:
        nonlocal best, lowest, count
        checkpoint()
        if count >= budget.evaluations:
            raise _SpentError
        value = cost(x)
        count += 1
        if value < lowest:
            if not curve or value < curve[-1][2] - 0.01:
                curve.append((count, time.perf_counter() - begin, value))
            best = np.array(x)
            lowest = value
        if budget.progress is not None and count % 50 == 0:
            budget.progress(count, budget.evaluations, lowest)
        return value

    stopped = False
    with one_blas_thread(), postponed_interrupt(), np.errstate(all="ignore"):
        try:
            judge(best)
            strategy = SepCMA(
                mean=best,
                sigma=_SIGMA if start is None else _NEAR,
                seed=budget.seed,
                population_size=_POPULATION,
            )
            while True:
                candidates = [strategy.ask() for _ in range(_POPULATION)]
                strategy.tell([(x, judge(x)) for x in candidates])
        except _SpentError:
            pass
        except KeyboardInterrupt:
            stopped = True
    return Search(read_only(best), count, tuple(curve), stopped)
