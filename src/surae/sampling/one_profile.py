"""Profile likelihood: how the best sum of squares grows as one parameter is held elsewhere.

An interval from the covariance is the one of a parabola. The profile asks the model itself: it
holds the parameter at value after value, minimises over all others, and takes as interval the
values at which the sum of squares rises by no more than the threshold (Venzon and Moolgavkar 1988;
Raue et al. 2009). It follows curved valleys, is not symmetric, and has an open end where the data
set no limit.
"""

from collections.abc import Callable, Mapping
from dataclasses import dataclass
from itertools import pairwise
from typing import Literal

import numpy as np

from surae.base.errors import ComputationError, InputError
from surae.base.file_form import filed
from surae.base.frozen import Comparable, read_only
from surae.base.normal import NORMAL
from surae.base.records import Listed
from surae.inference import FitResult, LeastSquares
from surae.inference.identifiability.identified import unexplained
from surae.inference.metres import moved_by_film
from surae.inference.uncertainty.arms_and_paths import arms_and_paths, widened
from surae.inference.uncertainty.combined import information_root
from surae.inference.uncertainty.covariance import half_width
from surae.sampling.conditional import ConditionalMinimum, Surface, surface_of

Status = Literal["closed", "open", "lower-minimum"]
#: Points between the minimum and the threshold, in steps of equal √Δχ², and how far beyond the
#: threshold the last one lies.
_STEPS = 4
_BEYOND = 1.2
#: Factor by which a step may grow or shrink, and the rise, in steps, from which one is repeated.
_GROWTH = 3.0
_TOO_FAR = 2.0
#: Repetitions of one step, and points of one side, at most.
_RETRIES = 8
_MOST = 40
#: Part of the first step below which the search for the last finite torque ends.
_LEAST = 1e-2
#: First step as a part of the distance between the bounds where the covariance gives none.
_FIRST = 0.01
#: Accuracy of Δχ² at an end of the interval, as a part of the threshold.
_ACCURATE = 2e-3
#: Part of the threshold up to which a whole side is called flat.
_FLAT = 0.1
#: Noise variances by which another minimum must be lower to be told from the fit's by the data.
_LOWER = 1.0


@filed(
    "name",
    reasons="open",
    from_covariance="from_covariance",
    lower="lower_minimum",
    values="grid",
    chi2="delta_chi2",
    along="others",
)
@dataclass(frozen=True, slots=True, eq=False)
class ParameterProfile(Comparable):
    """Profile of one parameter."""

    #: `name`, `unit`: the parameter.
    name: str
    unit: str
    value: float  #: Estimate of the fit.
    #: Standard error from the covariance, widened as Δχ² is; None where there is none.
    sem: float | None
    values: Listed  #: Where the parameter was held, ascending, shape (k,).
    #: Least sum of squares there, weighted and with priors [Nm²], or −2 ln p of a posterior, (k,).
    sse: Listed
    chi2: Listed  #: Δχ²: (sse − lowest)/(σ²·variance_inflation), of −2 ln p without σ², (k,).
    along: Mapping[str, Listed]  #: The other free parameters along the profile, each of shape (k,).
    variance_inflation: float  #: What the variance of the noise was multiplied by.
    threshold: float  #: Δχ² at the ends of the 95 % interval.
    #: Lower and upper end; None where that side is open.
    interval: tuple[float | None, float | None]
    reasons: tuple[str, str]  #: Why each end is open; empty where it is not.
    #: Whether both ends were found, and whether the profile met a lower minimum than the fit's.
    status: Status
    message: str  #: What a reader has to know.
    lower: Mapping[str, float] | None  #: Free parameters of the lower minimum.
    evaluations: int  #: Of the model and its Jacobian.
    #: The interval with what arms and paths may be, which no torque tells: the profile is at those
    #: of the fit. None where they have no part in it, or in files of before.
    with_geometry: tuple[float | None, float | None] | None = None

    @property
    def from_covariance(self) -> tuple[float, float] | None:
        """The 95 % interval of the covariance, for comparison."""
        if self.sem is None:
            return None
        half = float(np.sqrt(self.threshold)) * self.sem
        return self.value - half, self.value + half


def profile(
    result: FitResult,
    name: str,
    *,
    variance_inflation: float = 1.0,
    over: Surface | None = None,
    stopped: Callable[[], bool] = bool,
) -> ParameterProfile:
    """Profile one parameter of a fit, from the minimum outwards to both sides.

    Of a fit with `model="auto"` it is the posterior's: with its films, priors, and all that differs
    from moment to moment. Δχ² is then that of −2 ln p, divided by `variance_inflation` as any.
    Fixed parameters stay fixed, bounds and priors hold. The threshold is t²(0.975; n − p), which is
    F₁ and, for many samples, χ²₁(0.95) = 3.84: σ² is estimated from the residual, and where the
    model is linear the interval is that of the covariance.

    `over` is what `surface_of` makes of the fit; `stopped` ends the work with KeyboardInterrupt.
    """
    check_profiled(result, name, variance_inflation)
    problem = result.problem
    table = problem.table
    search = _Search(result, name, over or surface_of(result), stopped, variance_inflation)
    (low, why_low) = search.end(-1)
    (high, why_high) = search.end(+1)
    sse = np.array([point.sse for point in search.points])
    path = dict(zip(problem.free, np.stack([point.x for point in search.points], 1), strict=True))
    status: Status = "open" if low is None or high is None else "closed"
    lower = None
    if search.lower is not None:
        lower = dict(zip(problem.free, search.lower.x.tolist(), strict=True))
        status = "lower-minimum"
    return ParameterProfile(
        name=name,
        unit=table[name].unit,
        value=result.values[name],
        sem=search.sem,
        values=read_only([point.value for point in search.points]),
        sse=read_only(sse),
        chi2=read_only((sse - sse.min()) / search.unit),
        along={other: read_only(values) for other, values in path.items() if other != name},
        variance_inflation=float(variance_inflation),
        threshold=search.threshold,
        interval=(low, high),
        reasons=(why_low, why_high),
        status=status,
        message=search.message(why_low, why_high),
        lower=lower,
        evaluations=search.minima.evaluations,
        with_geometry=_with_geometry(result, name, (low, high)),
    )


def check_profiled(result: FitResult, name: str, variance_inflation: float = 1.0) -> None:
    """Refuse what has no profile; see `profile`.

    Raises
    ------
    InputError
        The parameter is unknown or fixed, or the variance inflation is no number above zero.
    """
    problem = result.problem
    if name not in problem.spec.names:
        raise InputError(
            f"model {problem.spec.name!r} has no parameter {name!r}; this fit estimated: "
            f"{', '.join(problem.free)}"
        )
    known = profiled(result)
    if name not in known:
        why = "is fixed in this fit" if name not in problem.free else "is another in each recording"
        raise InputError(
            f"{name} {why} and has no profile; fit again with it free, or choose from: "
            f"{', '.join(known)}"
        )
    if not 0 < variance_inflation < np.inf:
        raise InputError(f"variance inflation is {variance_inflation!r}; give a number above zero")
    if not (np.isfinite(result.sse) and np.isfinite(result.R).all()):
        raise InputError("the fit failed without a finite torque: there is nothing to profile")
    if result.sse == 0:
        raise InputError("the fit leaves no residual: without noise there is no interval")


def _with_geometry(
    result: FitResult, name: str, ends: tuple[float | None, float | None]
) -> tuple[float | None, float | None] | None:
    """The interval with what arms and paths may be; None where they have no part in it."""
    path = moved_by_film(result.problem, name)
    value = result.values[name]
    if path and value > 0.0:  # profiled at the path that the film tells
        at = result.problem.free.index(path)
        solution = result.posterior
        sd = 0.0 if solution is None else float(np.sqrt(solution.covariance[at, at]))
        ends = widened(ends, value, NORMAL * sd)
    known = arms_and_paths(result)
    if known is None or not known.moves(name):
        return ends if path else None
    return known.about(name, ends)


def profiled(result: FitResult) -> tuple[str, ...]:
    """Parameters of a fit that have a profile: those that all its recordings share."""
    each = () if result.posterior is None else result.posterior.each
    return tuple(n for n in result.problem.free if n not in each)


class _Search:
    """The work on one profile: out from the minimum, back again, and to the ends."""

    #: A minimum that is lower than the fit's by more than the data's noise.
    lower: ConditionalMinimum | None = None

    def __init__(
        self,
        result: FitResult,
        name: str,
        over: Surface,
        stopped: Callable[[], bool],
        variance_inflation: float,
    ) -> None:
        self._name, self.minima = name, over(name, stopped)
        self._low, self._high = self.minima.limits
        self._width = self._high - self._low
        free = result.problem.free
        at_bound = result.at_bound
        rest = [i for i, other in enumerate(free) if other not in (*at_bound, name)]
        dof = result.problem.n - len(rest) - (name not in at_bound)
        variance = result.sse / dof
        sigma2 = variance if isinstance(result.solution, LeastSquares) else 1.0
        #: Variance of the noise that makes Δχ² of sums of squares [Nm²]; of −2 ln p, its inflation.
        self.unit = sigma2 * variance_inflation
        self.threshold = half_width(1.0, dof) ** 2
        self._aim = float(np.sqrt(self.threshold))
        R = information_root(result)
        known = 0.0 if name in at_bound else unexplained(R, free.index(name), rest)
        #: Those at a bound taken as known.
        self.sem = float(np.sqrt(variance * variance_inflation / known)) if known > 0 else None
        fit = self.minima.fit
        centre = self.minima.at(fit.value, fit)
        if centre is None:
            raise ComputationError("the model gives no finite torque at the fit: fit again")
        self._lowest = centre.sse
        below = self._walk(centre, -1)
        above = self._walk(centre, +1)
        self._spent = {-1: len(below) == _MOST, 1: len(above) == _MOST}
        self.points = [*below[::-1], centre, *above]
        self._come_back(len(below))
        best = min(self.points, key=lambda point: point.sse)
        if best.sse < fit.sse - _LOWER * sigma2:
            minimum = self.minima.free(best)
            if minimum is not None and minimum.sse < best.sse:
                self._insert(minimum)
                best = minimum
            self.lower = best

    @property
    def inside(self) -> list[int]:
        """Numbers of the points within the interval."""
        return [i for i, point in enumerate(self.points) if self._z(point) <= self._aim]

    def _z(self, point: ConditionalMinimum) -> float:
        """√Δχ², which grows in proportion to the distance where the model is linear."""
        return float(np.sqrt(max(point.sse - self._lowest, 0.0) / self.unit))

    def _at(self, value: float, near: ConditionalMinimum) -> ConditionalMinimum | None:
        minimum = self.minima.at(value, near)
        if minimum is not None:
            self._lowest = min(self._lowest, minimum.sse)
        return minimum

    def _walk(self, centre: ConditionalMinimum, sign: int) -> list[ConditionalMinimum]:
        """Points from the centre outwards, until beyond the threshold or at the bound."""
        bound = self._high if sign > 0 else self._low
        rise = self._aim / _STEPS
        step = _FIRST * self._width
        if self.sem is not None:
            step = min(rise * self.sem, self._width / 8)
        least = _LEAST * step
        points: list[ConditionalMinimum] = []
        here = centre
        retries = 0
        while (room := abs(bound - here.value)) > 1e-9 * self._width and len(points) < _MOST:
            step = min(step, room)
            value = bound if step > 0.999 * room else here.value + sign * step
            there = self._at(value, here)
            if there is None and step <= least:
                break
            risen = np.inf if there is None else self._z(there) - self._z(here)
            if risen > _TOO_FAR * rise and retries < _RETRIES:
                step *= float(np.clip(rise / risen, 1 / _GROWTH**2, 1 / _TOO_FAR))
                retries += 1
                continue
            if there is None:
                break
            points.append(there)
            here = there
            retries = 0
            if self._z(here) >= _BEYOND * self._aim:
                break
            step *= float(np.clip(rise / max(risen, 1e-3 * rise), 1 / _GROWTH, _GROWTH))
        return points

    def _come_back(self, centre: int) -> None:
        """Try every point from its outer neighbour too, and go on past the centre if that helps."""
        last = len(self.points) - 1
        for order in (range(last + 1), range(last, -1, -1)):
            improved = False
            for before, i in pairwise(order):
                inwards = abs(i - centre) < abs(before - centre)
                if not (inwards or improved):
                    break
                minimum = self._at(self.points[i].value, self.points[before])
                improved = minimum is not None and minimum.sse < self.points[i].sse
                if minimum is not None and improved:
                    self.points[i] = minimum

    def _insert(self, point: ConditionalMinimum) -> None:
        self._lowest = min(self._lowest, point.sse)
        self.points = sorted([*self.points, point], key=lambda placed: placed.value)

    def end(self, sign: int) -> tuple[float | None, str]:
        """One end of the interval, refined until Δχ² is the threshold, or why there is none."""
        outermost = -1 if sign > 0 else 0
        last = self.points[outermost]
        if self._z(last) <= self._aim:
            return None, self._why_open(last, sign)
        value = last.value
        for _ in range(_RETRIES):
            i = self.inside[outermost]
            near = self.points[i]
            far = self.points[i + sign]
            part = (self._aim - self._z(near)) / (self._z(far) - self._z(near))
            value = near.value + part * (far.value - near.value)
            start = near if part < 0.5 else far
            if abs(value - start.value) <= 1e-9 * self._width:
                break
            minimum = self._at(value, start)
            if minimum is None:
                break
            self._insert(minimum)
            if abs(self._z(minimum) ** 2 - self.threshold) <= _ACCURATE * self.threshold:
                break
        return value, ""

    def _why_open(self, last: ConditionalMinimum, sign: int) -> str:
        side, bound = ("lower", self._low) if sign < 0 else ("upper", self._high)
        rise = self._z(last) ** 2
        if abs(last.value - bound) > 1e-6 * self._width:
            why = f"{_MOST} points" if self._spent[sign] else "no finite torque beyond"
            return f"Δχ² is {rise:.2g} at {last.value:g}, where the search ended: {why}"
        if abs(self.minima.fit.value - bound) <= 1e-6 * self._width:
            return f"the estimate lies at its {side} bound {bound:g}"
        if rise <= _FLAT * self.threshold:
            return f"flat: Δχ² is only {rise:.2g} up to the {side} bound {bound:g}"
        return (
            f"Δχ² is {rise:.2g} at the {side} bound {bound:g}, below the threshold "
            f"{self.threshold:.2f}"
        )

    def message(self, why_low: str, why_high: str) -> str:
        """What a reader has to know, with why either end is open."""
        sentences = []
        if self.lower is not None:
            by = (self.minima.fit.sse - self.lower.sse) / self.unit
            sentences.append(
                f"met a lower minimum than the fit's, at {self._name} = {self.lower.value:g} (Δχ² "
                f"lower by {by:.2g}): fit again from there, or with more starts"
            )
        ways = (("downwards", why_low), ("upwards", why_high))
        sentences += [f"open {side}: {why}" for side, why in ways if why]
        if self.inside[-1] - self.inside[0] + 1 > len(self.inside):
            sentences.append("Δχ² exceeds the threshold between the ends too: the region has parts")
        if astray := sum(not point.converged for point in self.points):
            sentences.append(
                f"{astray} of {len(self.points)} points met the iteration limit: Δχ² there may be "
                "too high"
            )
        return "; ".join(sentences) or "both ends found"
