"""Every recording predicted with the parameters of all the others."""

from collections.abc import Sequence
from dataclasses import dataclass

from surae.assessment.validation.prediction import Pooled, Prediction, pooled, predict_others
from surae.errors import InputError
from surae.estimation import FitResult, FitSettings, make_problem, solve
from surae.progress import NamedProgress
from surae.signals import ModelInputs


@dataclass(frozen=True, slots=True)
class LeftOut:
    """One recording left out: the fit of the others, and how it predicts this one."""

    prediction: Prediction
    fit: FitResult


@dataclass(frozen=True, slots=True)
class LeaveOneOut:
    """How well recordings of one leg predict each other."""

    recordings: tuple[LeftOut, ...]  #: In the order they were given.
    pooled: Pooled  #: VAF, RMSE and bias over all predictions together.

    @property
    def predictions(self) -> tuple[Prediction, ...]:
        """The predictions without their fits."""
        return tuple(left.prediction for left in self.recordings)


def leave_one_out(
    inputs: Sequence[ModelInputs], settings: FitSettings, progress: NamedProgress | None = None
) -> LeaveOneOut:
    """Predict every recording with a fit of all the others.

    Parameters
    ----------
    inputs : sequence of ModelInputs
        At least two recordings of one leg, as `FitSettings.inputs` gives them.
    settings : FitSettings
        What the fits are asked.
    progress : callable, optional
        Called before every fit.

    Raises
    ------
    InputError
        There are fewer than two recordings, or one has no torque.
    KeyboardInterrupt
        The user stopped a fit: a prediction with its parameters would be worth nothing.
    """
    if len(inputs) < 2:
        raise InputError("leaving one recording out needs at least two; give more")
    made = []
    for number, held in enumerate(inputs):
        if progress is not None:
            progress(held.name, number, len(inputs))
        result = solve(make_problem([*inputs[:number], *inputs[number + 1 :]], settings))
        if result.starts[-1].outcome == "interrupted":
            raise KeyboardInterrupt
        (prediction,) = predict_others(result, [held])
        made.append(LeftOut(prediction, result))
    return LeaveOneOut(tuple(made), pooled([left.prediction for left in made]))
