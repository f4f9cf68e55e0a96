"""What a search moves: parameters as they are or on a logarithm, with bounds and priors."""

from collections.abc import Mapping, Sequence
from dataclasses import replace

import numpy as np
import numpy.typing as npt

from surae.base.units import FloatArray
from surae.inference.least_squares.residuals import valleys_among
from surae.inference.metres import OwnMetres
from surae.inference.problem import FitProblem
from surae.model.laboratory import EACH_TRIAL, GROUPS
from surae.model.registry import PARAMETERS
from surae.model.source import Gaussian

#: Least value of a parameter on a logarithm whose bound is zero, as a part of its prior's median.
_FLOOR = 1e-2
#: What each trial of a session has for itself, where several are fitted jointly.
_EACH = tuple(name for group in EACH_TRIAL for name in GROUPS[group])


def is_straight(name: str) -> bool:
    """Whether a parameter is searched as it is; all others are on a logarithm."""
    return name in PARAMETERS and PARAMETERS[name].straight


class Coordinates:
    """The q coordinates z of a problem: what recordings share, then what each has for itself.

    A single recording's own, its zero and its EMG at rest, are parameters as any other.
    """

    def __init__(self, problem: FitProblem, priors: Mapping[str, Gaussian]) -> None:
        self.problem = problem
        self.priors = priors
        several = len(problem.inputs) if len(problem.inputs) > 1 else 0
        #: Of each recording, in its turn behind the shared ones; empty for a single one.
        self.per_recording = tuple(n for n in problem.free if several and n in _EACH)
        self.names = tuple(n for n in problem.free if n not in self.per_recording)
        self.columns, self.own_columns = (
            [problem.spec.names.index(n) for n in names]
            for names in (self.names, self.per_recording)
        )
        columns = [problem.free.index(n) for n in self.names]
        self._lower = problem.lower[columns]
        self._upper = problem.upper[columns]
        self._log = ~straight(self.names)
        #: Stiffness and lengths of filmed muscles are searched along the assumed path.
        self.metres = OwnMetres.of(problem)
        #: Parameter that each coordinate is of.
        self.of = coordinates = (*self.names, *self.per_recording * several)
        #: Means and 1/sd of the priors, and bounds, of every coordinate, shape (q,).
        self.mean = np.array([priors[n].mean for n in coordinates])
        self.weight = np.array([1.0 / priors[n].sd for n in coordinates])
        self.lower, self.upper = np.array([problem.limits[n] for n in coordinates]).T.copy()
        for j in np.flatnonzero(self._log):
            self.lower[j] = np.log(max(self.lower[j], _FLOOR * np.exp(self.mean[j])))
            self.upper[j] = np.log(self.upper[j])
        #: Positions of a stiffness k and slack length x0 that trade off; the longest muscle [m].
        self.valleys = valleys_among(problem, self.names)

    def start(self, values: Mapping[str, float]) -> FloatArray:
        """Coordinates of values by name, of the prior's mean where there is none."""
        z = self.mean.copy()
        if self.metres:
            whole = {**dict.fromkeys(self.problem.spec.names, 0.0), **values}
            along = self.metres.assumed(np.array([whole[n] for n in self.problem.spec.names]))
            of_assumed = dict(zip(self.problem.spec.names, along.tolist(), strict=True))
            values = {name: of_assumed.get(name, value) for name, value in values.items()}
        for j, name in enumerate(self.names):
            if name in values:
                z[j] = np.log(max(values[name], 1e-300)) if self._log[j] else values[name]
        for j in range(len(self.names), len(z)):
            z[j] = values.get(self.of[j], z[j])
        return np.asarray(np.clip(z, self.lower, self.upper))

    def like(self, other: "Coordinates", z: FloatArray) -> FloatArray:
        """Coordinates of the same recordings taken over; means of the priors of what is new."""
        known = dict(zip(_numbered(other.of), z, strict=True))
        new = zip(_numbered(self.of), self.mean, strict=True)
        values = np.array([known.get(key, mean) for key, mean in new])
        return np.asarray(np.clip(values, self.lower, self.upper))

    def values(self, z: FloatArray, number: int | None = None) -> FloatArray:
        """The whole parameter vector; of one recording, or with the mean of what each has."""
        shared = z[: len(self.names)]
        values = self.problem.base.copy()
        with np.errstate(over="ignore"):
            natural = np.where(self._log, np.exp(shared), shared)
        values[self.columns] = np.clip(natural, self._lower, self._upper)
        if self.per_recording:
            each = self.each(z)
            values[self.own_columns] = each.mean(axis=0) if number is None else each[number]
        return self.metres.own(values) if self.metres else values

    def each(self, z: FloatArray) -> FloatArray:
        """What each recording has for itself, shape (recordings, own)."""
        return z[len(self.names) :].reshape(len(self.problem.inputs), -1)

    def of_recording(self, number: int) -> npt.NDArray[np.int64]:
        """Where among the coordinates those are that move a recording: shared ones, its own."""
        shared = len(self.names)
        each = len(self.per_recording)
        return np.append(np.arange(shared), shared + number * each + np.arange(each))

    def by_name(self, z: FloatArray, number: int | None = None) -> dict[str, float]:
        """All parameters by name."""
        return dict(zip(self.problem.spec.names, self.values(z, number).tolist(), strict=True))

    def scale(self, z: FloatArray) -> FloatArray:
        """∂value/∂z of the parameters, each by its own, shape (len(names),)."""
        by = np.asarray(np.exp(np.where(self._log, z[: len(self.names)], 0.0)))
        return by * self.metres.factor(self.values(z))[self.columns] if self.metres else by

    def searched(self, rows: FloatArray, z: FloatArray) -> FloatArray:
        """Derivatives by z from those by the parameters, shape (len(names), n) each."""
        moved = rows * self.scale(z)[:, None]
        if self.metres:
            for at, slopes in self.metres.by_path(self.values(z)).items():
                moved[self.columns.index(at)] += slopes[self.columns] @ rows
        return np.asarray(moved)

    def in_metres(self, priors: Mapping[str, Gaussian], z: FloatArray) -> dict[str, Gaussian]:
        """Priors of what is searched, in the metres of the paths at z."""
        if not self.metres:
            return dict(priors)
        values = self.values(z)
        factor = self.metres.factor(values)
        whole = np.zeros(len(values))
        whole[self.metres.scales] = values[self.metres.scales]
        moved = {}
        for name, prior in priors.items():
            at = self.problem.spec.names.index(name)
            if name not in self.names or at in self.metres.scales:
                moved[name] = prior
            elif is_straight(name):
                whole[at] = prior.mean
                mean = float(self.metres.own(whole)[at])
                moved[name] = replace(prior, mean=mean, sd=float(factor[at]) * prior.sd)
            else:
                moved[name] = replace(prior, mean=prior.mean + float(np.log(factor[at])))
        return moved

    def prior_cost(self, z: FloatArray) -> float:
        """−2 ln of the priors of z."""
        return float(np.sum((self.weight * (z - self.mean)) ** 2))

    def curved(self, z: FloatArray, step: FloatArray) -> FloatArray:
        """A step along the valley of k and x0, in which φ = k·(x_ref − x0) moves straight."""
        moved = z + step
        for j_k, j_x0, x_ref in self.valleys:
            k = np.exp(z[j_k])
            reach = x_ref - z[j_x0]
            phi = k * (reach + reach * step[j_k] - step[j_x0])
            moved[j_x0] = x_ref - phi / np.exp(min(moved[j_k], z[j_k] + 2.0))
        return np.asarray(np.clip(moved, self.lower, self.upper))


def _numbered(names: Sequence[str]) -> list[tuple[str, int]]:
    """Each name, and how often it came before: what each recording has comes in their order."""
    return [(name, names[:j].count(name)) for j, name in enumerate(names)]


def straight(names: Sequence[str]) -> npt.NDArray[np.bool_]:
    """Which parameters are searched as they are."""
    return np.array([is_straight(name) for name in names], dtype=bool)
