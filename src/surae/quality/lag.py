"""EMG and torque out of step, and one electrode out of step with the others."""

from collections.abc import Iterator

import numpy as np

from surae.quality.finding import Finding, Unjudged, make_finding
from surae.quality.numeric import correlations, smooth
from surae.quality.torque_model import LONGEST
from surae.quality.trial import CheckedTrial

#: Lead and lag of all EMG for the torque [s]. True activation may be 30 ms faster or slower than
#: the one assumed, and muscles and tendons take their time. `surae.inference.diagnosis` tells more.
EARLY = 0.16
LATE = 0.1
#: Lag of a head of the triceps for the others [s]. Heads do begin apart, by up to 0.15 s in a burst
#: of the thesis's tasks and by 0.16 s on average in short trials of few bursts.
ELECTRODE = 0.19
#: Lag of TA for the triceps, both found by the torque [s]; clean virtual trials stay within 0.08 s.
ONE_SIDE = 0.13
#: What TA's own lag must leave less of the torque than the triceps' lag does.
GAIN = 0.05
#: Of so many samples, one is compared: what is smooth over 0.1 s is known to 20 ms by that.
_STEP = 2
#: Correlation of an electrode with the others, when in step.
_ALIKE = 0.6


def torque_lag(trial: CheckedTrial) -> Iterator[Finding]:
    """All EMG late or early for the torque."""
    model = trial.model
    if model is None or model.lag is None:
        raise Unjudged("There is no torque or no EMG to compare.")
    if not model.known:
        raise Unjudged("The EMG explains too little of the torque to tell.")
    if -EARLY <= model.lag <= LATE or abs(model.lag) >= 0.95 * LONGEST or _one_side(trial):
        return
    which = "emg-torque-lag/late" if model.lag > 0.0 else "emg-torque-lag/early"
    yield make_finding(which, None, trial.span, model.lag, ms=1e3 * abs(model.lag))


def electrode_lag(trial: CheckedTrial) -> Iterator[Finding]:
    """One electrode late or early for the others."""
    heads = trial.triceps
    if (side := _one_side(trial)) is not None:
        yield _finding(trial, *side, "torque")
    if len(heads) >= 3:
        lags = [(lag, muscle) for muscle in heads if (lag := _lag(trial, muscle)) is not None]
        lag, worst = max(lags, key=lambda each: abs(each[0]), default=(0.0, ""))
        if abs(lag) > ELECTRODE:
            yield _finding(trial, worst, lag, "heads")
    elif side is None and (trial.model is None or not trial.model.group_lag):
        raise Unjudged("There is no other electrode to compare with.")


def _finding(trial: CheckedTrial, muscle: str, lag: float, beside: str) -> Finding:
    return make_finding(
        f"electrode-lag/{'later' if lag > 0.0 else 'earlier'}-{beside}",
        f"emg_{muscle}",
        trial.span,
        lag,
        muscle=trial.names[muscle],
        ms=1e3 * abs(lag),
    )


def _lag(trial: CheckedTrial, muscle: str) -> float | None:
    """Lag of a head of the triceps behind the others [s]."""
    width = round(0.1 * trial.rate_hz)
    mine = smooth(trial.fast[muscle], width)[::_STEP]
    others = [trial.fast[m] for m in trial.triceps if m != muscle]
    together = smooth(np.mean([o / max(float(o.max()), 1e-300) for o in others], axis=0), width)
    together = together[::_STEP]
    rate = trial.rate_hz / _STEP
    lags = np.arange(-round(0.6 * rate), round(0.6 * rate) + 1)
    alike = correlations(mine, together, lags)
    best = int(np.argmax(alike))
    return float(lags[best]) / rate if alike[best] > _ALIKE else None


def _one_side(trial: CheckedTrial) -> tuple[str, float] | None:
    """The muscle whose EMG alone is out of step with the torque, and by how much."""
    model = trial.model
    if model is None or not model.known or len(model.group_lag) < 2:
        return None
    ta = model.group_lag["ta"]
    triceps = model.group_lag["triceps"]
    # The triceps makes most of the torque: its lag is the better known.
    # A lag at the end of those that are tried is no minimum.
    known = abs(ta) < 0.95 * LONGEST
    apart = abs(ta - triceps) > ONE_SIDE and abs(triceps) <= LATE and model.group_gain["ta"] > GAIN
    return ("ta", ta - triceps) if known and apart else None
