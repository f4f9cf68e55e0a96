"""Which option has an effect on which model: tried on the product, never written by hand."""

from collections.abc import Mapping
from dataclasses import dataclass, field
from pathlib import Path
from typing import Any

from surae.base.errors import InputError
from surae.base.names import AUTO, MODELS
from surae.settings import FitSettings
from surae.signals import Weighting

_EXAMPLES = Path(__file__).parents[2] / "examples"
_WRIST = {
    "joint": str(_EXAMPLES / "wrist" / "joint.toml"),
    "geometry": str(_EXAMPLES / "wrist" / "geometry.csv"),
}
_TABLE = {"geometry": str(Path(__file__).parents[2] / "tests" / "data" / "geometry.csv")}


@dataclass(frozen=True, slots=True)
class Tried:
    """An option as it is tried."""

    given: Mapping[str, Any]  #: Keywords of `surae.fit`.
    beside: Mapping[str, Any] = field(default_factory=dict)  #: What it needs, given without it too.
    where: str = ""  #: Where it shows, where that is not in the parameters.


#: One trial or more of each option; of what has parts that differ, each part.
TRIED = {
    "fixed": Tried({"fixed": {"m": 1.5}}),
    "free": Tried({"free": ["reflex"]}),
    "start": Tried({"start": {"m": 1.2}}, where="where the search begins (`starts`)"),
    "bounds": Tried({"bounds": {"m": (1.0, 6.0)}}),
    "priors": Tried({"priors": {"m": (2.0, 0.1)}}),
    "population": Tried({"population": "healthy"}),
    "weights": Tried({"weights": Weighting(((0.0, 2.0, 0.0),))}),
    "normalise": Tried({"normalise": "session"}),
    "prepared": Tried({"prepared": True}),
    "preparation": Tried({"preparation": {"bessel_hz": 8.0}}),
    "seed": Tried({"seed": 5}, where="random starts, `seed`; of auto those of its simplest member"),
    "angle_zero_sd": Tried({"angle_zero_sd": 0.5}, where="intervals of measures at an angle"),
    "knowledge: angle_zero_deg": Tried(
        {"knowledge": {"angle_zero_deg": {"value": 2.0, "sd": 1.0}}}
    ),
    "knowledge: axis_mm": Tried({"knowledge": {"axis_mm": {"value": 5.0, "sd": 3.0}}}),
    "knowledge: height_cm": Tried({"knowledge": {"height_cm": 190.0}}),
    "knowledge: foot_mm": Tried({"knowledge": {"foot_mm": 290.0}}),
    "knowledge: arm_tri_mm": Tried({"knowledge": {"arm_tri_mm": {"value": 55.0, "sd": 2.0}}}),
    "knowledge: arm_tib_mm": Tried({"knowledge": {"arm_tib_mm": {"value": 45.0, "sd": 2.0}}}),
    "knowledge: plate": Tried({"knowledge": {"plate": {}}}),
    "knowledge: crosstalk": Tried(
        {"knowledge": {"crosstalk": {"xt_ta_sol": {"value": 0.05, "sd": 0.02}}}}
    ),
    "loss": Tried({"loss": "huber"}),
    "starts": Tried({"starts": 2}, {"starts": 1}, "`starts`"),
    "nuisances": Tried({"nuisances": "none"}),
    "geometry_of": Tried({"geometry_of": "person"}, _TABLE),
    "geometry": Tried({"geometry": "virtual-work"}),
    "tendon_strain": Tried({"tendon_strain": "slack-length"}),
    "integrator": Tried({"integrator": "explicit-damped"}),
    "theta_foot": Tried({"theta_foot": 0.1}),
    "vmax_factor": Tried({"vmax_factor": 10.0}),
    "x_ref_tri": Tried({"x_ref_tri": 0.085}, {"geometry": "virtual-work"}),
    "x_ref_tib": Tried({"x_ref_tib": 0.09}, {"geometry": "virtual-work"}),
    "emg_ref": Tried(
        {"emg_ref": (2e-4,) * 4}, {"fixed": {"emg_shape": -1.0}, "emg_ref": (1e-4,) * 4}
    ),
    "joint": Tried(_WRIST, {"geometry": _WRIST["geometry"]}),
}
#: In the order of the columns.
COLUMNS = (AUTO, *MODELS)


def refused(name: str, model: str) -> str:
    """The line that refuses an option of a model; empty where it is used."""
    tried = TRIED[name]
    beside = {key: value for key, value in tried.beside.items() if key not in tried.given}
    try:
        FitSettings.of(model, **beside, **tried.given)
    except InputError as error:
        if "has no effect" not in str(error):
            raise
        return str(error)
    return ""


def table() -> str:
    """A table in Markdown: a row for each option, a column for each model."""
    head = f"| option | {' | '.join(f'`{model}`' for model in COLUMNS)} | shows in |\n"
    rows = [head, "|---|" + ":-:|" * len(COLUMNS) + "---|\n"]
    for name, tried in TRIED.items():
        cells = ("refused" if refused(name, model) else "used" for model in COLUMNS)
        rows.append(f"| `{name}` | {' | '.join(cells)} | {tried.where or 'parameters'} |\n")
    return "".join(rows)
