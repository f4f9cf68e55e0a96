"""How far a leg's arms and paths may be from the assumed ones, which no torque tells.

The group of `surae.model.symmetry` is pushed through what a fit knows: every source beside it is
told at the geometry that is assumed, and arm and path are as unsure as what is known of them.
Nothing is evaluated anew, and priors in the geometry's metres do not leak into it.

ln path = ln gear + ln arm, so that the two are correlated where the gear is what is known.
"""

import math
from collections.abc import Mapping
from dataclasses import dataclass
from typing import Any

import numpy as np

from surae.base.frozen import Comparable, FrozenDict
from surae.base.names import GEOMETRY_OF
from surae.base.normal import NORMAL
from surae.base.units import FloatArray
from surae.inference.problem import FitProblem
from surae.inference.result import FitResult
from surae.model import ModelOptions, ModelSpec
from surae.model.knowledge_priors import priors_of
from surae.model.laboratory import GROUPS as NUISANCES
from surae.model.laboratory import laboratory
from surae.model.source import Gaussian
from surae.model.source_table import ARM_SIZE, GEAR, GEAR_OF_TABLE
from surae.model.symmetry import (
    ARM,
    GROUPS,
    PATH,
    assumed_gear,
    films_of,
    generator,
    has_symmetry,
    moved,
)

#: Sources of uncertainty: size of the arm, of the path beside it, and what a film says of that.
SIZES = ("arm_size", "path_size")
_FILM = "film"
#: By how many standard deviations an interval may leave a parameter's bounds by another geometry.
_REACH = 3.0


@dataclass(frozen=True, slots=True, eq=False)
class ArmsAndPaths(Comparable):
    """How a fit's parameters go with arms and paths, and what is known of these."""

    spec: ModelSpec
    options: ModelOptions
    values: Mapping[str, float]  #: Every parameter of the fit.
    #: By `arm_scale_…` and `path_scale_…`, which are logarithms: derivatives of all that goes with
    #: them, in their units.
    by: Mapping[str, Mapping[str, float]]
    centre: Mapping[str, float]  #: Their means, from what they are in the fit.
    #: By source: standard deviations along each of them, one row of its covariance's root.
    rows: Mapping[str, tuple[Mapping[str, float], ...]]

    def moved(self, columns: Mapping[str, Any]) -> dict[str, Any]:
        """The parameters that change where arms and paths are as `columns` say, other values so.

        Numbers or arrays by name; the values of the other parameters are those at the fit's own
        arms and paths.
        """
        here = {**self.values, **columns}
        changed: dict[str, Any] = {}
        for group in GROUPS:
            scales = {scale: f"{scale}_{group}" for scale in (ARM, PATH)}
            if not {*scales.values()} & self.by.keys():
                continue
            by = dict.fromkeys(scales, 0.0)
            for scale, name in scales.items():
                before = self.values.get(name, 0.0)
                if name in self.by:
                    by[scale] = here.get(name, before) - before
                    here[name] = before
            arguments = {"arm": by[ARM], "path": by[PATH]}
            changed |= moved(here, self.spec, self.options, group, **arguments)
        return changed

    def shift(self, name: str) -> float:
        """How far a parameter's mean lies from its value in the fit, on its logarithm."""
        size = abs(self.values[name]) or 1.0
        return sum(self.centre[p] * of.get(name, 0.0) for p, of in self.by.items()) / size

    def moves(self, name: str) -> bool:
        """Whether a parameter, by nature positive, is known only as well as arm and path are."""
        signed = any(p.signed for p in self.spec.parameters if p.name == name)
        return not signed and any(name in of for of in self.by.values())

    def sd(self, name: str) -> float:
        """Standard deviation of a parameter's logarithm by arms and paths alone."""
        size = abs(self.values[name]) or 1.0
        return math.hypot(
            *(
                sum(sd * self.by[p].get(name, 0.0) for p, sd in row.items()) / size
                for rows in self.rows.values()
                for row in rows
            )
        )

    def reach(self, name: str) -> float:
        """Factor by which a parameter may lie beyond its bounds."""
        if not self.values.get(name) or not self.moves(name):
            return 1.0
        return math.exp(min(_REACH * self.sd(name) + abs(self.shift(name)), 5.0))

    def about(
        self, name: str, ends: tuple[float | None, float | None]
    ) -> tuple[float | None, float | None]:
        """An interval at the fit's arm and path, with what these may be, on a logarithm.

        What holds at the fit's own arm and path stays within it. An end that is open stays so; one
        of another sign than the value stays where it is.
        """
        value = self.values[name]
        if not (self.moves(name) and value > 0.0):
            return ends
        return widened(ends, value, NORMAL * self.sd(name), self.shift(name))

    def legs(self, columns: Mapping[str, FloatArray], seed: int) -> dict[str, FloatArray]:
        """Columns of draws at the fit's arms and paths, moved to such as may be."""
        rng = np.random.default_rng([seed, 3])
        count = len(next(iter(columns.values())))
        logs = {p: np.full(count, self.values.get(p, 0.0) + by) for p, by in self.centre.items()}
        for rows in self.rows.values():
            for row in rows:
                scores = rng.standard_normal(count)
                for p, sd in row.items():
                    logs[p] += sd * scores
        changed = self.moved({**columns, **logs})
        return {name: changed.get(name, value) for name, value in columns.items()}


def widened(
    ends: tuple[float | None, float | None], value: float, more: float, shift: float = 0.0
) -> tuple[float | None, float | None]:
    """An interval of a `value` with `more` to both sides, on a logarithm, as far as it holds."""
    least, most = ends
    if least is not None and least > 0.0:
        away = -math.log(least / value)
        least *= math.exp(min(shift + away - math.hypot(away, more), 0.0))
    if most is not None and most > 0.0:
        away = math.log(most / value)
        most *= math.exp(max(shift + math.hypot(away, more) - away, 0.0))
    return least, most


def arms_and_paths(result: FitResult) -> ArmsAndPaths | None:
    """What a fit's arms and paths may be; None where its model ties muscles to the assumed ones."""
    problem = result.problem
    by = dict[str, Mapping[str, float]]()
    centre = dict[str, float]()
    rows = dict[str, list[Mapping[str, float]]]()
    for group in GROUPS:
        if not has_symmetry(problem.spec, group):
            continue
        for source, row, means in _known(result, group):
            names = [name for name in row if row[name] > 0.0]
            if not names:
                continue
            rows.setdefault(source, []).append(FrozenDict({n: row[n] for n in names}))
            for name in names:
                scale = name.removesuffix(f"_{group}")
                slopes = generator(result.values, problem.spec, problem.options, group, scale)
                by[name] = FrozenDict(slopes)
                centre[name] = means[name]
    if not by:
        return None
    return ArmsAndPaths(
        problem.spec,
        problem.options,
        FrozenDict(result.values),
        FrozenDict(by),
        FrozenDict(centre),
        FrozenDict({source: tuple(each) for source, each in rows.items()}),
    )


def assumed_sd(
    values: Mapping[str, float],
    spec: ModelSpec,
    options: ModelOptions,
    beliefs: Mapping[str, Gaussian],
) -> dict[str, float]:
    """Standard deviation of each parameter of a leg by arms and paths of which nothing is stated.

    As a part of the value; `beliefs` has the scales of films that are to be made.
    """
    variances = dict[str, float]()
    for group in GROUPS:
        if not has_symmetry(spec, group):
            continue
        arm, path = (generator(values, spec, options, group, scale) for scale in (ARM, PATH))
        films = films_of(group, tuple(beliefs))
        of_path = math.hypot(*(1.0 / beliefs[n].sd for n in films)) ** -1.0 if films else GEAR.sd
        along = 0.0 if films else 1.0  # a film tells the path whatever the arm is
        for name in {*arm, *path} & values.keys():
            size = abs(values[name])
            if size > 0.0:
                both = ARM_SIZE * (arm.get(name, 0.0) + along * path.get(name, 0.0))
                variances[name] = (both**2 + (of_path * path.get(name, 0.0)) ** 2) / size**2
    return {name: math.sqrt(variance) for name, variance in variances.items()}


def _known(result: FitResult, group: str) -> list[tuple[str, dict[str, float], dict[str, float]]]:
    """What is known of a group's arm and path: sources, their standard deviations, and means."""
    problem = result.problem
    arm = f"{ARM}_{group}"
    path = f"{PATH}_{group}"
    values = result.values
    stated = _stated(problem)
    size = stated.get(arm) or Gaussian(0.0, ARM_SIZE)
    means = {arm: size.mean - values.get(arm, 0.0)}
    films = films_of(group, problem.free)
    if films and path in problem.free:  # the film tells the path, and the fit knows how well
        return [(SIZES[0], {arm: size.sd}, means)]
    if path in stated:
        means[path] = stated[path].mean - values.get(path, 0.0)
        return [(SIZES[0], {arm: size.sd}, means), (SIZES[1], {path: stated[path].sd}, means)]
    gear = assumed_gear(problem.options, group)
    gear *= math.exp(values.get(path, 0.0) - values.get(arm, 0.0))
    known = GEAR
    if _is_own(problem):
        known = Gaussian(math.log(assumed_gear(problem.options, group)), GEAR_OF_TABLE)
    if not math.isfinite(gear):
        gear = math.exp(known.mean)
    means[path] = known.mean - math.log(gear) + means[arm]
    if films:
        seen = films[0]
        sd = result.solution.beliefs[seen].sd if seen in result.solution.beliefs else known.sd
        whole = 1.0 / (sd**-2 + (known.sd**2 + size.sd**2) ** -1)
        film = math.log(max(1.0 + values[seen], 0.05))
        means[path] = film + whole / (known.sd**2 + size.sd**2) * (means[path] - film)
        return [(SIZES[0], {arm: size.sd}, means), (_FILM, {path: math.sqrt(whole)}, means)]
    return [
        (SIZES[0], {arm: size.sd, path: size.sd}, means),
        (SIZES[1], {path: known.sd}, means),
    ]


def _is_own(problem: FitProblem) -> bool:
    """Whether the geometry is the person's own."""
    return problem.settings.geometry_of == GEOMETRY_OF[1]


def _stated(problem: FitProblem) -> dict[str, Gaussian]:
    """What was stated of arms and paths, as logarithms over the assumed ones."""
    settings = problem.settings
    stated = dict[str, Gaussian]()
    if _is_own(problem):
        priors = laboratory(measured=True, joint=problem.options.anatomy)
        stated |= {n: priors[n] for n in (f"{ARM}_{group}" for group in GROUPS)}
    if settings.knowledge is not None:
        known = priors_of(settings.knowledge)
        stated |= {n: Gaussian(*by) for n, by in known.items() if n.startswith(ARM)}
    by_user = {} if isinstance(settings.nuisances, str) else settings.nuisances
    for name, (mean, sd) in (*problem.options.anatomy.nuisances.items(), *by_user.items()):
        for each in NUISANCES.get(name, (name,)):
            if each.startswith((ARM, PATH)):
                stated[each] = Gaussian(float(mean), float(sd))
    return stated


def at_assumed(rows: FloatArray, names: tuple[str, ...], known: ArmsAndPaths | None) -> FloatArray:
    """Shifts of all parameters by sources that a fit sampled arms and paths with, without these.

    What goes along with a sampled arm or path is taken out, so that the rest is how unsure the leg
    is at the arm and path of the fit. Shape (r, p) each.
    """
    rows = rows.copy()
    for name, of in (known.by if known else {}).items():
        if name not in names:
            continue
        along = np.array([of.get(other, 0.0) for other in names])
        rows -= np.outer(rows[:, names.index(name)], along)
    return rows
