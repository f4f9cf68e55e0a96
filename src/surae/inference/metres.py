"""Lengths of a filmed muscle in the search: in the metres of the assumed path, until a film tells.

Torque knows no metre (`surae.model.symmetry`): what priors say of stiffness and lengths holds along
the assumed path, and what a fascicle's film shows of the muscle's own path is of no other value's
concern. So k·μ, x0/μ, l0/μ, dlt/μ are searched, μ beside them, and no prior in the metres of the
assumed path leaks into μ.
"""

from collections.abc import Sequence
from dataclasses import dataclass, replace

import numpy as np
import numpy.typing as npt

from surae.base.units import FloatArray
from surae.inference.problem import FitProblem
from surae.model.symmetry import GROUPS, PATH, films_of, length_at_rest, powers_of_path
from surae.signals import ModelInputs


def filmed_paths(inputs: Sequence[ModelInputs]) -> frozenset[str]:
    """Parameters by which the paths of filmed muscles are longer than the assumed ones."""
    seen = {film.channel.rpartition("_")[2] for each in inputs for film in each.films}
    scales = tuple(f"film_scale_{muscle}" for muscle in seen)
    return frozenset(f"{PATH}_{group}" for group in GROUPS if films_of(group, scales))


@dataclass(frozen=True, slots=True)
class _Path:
    """One filmed path: where its scale is among all parameters, and what goes with it."""

    scale: int
    at: npt.NDArray[np.intp]  #: Free parameters that are lengths, or one over a length.
    power: FloatArray  #: By which power of μ each goes.
    zero: FloatArray  #: Added to each before it is a length that goes so [m].


@dataclass(frozen=True)
class OwnMetres:
    """The metres of the paths that films tell, and those of the assumed paths."""

    paths: tuple[_Path, ...]

    @classmethod
    def of(cls, problem: FitProblem) -> "OwnMetres":
        """Of a problem; of none where nothing is filmed, or a film's path is held."""
        names = problem.spec.names
        made = []
        for group in GROUPS:
            scale = f"{PATH}_{group}"
            if scale not in filmed_paths(problem.inputs) or scale not in problem.free:
                continue
            powers = {n: p for n, p in powers_of_path(group).items() if n in problem.free}
            rests = {f"length_zero_{group}": length_at_rest(problem.options, group)}
            made.append(
                _Path(
                    names.index(scale),
                    np.array([names.index(n) for n in powers], dtype=np.intp),
                    np.array(list(powers.values()), dtype=float),
                    np.array([rests.get(n, 0.0) for n in powers]),
                )
            )
        return cls(tuple(made))

    def __bool__(self) -> bool:
        return bool(self.paths)

    @property
    def scales(self) -> list[int]:
        """Where the paths' scales are among all parameters."""
        return [path.scale for path in self.paths]

    def own(self, values: FloatArray) -> FloatArray:
        """Parameters in the metres of their own paths, from those along the assumed ones, (P,)."""
        return self._moved(values, 1.0)

    def assumed(self, values: FloatArray) -> FloatArray:
        """The way back."""
        return self._moved(values, -1.0)

    def _moved(self, values: FloatArray, way: float) -> FloatArray:
        values = values.copy()
        for path in self.paths:
            factor = np.exp(way * path.power * values[path.scale])
            values[path.at] = factor * (values[path.at] + path.zero) - path.zero
        return values

    def factor(self, values: FloatArray) -> FloatArray:
        """Derivative of each of them by the same along the assumed path, shape (P,)."""
        by = np.ones(len(values))
        for path in self.paths:
            by[path.at] = np.exp(path.power * values[path.scale])
        return by

    def by_path(self, values: FloatArray) -> dict[int, FloatArray]:
        """Derivatives of all parameters by each path's scale, at these values, shape (P,)."""
        slopes = {}
        for path in self.paths:
            slopes[path.scale] = np.zeros(len(values))
            slopes[path.scale][path.at] = path.power * (values[path.at] + path.zero)
        return slopes

    def limits(self, problem: FitProblem, values: FloatArray, *, back: bool = False) -> FitProblem:
        """The problem with the bounds of a search in the metres of the paths, or `back`."""
        if not self:
            return problem
        ends = []
        for bounds in (problem.lower, problem.upper):
            whole = values.copy()
            whole[problem.columns] = bounds
            for path in self.paths:
                whole[path.scale] = values[path.scale]
            moved = (self.assumed if back else self.own)(whole)[problem.columns]
            fixed = np.isin(problem.columns, [path.scale for path in self.paths])
            ends.append(np.where(fixed, bounds, moved))
        return replace(problem, lower=ends[0], upper=ends[1])


def moved_by_film(problem: FitProblem, name: str) -> str:
    """The scale of the filmed path that a parameter goes with; empty where it goes with none."""
    if name not in problem.free:
        return ""
    at = problem.spec.names.index(name)
    paths = OwnMetres.of(problem).paths
    return next((problem.spec.names[p.scale] for p in paths if at in p.at), "")
