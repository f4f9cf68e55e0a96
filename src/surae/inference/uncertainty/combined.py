"""What a fit knows of its parameters together: the one uncertainty that all else is made of.

Every source is rows of shifts of all free parameters, in their units; the outer products of its
rows add up to its covariance, those of all sources to the combined one (GUM, JCGM 100:2008). What
is made of parameters has a gradient by them, shape (p,), and is as unsure as the rows move it.
"""

import math
from collections.abc import Mapping
from dataclasses import dataclass, replace

import numpy as np

from surae.base.frozen import Comparable, FrozenDict, read_only
from surae.base.normal import NORMAL
from surae.base.units import FloatArray
from surae.inference.coordinates import is_straight
from surae.inference.least_squares.contradiction import Contradiction
from surae.inference.least_squares.residuals import stiffness_valleys
from surae.inference.result import FitResult, PosteriorMode
from surae.inference.uncertainty.arms_and_paths import (
    SIZES,
    ArmsAndPaths,
    arms_and_paths,
    at_assumed,
)
from surae.inference.uncertainty.covariance import Covariance, inverse_root
from surae.inference.uncertainty.robust import RobustCovariance
from surae.model.source_table import SOURCES

#: The angle of the fit at which the ankle has its own zero [rad], of which measures alone are made.
ZERO = "zero_of_angle"
#: Part of each variance that keeps a covariance of fewer shifts than names from being singular.
_RIDGE = 1e-10


@dataclass(frozen=True, slots=True)
class Budget:
    """What makes one number unsure."""

    sd: float  #: Standard deviation, everything included.
    repeat: float  #: Standard deviation of the difference between two trials of the leg.
    shares: Mapping[str, float]  #: Parts of the variance by source; they add up to 1.
    without: Mapping[str, float]  #: Standard deviation that would be left with the source known.


@dataclass(frozen=True, slots=True, eq=False)
class Uncertainty(Comparable):
    """The combined uncertainty of a fit's free parameters."""

    #: Free parameters of the fit, those of the laboratory included; `ZERO` where it is not known.
    names: tuple[str, ...]
    #: `values`, `lower`, `upper`: estimates and bounds, in their units, shape (p,).
    values: FloatArray
    lower: FloatArray
    upper: FloatArray
    #: From where the logarithm is taken on which each is nearly normal, shape (p,): zero, or of a
    #: slack length the longest muscle; NaN where it is normal as it is.
    origin: FloatArray
    rows: Mapping[str, FloatArray]  #: By source, shape (r, p) each.
    #: How far a better model would move each, which no source stands for, shape (p,).
    shift: FloatArray
    dof: FloatArray  #: Degrees of freedom of each variance, for Student's t, shape (p,).
    at_bound: tuple[str, ...]  #: Those that lie at a bound.
    #: Those that the recordings cannot tell from others at all: they have no variance.
    lost: tuple[str, ...]
    #: How far each moves with the zero of the angle [1/rad], as measures do by `ZERO`.
    turned: Mapping[str, float] = FrozenDict()
    #: How parameters go with arms and paths, whose logarithms are among the names: all rows beside
    #: theirs are at those of the fit. None where they are taken for known.
    geometry: ArmsAndPaths | None = None

    @property
    def scale(self) -> FloatArray:
        """Derivative of each value by its logarithm, or 1, shape (p,)."""
        return np.where(np.isnan(self.origin), 1.0, self.values - self.origin)

    @property
    def is_of_noise_alone(self) -> bool:
        """Whether it is of a named model, which does not know what another trial shares."""
        return set(self.rows) <= {"noise", "angle_zero", *SIZES}

    @property
    def at_assumed(self) -> "Uncertainty":
        """The same leg with arms and paths as they are in the fit, of which torque is made."""
        known = self.geometry
        if known is None:
            return self
        of_fit = np.array([name not in known.by for name in self.names], dtype=bool)
        of_fit |= np.array([name in known.values for name in self.names], dtype=bool)
        sampled = np.array([name in known.by for name in self.names], dtype=bool)[of_fit]
        rows = {source: by[:, of_fit] * ~sampled for source, by in self.rows.items()}
        return replace(
            self,
            names=tuple(
                n for n, of_that_fit in zip(self.names, of_fit, strict=True) if of_that_fit
            ),
            **{
                name: getattr(self, name)[of_fit]
                for name in ("values", "lower", "upper", "origin", "shift", "dof")
            },
            rows=FrozenDict({source: by for source, by in rows.items() if by.any()}),
            geometry=None,
        )

    def along(self, name: str) -> FloatArray:
        """The gradient of a parameter itself."""
        gradient = {name: 1.0, ZERO: self.turned.get(name, 0.0)} if name != ZERO else {ZERO: 1.0}
        if self.geometry is not None and name not in self.geometry.by:
            gradient |= {scale: of[name] for scale, of in self.geometry.by.items() if name in of}
        return np.array([gradient.get(other, 0.0) for other in self.names])

    def covariance(self, *names: str) -> FloatArray:
        """Covariance of these, or of all beside the zero, in products of their units, (k, k)."""
        along = self._along(*names) if names else np.eye(len(self.names))
        parts = ((by @ along.T).T @ (by @ along.T) for by in self.rows.values())
        return sum(parts, np.zeros((len(along), len(along))))

    def _along(self, *names: str) -> FloatArray:
        return np.array([self.along(name) for name in names])

    def variances(self, gradient: FloatArray) -> dict[str, float]:
        """Variance by source."""
        moved = ((source, by @ gradient) for source, by in self.rows.items())
        return {source: float(each @ each) for source, each in moved}

    def sd(self, gradient: FloatArray) -> float:
        """Standard deviation, everything included."""
        return math.sqrt(sum(self.variances(gradient).values())) + self.bias(gradient) / NORMAL

    def bias(self, gradient: FloatArray) -> float:
        """By how much a better model would move it."""
        return abs(float(gradient @ self.shift))

    def repeat(self, gradient: FloatArray) -> float:
        """Standard deviation of what another trial of the leg would give, from this one."""
        parts = self.variances(gradient)
        twice = 1.0 if self.is_of_noise_alone else 2.0
        return math.sqrt(sum(twice * SOURCES[s].anew * part for s, part in parts.items()))

    def repeat_half_width(self, gradient: FloatArray) -> float:
        """Half of the 95 % interval of what another trial of the leg would give."""
        return self._quantile(gradient) * self.repeat(gradient)

    def deviations(self, gradient: FloatArray) -> tuple[float, float, float]:
        """The same in all; of what another session, mounted anew, has anew; and between models."""
        parts = self.variances(gradient)
        total = self.sd(gradient)
        anew = (SOURCES[s].anew_when(mounted=True) * part for s, part in parts.items())
        session = math.sqrt(sum(anew)) + self.bias(gradient) / NORMAL
        return total, session, math.sqrt(parts.get("model", 0.0))

    def half_width(self, gradient: FloatArray, *, biased: bool = True) -> float:
        """Half of the 95 % interval, with what a better model would move or without."""
        sd = math.sqrt(sum(self.variances(gradient).values()))
        return self._quantile(gradient) * sd + (self.bias(gradient) if biased else 0.0)

    def _quantile(self, gradient: FloatArray) -> float:
        """Student's t of the fewest degrees of freedom that an interval rests on."""
        from scipy.special import stdtrit

        fewest = self.dof[gradient != 0.0].min(initial=math.inf)
        return float(stdtrit(fewest, 0.975)) if math.isfinite(fewest) else NORMAL

    def budget(self, gradient: FloatArray) -> Budget:
        """What makes it unsure, source by source."""
        parts = self.variances(gradient)
        total = sum(parts.values())
        left = {s: math.sqrt(max(total - v, 0.0)) for s, v in parts.items() if SOURCES[s].knowable}
        shares = {s: v / total if total > 0.0 else 0.0 for s, v in parts.items()}
        return Budget(math.sqrt(total), self.repeat(gradient), FrozenDict(shares), left)

    def moved(self, j: int, by: float) -> float:
        """Value of one parameter, moved by so much on its scale, bounds or not."""
        value = float(self.values[j])
        origin = float(self.origin[j])
        return value + by if math.isnan(origin) else origin + (value - origin) * math.exp(by)

    def at(self, away: FloatArray) -> FloatArray:
        """Values within bounds that are `away` from the estimates on their scale, (…, p)."""
        with np.errstate(over="ignore", invalid="ignore"):
            grown = self.origin + self.scale * np.exp(np.clip(away, -50.0, 50.0))
        moved = np.where(np.isnan(self.origin), self.values + away, grown)
        low = np.minimum(self.lower, self.values)
        high = np.maximum(self.upper, self.values)
        return np.asarray(np.clip(moved, low, high))

    def goes_with_geometry(self, name: str) -> bool:
        """Whether a parameter is known only as well as arm and path are."""
        return self.geometry is not None and self.geometry.moves(name)

    def room(self, name: str) -> tuple[float, float]:
        """Bounds of a parameter, those of a search by as much wider as arms and paths may be."""
        j = self.names.index(name)
        low, high = sorted((float(self.lower[j]), float(self.values[j])))
        high = max(high, float(self.upper[j]))
        reach = 1.0 if self.geometry is None else self.geometry.reach(name)
        return (low / reach if low > 0.0 else low), (high * reach if high > 0.0 else high)

    def interval(self, name: str, half: float, *, centred: bool = True) -> tuple[float, float]:
        """Ends of an interval within bounds, of so much to either side on the parameter's scale.

        It is about the mean of what arms and paths may be, or about the value.
        """
        j = self.names.index(name)
        value = float(self.values[j])
        origin = float(self.origin[j])
        shift = 0.0
        if self.geometry is not None and self.goes_with_geometry(name) and value > 0.0:
            origin = 0.0
            shift = self.geometry.shift(name) if centred else 0.0
        low, high = self.room(name)
        if math.isnan(origin):
            ends = (value - half, value + half)
        else:
            size = value - origin
            by = [min(max(shift + way * half / size, -50.0), 50.0) for way in (-1.0, 1.0)]
            ends = (origin + size * math.exp(by[0]), origin + size * math.exp(by[1]))
        return min(max(min(ends), low), high), min(max(*ends, low), high)

    def draw(self, count: int, seed: int) -> FloatArray:
        """Values of legs that the fit leaves possible, shape (count, p), each with its opposite."""
        return self.legs_at(self.away(count, seed))

    def away(self, count: int, seed: int) -> FloatArray:
        """How far such legs are from the estimates on their scale, shape (count, p).

        Arms and paths apart, of which the others are told at those of the fit. Opposites are about
        `mean_away`; the order of the names changes nothing.
        """
        order = np.argsort(self.names)
        rows = np.concatenate([*self.rows.values(), np.zeros((1, len(self.names)))])
        along = replace(self, geometry=None)._along(*self.names)
        rows = (rows @ along.T / self.scale)[:, order]
        sd = np.sqrt(np.sum(rows**2, axis=0))
        unit = np.where(sd > 0.0, sd, 1.0)
        alike = (rows / unit).T @ (rows / unit)
        # axes of equal size would be any: rounding decided which legs are drawn
        root = np.empty_like(alike)
        root[order] = np.linalg.cholesky(alike + _RIDGE * np.eye(len(sd))) * sd[:, None]
        half = np.random.default_rng(seed).standard_normal(((count + 1) // 2, len(sd))) @ root.T
        half += self.shift / self.scale
        return np.concatenate([half, -half])[:count] + self.mean_away

    @property
    def mean_away(self) -> FloatArray:
        """How far arms and paths are from those of the fit on the average, shape (p,)."""
        centre = self.geometry.centre if self.geometry is not None else {}
        return np.array([centre.get(name, 0.0) for name in self.names])

    def legs_at(self, away: FloatArray) -> FloatArray:
        """Values of legs that are so far `away`, those that go with arms and paths moved along."""
        legs = self.at(away)
        if self.geometry is None:
            return legs
        columns = dict(zip(self.names, legs.T, strict=True))
        changed = self.geometry.moved(columns)
        return np.stack([changed.get(name, column) for name, column in columns.items()], axis=1)

    def moved_leg(self, name: str, by: float) -> dict[str, float]:
        """What changes of a leg where one of the names moves by so much on its scale."""
        there = {name: self.moved(self.names.index(name), by)}
        if self.geometry is None or name not in self.geometry.by:
            return there
        return self.geometry.moved(there)


def combined(
    result: FitResult,
    rows: Mapping[str, FloatArray],
    *,
    shift: Mapping[str, float] | None = None,
    dof: FloatArray | None = None,
    lost: tuple[str, ...] = (),
) -> Uncertainty:
    """The uncertainty of a fit, whose sources have these rows."""
    names = result.problem.free
    problem = result.problem
    values = np.array([result.values[name] for name in names])
    longest = {x0: length for _, x0, length in stiffness_valleys(problem)}
    origin = np.full(len(names), np.nan)
    for j, name in enumerate(names):
        if values[j] < longest.get(name, -np.inf):
            origin[j] = longest[name]
        elif values[j] > 0.0 and not is_straight(name):
            origin[j] = 0.0
    known = arms_and_paths(result)
    rows = {source: at_assumed(by, names, known) for source, by in rows.items()}
    zero = result.solution.zero_wider * np.radians(problem.settings.zero_sd)
    lower = problem.lower
    upper = problem.upper
    moved = np.array([(shift or {}).get(name, 0.0) for name in names])
    dof = np.full(len(names), np.inf) if dof is None else dof
    if not (np.isfinite(result.sse) and all(np.isfinite(by).all() for by in rows.values())):
        rows = {}
        lost = names
        zero = 0.0
        known = None
    if zero and "angle_zero" not in names:
        names = (*names, ZERO)
        values = np.append(values, 0.0)
        more = (np.nan, np.inf, 0.0)
        origin, dof, moved = map(np.append, (origin, dof, moved), more)
        lower = np.append(lower, -1.0)
        upper = np.append(upper, 1.0)
        rows = {source: np.pad(by, ((0, 0), (0, 1))) for source, by in rows.items()}
        rows["angle_zero"] = np.array([[0.0] * (len(names) - 1) + [zero]])
    made = Uncertainty(
        names,
        values,
        lower,
        upper,
        origin,
        FrozenDict({source: read_only(by) for source, by in rows.items()}),
        moved,
        dof,
        result.at_bound,
        lost,
        result.solution.turned,
    )
    return made if known is None or not rows else _with_geometry(made, known)


def _with_geometry(made: Uncertainty, known: ArmsAndPaths) -> Uncertainty:
    """The same with arms and paths that may be others."""
    new = [name for name in _columns(known) if name not in made.names]
    names = (*made.names, *new)
    more = len(new)
    wide = np.isin(names, tuple(known.by))
    rows = {source: np.pad(by, ((0, 0), (0, more))) for source, by in made.rows.items()}
    for source, each in known.rows.items():
        added = np.array([[row.get(name, 0.0) for name in names] for row in each])
        rows[source] = np.concatenate([rows[source], added]) if source in rows else added
    return replace(
        made,
        names=names,
        values=np.append(made.values, [known.values.get(name, 0.0) for name in new]),
        lower=np.where(wide, -np.inf, np.append(made.lower, [-np.inf] * more)),
        upper=np.where(wide, np.inf, np.append(made.upper, [np.inf] * more)),
        origin=np.append(made.origin, [np.nan] * more),
        rows=FrozenDict({source: read_only(by) for source, by in rows.items()}),
        shift=np.append(made.shift, [0.0] * more),
        dof=np.append(made.dof, [np.inf] * more),
        geometry=known,
    )


def _columns(known: ArmsAndPaths) -> tuple[str, ...]:
    """Logarithms of arms and paths, and the muscles' lengths at 0 rad, which paths move."""
    groups = [group for group in ("tri", "tib") if f"path_scale_{group}" in known.by]
    return (*known.by, *(f"length_zero_{group}" for group in groups))


def of_least_squares(
    result: FitResult,
    estimated: Covariance,
    robust: RobustCovariance | None,
    against: Contradiction | None,
) -> Uncertainty:
    """The uncertainty of a named model: of white noise, or of noise that is as the residual says.

    What lies at a bound may be anywhere between the bounds, and the others move with it. Where the
    data contradict the model, it reaches to where a better one has the parameters.
    """
    free = result.problem.free
    if not np.isfinite(result.sse):
        return combined(result, {})
    root = inverse_root(result.R, free, estimated.sigma2, result.bounded)
    dof = np.full(len(free), float(estimated.dof))
    rows = np.zeros((root.matrix.shape[1], len(free)))
    if robust is not None:
        rows = robust.rows
        dof[[free.index(name) for name in robust.names]] = robust.dof
    elif root.matrix.size:
        rows[:, list(root.positions)] = math.sqrt(estimated.sigma2) * root.matrix.T
    return combined(
        result,
        {"noise": rows},
        shift=None if against is None else against.shift,
        dof=dof,
        lost=tuple(free[root.positions[j]] for group in root.groups for j in group),
    )


def information_root(result: FitResult) -> FloatArray:
    """R whose σ²(RᵀR)⁻¹ is the covariance, σ² the residual's variance, shape (p, p).

    Of least squares the factor of the Jacobian; a posterior's comes from its covariance.
    """
    if not (isinstance(result.solution, PosteriorMode) and np.isfinite(result.sse)):
        return result.R
    covariance = result.solution.covariance
    problem = result.problem
    scale = 1.0 / np.sqrt(np.maximum(np.diag(covariance), 1e-300))
    scaled = covariance * scale * scale[:, None]
    if not np.isfinite(scaled).all():
        return covariance * np.nan
    lower = np.linalg.cholesky(scaled + 1e-10 * np.eye(len(scale)))
    root = np.linalg.inv(lower) * scale
    dof = max(problem.n - len(problem.free), 1)
    return np.asarray(np.sqrt(max(result.sse, 1e-300) / dof) * np.linalg.qr(root)[1])
