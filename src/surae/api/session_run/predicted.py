"""How a fit follows the trials of its session, those it was not fitted to as well."""

from collections.abc import Mapping, Sequence

import numpy as np

from surae.api.fitted import Fit
from surae.base.errors import ComputationError, InputError
from surae.base.packed import finite
from surae.inference import Grade, Prediction
from surae.inference.diagnosis import STILL
from surae.inference.judging.goodness import centred_r2, counted, vaf
from surae.inference.judging.validation import covered, predict_others
from surae.signals import ModelInputs, same_signals
from surae.trials import Crossed, TrialSet

#: Why the fit of a passive trial predicts no active one: none of it shows what EMG does.
NO_EFFORT = "no effort here"


def predictions_by(
    fit: Fit, of: Sequence[str], session: TrialSet, every: Mapping[str, Sequence[ModelInputs]]
) -> dict[str, Crossed]:
    """How a fit of these trials follows every trial; without effort it knows no active one."""
    passive = {trial.name for trial in session.trials if trial.effort == "passive"}
    return {
        trial: Crossed(reason=NO_EFFORT)
        if passive.issuperset(of) and trial not in passive
        else _crossed(fit, inputs, trial in of)
        for trial, inputs in every.items()
    }


def _crossed(fit: Fit, parts: Sequence[ModelInputs], fitted: bool) -> Crossed:
    """How a fit follows a trial, all parts of it together; one of its own as it was fitted."""
    moves = any(float(np.ptp(part.angle)) >= STILL for part in parts)
    grade = ""
    covers = template = ridge = None
    if fitted:
        pairs = list(zip(fit.result.problem.inputs, fit.result.residuals, strict=True))
        errors = [
            next(
                counted(fitted_part, left)
                for fitted_part, left in pairs
                if same_signals(fitted_part, part)
            )
            for part in parts
        ]
    else:
        try:
            predictions = predict_others(fit.result, parts, fit.assessment.uncertainty)
        except (InputError, ComputationError) as error:
            return Crossed(reason=str(error))
        errors = [each.errors for each in predictions]
        covers = finite(covered(predictions))
        template, ridge = (_together(predictions, name) for name in ("template", "ridge"))
        grades = [str(each.adequacy.grade) for each in predictions if each.adequacy]
        grade = max(grades, key=[str(each) for each in Grade].index, default="") if moves else ""
    measured, e = (np.concatenate(each) for each in zip(*errors, strict=True))
    return Crossed(
        finite(vaf(measured, e)),
        finite(centred_r2(errors)) if moves or fitted else None,
        finite(float(np.sqrt(np.mean(e**2)))),
        finite(float(e.mean())),
        covers=covers,
        fitted=fitted,
        grade=grade,
        template_vaf=template,
        ridge_vaf=ridge,
    )


def _together(predictions: Sequence[Prediction], name: str) -> float | None:
    """What is predicted without a model of all parts of a trial [%]; None where it misses one."""
    shares = [getattr(each.baselines, name) for each in predictions]
    if any(share is None for share in shares):
        return None
    return finite(float(np.average(shares, weights=[len(p.errors[1]) for p in predictions])))
