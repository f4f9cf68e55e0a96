"""The work on one profile: out from the minimum, back again, and to the ends of the interval."""

from itertools import pairwise

import numpy as np

from surae.assessment.identifiability.directions import unexplained
from surae.assessment.likelihood.conditional import (
    Conditional,
    ConditionalMinimum,
    ConditionalPosterior,
)
from surae.errors import ComputationError
from surae.estimation import FitResult
from surae.units import FloatArray

#: Points between the minimum and the threshold, in steps of equal √Δχ², and how far beyond the
#: threshold the last one lies.
_STEPS, _BEYOND = 4, 1.2
#: Factor by which a step may grow or shrink, and the rise, in steps, from which one is repeated.
_GROWTH, _TOO_FAR = 3.0, 2.0
#: Repetitions of one step, and points of one side, at most.
_RETRIES, _MOST = 8, 40
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


class ProfileSearch:
    """A search for the profile of one parameter; the attributes are what it found.

    Attributes
    ----------
    points : list of ConditionalMinimum
        Ascending in the parameter's value.
    ends : list of tuple of (float or None, str)
        Lower and upper end of the interval, or why there is none.
    lower : ConditionalMinimum or None
        A minimum that is lower than the fit's by more than the data's noise.
    lower_by : float
        How much lower it is, as Δχ².
    threshold : float
        Δχ² at the ends of the interval.
    unit : float
        Variance of the noise that makes Δχ² of sums of squares [Nm²]; of −2 ln p, its inflation.
    sem : float or None
        Standard error from the covariance.
    evaluations : int
        Of the model and its Jacobian.
    """

    def __init__(
        self,
        result: FitResult,
        name: str,
        minima: Conditional | ConditionalPosterior,
        variance_inflation: float,
    ) -> None:
        from scipy.special import stdtrit

        problem = result.problem
        self._result, self._name = result, name
        self._j = j = problem.free.index(name)
        self._minima = minima
        self._low, self._high = minima.limits
        inside = [i for i, parameter in enumerate(problem.free) if parameter not in result.at_bound]
        dof = problem.n - len(inside)
        variance = result.sse / dof
        self._sigma2 = variance if result.family is None else 1.0
        self.unit = self._sigma2 * variance_inflation
        self.threshold = float(stdtrit(dof, 0.975)) ** 2
        self.sem = _sem(result.R, j, inside, variance * variance_inflation)
        self.lower: ConditionalMinimum | None = None
        self.lower_by = 0.0
        self._aim = float(np.sqrt(self.threshold))
        self._lowest = np.inf
        self.points, below = self._walk_out()
        self._come_back(below)
        self._lower_minimum()
        self.ends = [self._end(below=True), self._end(below=False)]
        self.evaluations = self._minima.evaluations

    @property
    def inside(self) -> list[int]:
        """Numbers of the points within the interval."""
        return [i for i, point in enumerate(self.points) if self._z(point) <= self._aim]

    def _z(self, point: ConditionalMinimum) -> float:
        """√Δχ², which grows in proportion to the distance where the model is linear."""
        return float(np.sqrt(max(point.sse - self._lowest, 0.0) / self.unit))

    def _at(self, value: float, near: ConditionalMinimum) -> ConditionalMinimum | None:
        minimum = self._minima.at(value, near.x, near.local)
        if minimum is not None:
            self._lowest = min(self._lowest, minimum.sse)
        return minimum

    def _walk_out(self) -> tuple[list[ConditionalMinimum], int]:
        """Points on both sides of the fit, and how many lie below it."""
        problem = self._result.problem
        x = np.array([self._result.values[parameter] for parameter in problem.free])
        x = np.clip(x, problem.lower, problem.upper)
        self._fit_sse = self._minima.sse(x)
        centre = self._minima.at(float(x[self._j]), x)
        if centre is None:
            raise ComputationError("the model gives no finite torque at the fit: fit again")
        self._lowest = centre.sse
        below, above = self._walk(centre, -1), self._walk(centre, +1)
        self._spent = {True: len(below) == _MOST, False: len(above) == _MOST}
        return [*below[::-1], centre, *above], len(below)

    def _walk(self, centre: ConditionalMinimum, sign: int) -> list[ConditionalMinimum]:
        """Points from the centre outwards, until beyond the threshold or at the bound."""
        bound = self._high if sign > 0 else self._low
        width = self._high - self._low
        rise = self._aim / _STEPS
        step = _FIRST * width if self.sem is None else min(rise * self.sem, width / 8)
        least = _LEAST * step
        points: list[ConditionalMinimum] = []
        here, retries = centre, 0
        while abs(bound - here.value) > 1e-9 * width and len(points) < _MOST:
            room = abs(bound - here.value)
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
            here, retries = there, 0
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

    def _lower_minimum(self) -> None:
        """Take the path's lowest point to its minimum, if it is lower than the fit's."""
        best = min(self.points, key=lambda point: point.sse)
        if best.sse >= self._fit_sse - _LOWER * self._sigma2:
            return
        minimum = self._minima.free(best)
        if minimum is not None and minimum.sse < best.sse:
            self._insert(minimum)
            best = minimum
        self.lower, self.lower_by = best, (self._fit_sse - best.sse) / self.unit

    def _insert(self, point: ConditionalMinimum) -> None:
        self._lowest = min(self._lowest, point.sse)
        self.points = sorted([*self.points, point], key=lambda placed: placed.value)

    def _end(self, *, below: bool) -> tuple[float | None, str]:
        """One end of the interval, refined until Δχ² is the threshold, or why there is none."""
        step = -1 if below else 1
        outermost = self.points[0 if below else -1]
        if self._z(outermost) <= self._aim:
            return None, self._why_open(outermost, below=below)
        value = outermost.value
        for _ in range(_RETRIES):
            i = self.inside[0 if below else -1]
            near, far = self.points[i], self.points[i + step]
            z_near, z_far = self._z(near), self._z(far)
            part = (self._aim - z_near) / (z_far - z_near)
            value = near.value + part * (far.value - near.value)
            start = near if part < 0.5 else far
            if abs(value - start.value) <= 1e-9 * abs(self._high - self._low):
                break
            minimum = self._at(value, start)
            if minimum is None:
                break
            self._insert(minimum)
            if abs(self._z(minimum) ** 2 - self.threshold) <= _ACCURATE * self.threshold:
                break
        return value, ""

    def _why_open(self, last: ConditionalMinimum, *, below: bool) -> str:
        side, bound = ("lower", self._low) if below else ("upper", self._high)
        width, rise = self._high - self._low, self._z(last) ** 2
        if abs(last.value - bound) > 1e-6 * width:
            why = f"{_MOST} points" if self._spent[below] else "no finite torque beyond"
            return f"Δχ² is {rise:.2g} at {last.value:g}, where the search ended: {why}"
        if abs(self._result.values[self._name] - bound) <= 1e-6 * width:
            return f"the estimate lies at its {side} bound {bound:g}"
        if rise <= _FLAT * self.threshold:
            return f"flat: Δχ² is only {rise:.2g} up to the {side} bound {bound:g}"
        return (
            f"Δχ² is {rise:.2g} at the {side} bound {bound:g}, below the threshold "
            f"{self.threshold:.2f}"
        )


def _sem(R: FloatArray, j: int, inside: list[int], variance: float) -> float | None:
    """Standard error of a parameter, those at a bound taken as known; None where there is none."""
    if j not in inside:
        return None
    information = unexplained(R, j, [i for i in inside if i != j])
    return float(np.sqrt(variance / information)) if information > 0 else None
