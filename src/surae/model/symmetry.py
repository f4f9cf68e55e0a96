"""What leaves every torque exactly as it is: force against arm, and metre against path.

Of each muscle group the torque of the models knows neither the unit of force nor that of length:

    λ   arm·λ,  g/λ,  x0 + ln λ/k,  F̄toe/λ,  ε0·h(F̄toe)/h(F̄toe/λ)
    μ   dx/dθ·μ,  x(0)·μ,  k/μ,  x0·μ,  l0·μ,  ε0·μ,  and what else is a length or an inverse one

with h of `toe_reach`, so that the tendon's toe stays as long and is weaker by λ. Both act on the
muscles' equations (8) and (12) to (21) and on their path alone; vmax is in optimal lengths. So
stiffness coefficients, lengths, tendon strain and EMG weights are known only as well as arms and
paths are, which no recording of torque, angle and EMG tells. A reflex to length begins where tissue
pulls 1 N, which λ moves: of it alone the first is not exact.
"""

import math
from collections.abc import Mapping, Sequence
from typing import Any

import numpy as np

from surae.model.geometry import paths
from surae.model.options import ModelOptions
from surae.model.registry import ModelSpec, with_optional

#: The muscle groups, in the order of everything that has two.
GROUPS = ("tri", "tib")
#: The logarithms of λ and μ, as parameters of the leg: what its arm, and its path's slope, is over
#: the assumed one.
ARM = "arm_scale"
PATH = "path_scale"
#: By which power of μ a parameter of a group goes.
_LENGTHS = {"k": -1, "x0": 1, "l0": 1, "dlt": 1, "path_bend": 1, "reflex": -1, "reflex_length": -1}
#: What is a force for a length or speed, beside the EMG's weights: it goes by 1/λ.
_FORCES = ("reflex", "reflex_length")
#: Parameters by which a model's muscles follow from their path; a model that lacks one of them ties
#: the muscle to the assumed path.
_NEEDED = ("k", "x0", "l0")
#: Films that see each group.
_FILMS = {"tri": ("gl", "sol", "gm", "tri"), "tib": ("ta", "tib", "tib2")}


def toe_reach(toe: Any, shape: Any) -> Any:
    """Elongation at which a tendon's toe ends over that at its largest force, equation (20).

    h(p) = p·kt·e^kt/((1 − p)(e^kt − 1) + p·kt·e^kt), p = F̄toe, kt = ktoe.

    Parameters
    ----------
    toe : float or ndarray
        F̄toe, force at which the toe ends over the largest [-].
    shape : float or ndarray
        ktoe [-].

    Returns
    -------
    float or ndarray
        e_toe/ε0 [-].
    """
    grown = np.exp(shape)
    return toe * shape * grown / ((1.0 - toe) * (grown - 1.0) + toe * shape * grown)


def weights_of(spec: ModelSpec, group: str) -> tuple[str, ...]:
    """EMG weights of a group's muscles."""
    return spec.weights[1:] if group == "tri" else spec.weights[:1]


def has_symmetry(spec: ModelSpec, group: str) -> bool:
    """Whether the group's muscle stays as good a description where arm and path are others."""
    return all(f"{name}_{group}" in spec.names for name in _NEEDED)


def tied_to_geometry(spec: ModelSpec) -> frozenset[str]:
    """Parameters that a model without the symmetry ties to its assumed arm and path."""
    tied: set[str] = set()
    for group in GROUPS:
        if not has_symmetry(spec, group):
            tied |= {*weights_of(spec, group), *(f"{name}_{group}" for name in (*_LENGTHS, "b"))}
            tied |= {"F0"}
    return frozenset(tied.intersection(spec.names))


def with_paths(spec: ModelSpec) -> ModelSpec:
    """The model with arms and paths of its own, as `moved` needs it."""
    return with_optional(spec, (f"{ARM}_tri", "length_zero_tri"))


def moved(
    values: Mapping[str, Any],
    spec: ModelSpec,
    options: ModelOptions,
    group: str,
    *,
    arm: Any = 0.0,
    path: Any = 0.0,
) -> dict[str, Any]:
    """The parameters of a leg of the same torque with another arm and path.

    Parameters
    ----------
    values : mapping of str to float or ndarray
        Every parameter of the model.
    spec : ModelSpec
        The model.
    options : ModelOptions
        Its switches: which geometry is assumed.
    group : {"tri", "tib"}
        Muscle group.
    arm : float or ndarray
        ln λ, of the arm over what it is with `values` [-].
    path : float or ndarray
        ln μ, of the path's slope [-].

    Returns
    -------
    dict of str to float or ndarray
        What changes, `arm_scale`, `path_scale` and `length_zero` of the group among it.
    """
    stretch = np.exp(path)
    changed = {
        f"{name}_{group}": values[f"{name}_{group}"] * stretch**power
        for name, power in _LENGTHS.items()
        if f"{name}_{group}" in values
    }
    for name in (*weights_of(spec, group), *(f"{name}_{group}" for name in _FORCES)):
        if name in values:
            changed[name] = changed.get(name, values[name]) * np.exp(-arm)
    k = f"k_{group}"
    x0 = f"x0_{group}"
    if k in changed and x0 in changed:
        changed[x0] = changed[x0] + arm / changed[k]
    toe = f"pt_{group}"
    if toe in values:
        before = values[toe]
        changed[toe] = before * np.exp(-arm)
        old, new = (toe_reach(each, values[f"kt_{group}"]) for each in (before, changed[toe]))
        changed[f"dlt_{group}"] = changed[f"dlt_{group}"] * old / new
    for film in films_of(group, tuple(values)):
        changed[film] = (1.0 + values[film]) / stretch - 1.0
    zero = f"length_zero_{group}"
    rest = length_at_rest(options, group)
    changed[zero] = stretch * (rest + values.get(zero, 0.0)) - rest
    for scale, by in ((ARM, arm), (PATH, path)):
        changed[f"{scale}_{group}"] = values.get(f"{scale}_{group}", 0.0) + by
    return changed


def length_at_rest(options: ModelOptions, group: str) -> float:
    """Assumed length of muscle and tendon at 0 rad, but for the tendon's slack length [m]."""
    return float(_neutral(options, group).length[0])


def assumed_gear(options: ModelOptions, group: str) -> float:
    """Slope of the assumed path over the arm at 0 rad, (dx/dθ)/r [-]; both signed, so above zero.

    Of equation (9) 0.36 of the triceps and 0.68 of the tibialis; 1 where paths conserve work. NaN
    where a table has none.
    """
    at = _neutral(options, group)
    arm = float(at.arm[0])
    slope = float(at.slope[0])
    return slope / arm if arm * slope > 0.0 else math.nan


def bend_of_work(options: ModelOptions, group: str) -> float:
    """`path_bend` at which the assumed path bends as its arm does at 0 rad [m/rad²].

    ½·((dx/dθ)·(dr/dθ)/r − d²x/dθ²): a path that does work travels its arm, times a share that does
    not change with the angle. 0 where paths conserve work, −1.9 mm/rad² of the triceps and
    −5.8 of the tibialis by equation (9), which does not bend; 0 too where a table has no arm there.
    """
    at = _neutral(options, group)
    arm = float(at.arm[0])
    if not arm:
        return 0.0
    slopes = float(np.ravel(at.arm_slope)[0]), float(np.ravel(at.bend)[0])
    return 0.5 * (float(at.slope[0]) * slopes[0] / arm - slopes[1])


def _neutral(options: ModelOptions, group: str) -> Any:
    at = np.zeros(1)
    return paths(angle=at, velocity=at, options=options)[GROUPS.index(group)]


def generator(
    values: Mapping[str, float],
    spec: ModelSpec,
    options: ModelOptions,
    group: str,
    scale: str,
) -> dict[str, float]:
    """Derivatives of `moved` at these values by ln λ (`ARM`) or ln μ (`PATH`), by parameter.

    By ln λ: g −g, x0 1/k, F̄toe −F̄toe, ε0 ε0·(1 − F̄toe·(kt·e^kt − e^kt + 1)/B) with the lower part
    B of `toe_reach`; by ln μ a power of a length times the value.
    """
    lengths = {f"{name}_{group}": name for name in _LENGTHS}
    lengths = {full: name for full, name in lengths.items() if full in values}
    slopes = {f"{scale}_{group}": 1.0}
    if scale == PATH:
        slopes |= {full: _LENGTHS[name] * values[full] for full, name in lengths.items()}
        films = films_of(group, tuple(values))
        slopes |= {film: -1.0 - values[film] for film in films}
        zero = f"length_zero_{group}"
        slopes[zero] = length_at_rest(options, group) + values.get(zero, 0.0)
        return slopes
    forces = (*weights_of(spec, group), *(f"{name}_{group}" for name in _FORCES))
    slopes |= {name: -values[name] for name in forces if name in values}
    slopes[f"x0_{group}"] = 1.0 / values[f"k_{group}"]
    if f"pt_{group}" in values:
        toe = values[f"pt_{group}"]
        grown = math.exp(values[f"kt_{group}"])
        rise = values[f"kt_{group}"] * grown
        below = (1.0 - toe) * (grown - 1.0) + toe * rise
        slopes[f"pt_{group}"] = -toe
        longer = 1.0 - toe * (rise - grown + 1.0) / below
        slopes[f"dlt_{group}"] = values[f"dlt_{group}"] * longer
    return slopes


def powers_of_path(group: str) -> dict[str, float]:
    """By which power of μ each parameter of a group goes that is a length, or one over a length.

    Of `length_zero`, the length at 0 rad with it, `length_at_rest`.
    """
    return {f"{name}_{group}": float(p) for name, p in _LENGTHS.items()} | {
        f"length_zero_{group}": 1.0
    }


def films_of(group: str, names: Sequence[str]) -> tuple[str, ...]:
    """Parameters among these by which a film's changes of length differ from the group's."""
    films = (f"film_scale_{film}" for film in _FILMS[group])
    return tuple(name for name in films if name in names)
