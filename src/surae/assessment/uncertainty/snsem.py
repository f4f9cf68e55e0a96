"""Standard errors against those of simulated trials: the thesis's snSEM (2.7)."""

import math
from collections.abc import Mapping
from dataclasses import dataclass

from surae.errors import InputError
from surae.estimation import FitProblem
from surae.model import ModelOptions, check_names, get_model


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
