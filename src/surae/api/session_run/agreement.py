"""The fit that stands for the leg, held against all else that a session has of it."""

from collections.abc import Mapping, Sequence

from surae.api.fitted import Fit
from surae.api.session_run.checked import CheckedTrials
from surae.base.errors import ComputationError, InputError
from surae.inference import Adequacy, Prediction
from surae.inference.judging.adequacy import doubted
from surae.inference.judging.reasons import OF_OTHER_TRIALS, Reason, against
from surae.inference.judging.validation import predict_others
from surae.measures.agreement import AskedTrial, disagreements
from surae.report.leg_cards import PASSIVE
from surae.report.trials import contradictions

#: Uses of trials that the fit of a leg is held against.
_ASKED = ("fit", "hold")


def held_against_others(
    fit: Fit, of: Sequence[str], trials: CheckedTrials, alone: Mapping[str, Fit]
) -> Adequacy:
    """What the fit `of` these trials is worth, as all others and their fits `alone` judge it.

    A joint fit is held against each trial's by itself too.
    """
    asked = _asked(fit, of, trials)
    errors = {
        trial.name: str(finding.message)
        for trial in trials.session.trials
        if trial.name in trials.quality
        and trial.use in _ASKED
        and (finding := trials.wrong(trial.name)) is not None
    }
    reasons = disagreements(fit, asked, alone, errors) + _apart(alone, fit if len(of) > 1 else None)
    return doubted(fit.adequacy, reasons, OF_OTHER_TRIALS, of)


def _asked(fit: Fit, of: Sequence[str], trials: CheckedTrials) -> list[AskedTrial]:
    """The trials that a fit is of, and those that it can predict."""
    asked = []
    relaxed = all(trials.session[name].effort == "passive" for name in of)
    for trial in trials.session.trials:
        if trial.name not in trials.inputs or trial.use not in _ASKED:
            continue
        parts = trials.inputs[trial.name]
        predictions: tuple[Prediction, ...] = ()
        if trial.name not in of:
            if relaxed and trial.effort != "passive":
                continue
            try:
                predictions = predict_others(fit.result, parts, fit.assessment.uncertainty)
            except (InputError, ComputationError):
                continue  # its row says why
        asked.append(AskedTrial(trial, parts, predictions))
    return asked


def _apart(alone: Mapping[str, Fit], joint: Fit | None) -> tuple[Reason, ...]:
    """The trial that contradicts all together in parameters that stiffness rests on, if any."""
    together = None if joint is None else joint.assessment
    apart = contradictions({name: fit.assessment for name, fit in alone.items()}, together)
    names = sorted(PASSIVE & apart.keys())
    return (against("apart", trial=apart[names[0]][0], names=", ".join(names)),) if names else ()
