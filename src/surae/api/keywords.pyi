"""The keywords of `surae.fit` for type checkers: one for each setting, held to them by a test."""

from collections.abc import Mapping, Sequence
from os import PathLike
from typing import Any, TypedDict

from surae.model import GeometryTable, ModelOptions
from surae.model.joint import Joint
from surae.model.knowledge import Knowledge
from surae.signals import Weighting

_Pairs = Mapping[str, tuple[float, float]]

class FitKeywords(TypedDict, total=False):
    """See `FitSettings` and `ModelOptions`; None is not given."""

    options: ModelOptions | None
    fixed: Mapping[str, float] | None
    free: str | Sequence[str] | None
    start: Mapping[str, float] | None
    bounds: _Pairs | None
    priors: str | _Pairs | tuple[str, _Pairs] | None
    population: str | None
    weights: Weighting | Sequence[Weighting] | None
    loss: str | None
    normalise: str | None
    prepared: bool | None
    preparation: Mapping[str, Any] | None
    nuisances: str | _Pairs | None
    starts: int | None
    seed: int | None
    geometry_of: str | None
    angle_zero_sd: float | None
    knowledge: str | PathLike[str] | Knowledge | None
    geometry: str | PathLike[str] | GeometryTable | None
    tendon_strain: str | None
    integrator: str | None
    theta_foot: float | None
    vmax_factor: float | None
    x_ref_tri: float | None
    x_ref_tib: float | None
    emg_ref: tuple[float, float, float, float] | None
    joint: str | PathLike[str] | Joint | None
