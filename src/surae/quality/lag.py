"""EMG and torque out of step, and one electrode out of step with the others."""

from collections.abc import Iterator

import numpy as np

from surae.base.units import FloatArray
from surae.quality.finding import Finding, Unjudged, make_finding
from surae.quality.numeric import correlations, quantile, shifted, smooth
from surae.quality.torque_model import LONGEST, passive_columns
from surae.quality.trial import CheckedTrial, Signals

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
#: By how much EMG begins and ends before the torque does [s], least and most: legs of 23 families
#: of another generator have 0.13 to 0.23, measured ones 0.06 to 0.17. A lag moves it by as much.
LEADS = (0.07, 0.27)
#: Part of the torque's rate that onsets must explain to say so, and the time that they are averaged
#: over [s], twice.
_ONSETS = 0.05
_ONSET_S = 0.08


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


def lead_of_onsets(signals: Signals) -> float | None:
    """By how much EMG changes before the torque does [s]; None where its changes do not say.

    The rates of both are correlated at every lag, what angle and acceleration explain taken out of
    both: how strong a muscle is at an angle, and how tissue relaxes, hardly matter to onsets.
    """
    rate = signals.rate_hz
    torque = signals.torque
    if torque is None or not signals.fast:
        return None
    width = max(round(_ONSET_S * rate), 1)

    def changes(values: FloatArray) -> FloatArray:
        return np.gradient(smooth(smooth(values, width), width), 1.0 / rate)

    moving = np.gradient(smooth(signals.angle, width), 1.0 / rate)
    shapes = [*passive_columns(signals.angle)[:3], moving, np.gradient(moving, 1.0 / rate)]
    passive = np.column_stack([np.ones_like(moving), *map(changes, shapes)])
    passive /= np.maximum(np.linalg.norm(passive, axis=0), 1e-300)
    basis = np.linalg.qr(passive)[0]

    def active(values: FloatArray) -> FloatArray:
        return np.asarray(values - basis @ (basis.T @ values))

    y = active(changes(torque))
    power = float(y @ y)
    sides: dict[str, list[FloatArray]] = {}
    for muscle, envelope in signals.fast.items():
        top = quantile(envelope, 0.98)
        if top > 0.0:
            sides.setdefault("ta" if muscle == "ta" else "triceps", []).append(envelope / top)
    if not sides or power <= 0.0:
        return None
    pulls = [
        changes(np.mean(each, axis=0)) * (-1.0 if side == "ta" else 1.0)
        for side, each in sides.items()
    ]
    reach = round(LONGEST * rate)
    lags = np.arange(-reach, reach + 1)
    explained = []
    for lag in lags.tolist():
        columns = np.column_stack([active(shifted(pull, lag)) for pull in pulls])
        explained.append(_pulled(columns, y) / power)
    best = int(np.argmax(explained))
    known = explained[best] > _ONSETS and 0 < best < len(lags) - 1
    return float(lags[best]) / rate if known else None


def _pulled(columns: FloatArray, y: FloatArray) -> float:
    """Sum of squares that one or two columns explain with weights that are not negative."""
    alone = [float(max(c @ y, 0.0) ** 2 / max(float(c @ c), 1e-300)) for c in columns.T]
    if columns.shape[1] == 1:
        return alone[0]
    weights = np.linalg.lstsq(columns, y, rcond=None)[0]
    return float(y @ columns @ weights) if np.all(weights > 0.0) else max(alone)


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
