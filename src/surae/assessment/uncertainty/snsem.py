"""Standard errors against those of simulated trials: the thesis's snSEM (2.7)."""

import math
from collections.abc import Mapping
from dataclasses import dataclass
from typing import Any

from surae._version import __version__
from surae.errors import InputError
from surae.estimation import FitProblem
from surae.files import PathLike, shown, write_json
from surae.model import ModelOptions, check_names, get_model
from surae.records import check_format, from_plain, read_json, to_plain


@dataclass(frozen=True, slots=True)
class Baseline:
    """Mean standard errors of simulated trials, whose parameters were found correctly.

    Attributes
    ----------
    model : str
        Name of the model.
    options : ModelOptions
        Its switches.
    sem : mapping of str to float
        Mean standard error, equation (34), by parameter, in its unit; EMG in volts.
    about : str
        What was simulated, in a plain phrase.
    """

    model: str
    options: ModelOptions
    sem: Mapping[str, float]
    about: str

    def __post_init__(self) -> None:
        """Refuse a parameter that the model has not, and what is no standard error."""
        check_names(self.sem, get_model(self.model))
        for name, value in self.sem.items():
            if not 0 < value < math.inf:
                raise InputError(f"the SEM of {name} is {value!r}, not above zero")


def check_baseline(baseline: Baseline, problem: FitProblem) -> None:
    """Refuse to compare a fit with the simulations of another model."""
    if baseline.model != problem.spec.name:
        raise InputError(
            f"the baseline is of model {baseline.model!r}, the fit of {problem.spec.name!r}; make "
            "one with the model of the fit"
        )
    if baseline.options != problem.options:
        raise InputError("the baseline was simulated with other model options; make another one")


def snsem(
    baseline: Baseline, standard_errors: Mapping[str, float | None], emg_unit: str = "V"
) -> dict[str, float | None]:
    """SEM over the simulations' mean SEM.

    Below 1 a parameter has had more influence on the torque than in the simulations, above 1 less.

    The standard errors, equation (34), are by free parameter. The weights of a normalised envelope
    (`emg_unit` "1") have another unit than the baseline. Parameters are those that are in both;
    None where the fit has no standard error.
    """
    spec = get_model(baseline.model)
    skipped = spec.weights if emg_unit != "V" else ()
    return {
        name: None if sem is None else sem / baseline.sem[name]
        for name, sem in standard_errors.items()
        if name in baseline.sem and name not in skipped
    }


def baseline_as_dict(baseline: Baseline) -> dict[str, Any]:
    """Plain data, in the shape of the file."""
    return {"surae": __version__, **to_plain(baseline)}


def save_baseline(path: PathLike, baseline: Baseline) -> None:
    """Write a baseline; `load_baseline` reads it back.

    Raises
    ------
    InputError
        The file cannot be written.
    """
    write_json(path, baseline_as_dict(baseline))


def load_baseline(path: PathLike) -> Baseline:
    """Read a baseline."""
    data = read_json(path)
    check_format(data, path)
    try:
        return from_plain(Baseline, data)
    except InputError as error:
        raise InputError(
            f"{shown(path)}: {error}; give a file that `surae baseline` wrote"
        ) from None
