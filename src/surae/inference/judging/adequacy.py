"""Whether a fit is good enough for its numbers to mean something: one gate, with reasons.

A parameter of a model that does not follow the torque is known precisely and means nothing, and so
is one of a leg that did not move. From where on something matters was chosen on virtual legs of the
family.
"""

from collections.abc import Collection, Sequence

import numpy as np

from surae.base.units import FloatArray
from surae.inference import FitResult
from surae.inference.judging.goodness import centred_r2, counted
from surae.inference.judging.grade import Adequacy, graded
from surae.inference.judging.of_data import OF_RECORDINGS, STILL, of_recordings, range_moved
from surae.inference.judging.of_fit import followed, of_fit
from surae.inference.judging.predicted import TorqueDoubt
from surae.inference.judging.reasons import Reason, against
from surae.model.joint import Joint
from surae.quality.finding import Quality
from surae.signals import ModelInputs

#: Errors of a prediction, in those that the fit promises, from which on it does not keep its word.
BEYOND = 2.0


def judge_adequacy(result: FitResult, quality: Sequence[Quality] = ()) -> Adequacy:
    """Judge a whole fit, of recordings with what was found in them."""
    r2 = centred_r2(list(map(counted, result.problem.inputs, result.residuals)))
    if result.status == "failed" or not np.isfinite(r2):
        return graded([against("failed", grave=True)], r2)
    return graded([*of_recordings(quality), *of_fit(result, r2)], r2)


def judge_prediction(
    doubt: TorqueDoubt, recording: ModelInputs, joint: Joint, measured: FloatArray, e: FloatArray
) -> Adequacy:
    """Judge how a fit predicts a recording that it has not seen, against what it promises.

    The mean is judged apart from the changes, of which `r2` is: a sensor's zero is another in each
    recording. `e` is the measured torque minus what is predicted, where samples count [Nm].
    """
    bias = float(e.mean())
    changes = e - bias
    r2 = centred_r2([(measured, changes)])
    if not np.isfinite(r2):
        return graded([against("unchanging", grave=True)], r2)
    reasons = list(followed(r2))
    if range_moved([recording]) < STILL:
        reasons = [against("held-still", joint.worded)]
    error = float(np.sqrt(np.mean(changes**2)))
    if not error <= BEYOND * doubt.of_changes:
        reasons.append(against("errs", error=error, promised=doubt.of_changes))
    if not abs(bias) <= BEYOND * doubt.of_mean:
        reasons.append(against("mean-off", bias=bias, promised=BEYOND * doubt.of_mean))
    return graded(reasons, r2)


def doubted(
    adequacy: Adequacy,
    reasons: Sequence[Reason],
    codes: Collection[str],
    recordings: Sequence[str] = (),
) -> Adequacy:
    """The judgement with what other trials of the leg say against it, as the only such `codes`.

    An error that stands in one of the fit's `recordings` is not of another trial, and is said once.
    """

    def is_own(reason: Reason) -> bool:
        return reason.code in OF_RECORDINGS and reason.values.get("trial") in recordings

    before = [each for each in adequacy.against if each.code not in codes or is_own(each)]
    known = {(each.code, each.values["trial"]) for each in before if is_own(each)}
    more = [
        each
        for each in reasons
        if not is_own(each) or (each.code, each.values["trial"]) not in known
    ]
    return graded([*before, *more], adequacy.r2)
