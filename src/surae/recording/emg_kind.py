"""What samples look like: EMG raw or smoothed, and whether a torque goes with an angle."""

from dataclasses import dataclass
from typing import Literal

import numpy as np

from surae.base.units import FloatArray
from surae.recording.recording import Recording
from surae.recording.table import Column

#: An envelope, low-passed at 20 Hz or less, crosses its median at most about so often [1/s].
_SLOW = 40.0
#: Raw EMG on a constant offset stays within this part of its median.
_LIFTED = 0.5
#: Its bursts go down as far as up, beside a drift to a fifth; those of an envelope only up, by 12
#: and more in relaxed legs that answer a stretch. What is rarer than this part tells nothing.
_UPWARDS = 10.0
_EXTREME = 1e-3
#: Averaged over this time [s], raw EMG leaves its drift; an envelope stays nearly as it is.
_DRIFT_S = 0.1
#: What is fast is noise of one strength where the strongest and the weakest tenths of its pieces
#: of so long [s] differ by less than this factor: 1.4 in white noise at 128 Hz, 2 and more in EMG
#: of a muscle that comes and goes.
_STEADY = 1.6
_PIECE_S = 0.5
#: Pieces up to which their strengths do not tell.
_FEW = 5
#: Negative samples by this part of the highest are more than a filter's ringing.
_NEGATIVE = 0.1
#: A torque goes with the angle where they correlate at least so much.
_TOGETHER = 0.9
_LIKE = {"raw": "raw", "envelope": "like an envelope"}


@dataclass(frozen=True, slots=True)
class Look:
    """What a signal looks like as an EMG."""

    kind: Literal["raw", "envelope"] | None  #: None where its samples do not say.
    rule: str  #: Why.
    #: What to add to take away a constant offset of raw EMG that hides its zero, in the file's
    #: unit; 0 where none needs to be taken away.
    offset: float = 0.0
    #: Whether no sample is negative, so that it is not raw, but it may not be an envelope either.
    rectified: bool = False
    #: Whether it is noise of one strength on a constant: raw EMG on an offset, or an envelope of
    #: a muscle at rest, of which this noise is the recorder's.
    steady: bool = False


@np.errstate(over="ignore", invalid="ignore")
def look_of(time: FloatArray, values: FloatArray) -> Look:
    """Tell raw EMG from an envelope by its samples.

    Raw EMG is as negative as it is positive and crosses its median hundreds of times a second; an
    envelope is not negative and slow. EMG that stays far above zero and is fast, if only around a
    drift of its electrodes, is raw on an offset.
    """
    values = values[np.isfinite(values)]
    span = float(time[-1] - time[0]) if len(time) > 1 else 0.0
    if len(values) < 2 or not np.isfinite(span) or span <= 0 or values.min() == values.max():
        return Look(None, "too few samples, or all the same")
    mean = float(values.mean())
    if not np.isfinite(mean):
        return Look(None, "too large for any EMG")
    below = float(values.max()) < 0
    if below:
        values = -values
    low = float(values.min())
    high = float(values.max())
    middle = float(np.median(values))
    crossings = _crossings(values - middle) / span
    rate = f"crosses its median {crossings:.0f} times a second"
    if low < -_NEGATIVE * high:
        return Look("raw", f"positive and negative, {rate}")
    least, most = np.quantile(values, (_EXTREME, 1.0 - _EXTREME))
    if low > _LIFTED * middle and most - middle < _UPWARDS * (middle - least):
        fast = _detrended(values, span)
        around = _crossings(fast) / span
        if max(crossings, around) > _SLOW:
            if crossings <= _SLOW:
                rate = f"crosses its drift {around:.0f} times a second"
            offset = -float(f"{mean:.6g}")
            rule = f"never near zero, yet fast: {rate}: raw on an offset"
            return Look("raw", rule, offset, steady=_is_steady(fast, span))
    if (crossings <= _SLOW or low > _LIFTED * middle) and not below:
        return Look("envelope", f"not negative and slow, {rate}")
    rule = f"not negative, yet fast: {rate}: rectified but not smoothed?"
    return Look(None, "negative throughout" if below else rule, rectified=not below and low >= 0.0)


def emg_contradictions(recording: Recording) -> dict[str, str]:
    """What inspect, check and fit say of EMG, by role, that is not what it is declared to be."""
    looks = {
        role: look_of(channel.time, channel.values)
        for role, channel in recording.channels.items()
        if role.startswith("emg_")
    }
    sentences = {role: contradiction(role, look, recording.emg) for role, look in looks.items()}
    return {role: sentence for role, sentence in sentences.items() if sentence}


def contradiction(name: str, look: Look, declared: str) -> str:
    """What is wrong with an EMG that is `declared` raw or an envelope; empty where nothing is."""
    if declared == "envelope" and look.steady:
        return ""
    rectified = declared == "raw" and look.rectified
    if look.kind == declared or (look.kind is None and not rectified):
        return ""
    article = "an envelope" if declared == "envelope" else "raw"
    kind = look.kind or "envelope"
    looks = f"looks {_LIKE[look.kind]}" if look.kind else "was rectified"
    return (
        f"{name} is declared {article} but {looks} ({look.rule}): write "
        f"emg = \"{kind}\" in the mapping, or '# emg: {kind}' in a CSV"
    )


def relation(angle: Column, torque: Column) -> str:
    """How the torque goes with the angle, one sentence; empty where it does not.

    In a passive movement the reaction torque of a stretched triceps rises with dorsiflexion, so
    the relation of the raw channels settles which direction one has, given the other's.
    """
    a = _finite(angle)
    b = _finite(torque)
    if a is None or b is None:
        return ""
    begin = max(a[0][0], b[0][0])
    end = min(a[0][-1], b[0][-1])
    if end <= begin:
        return ""
    time = np.linspace(begin, end, 2000)
    x = np.interp(time, *a)
    y = np.interp(time, *b)
    if x.min() == x.max() or y.min() == y.max():
        return ""
    with np.errstate(over="ignore", invalid="ignore", divide="ignore"):
        r = float(np.corrcoef(x, y)[0, 1])
    if not abs(r) >= _TOGETHER:
        return ""
    way, signs = ("rises", "the same sign") if r > 0 else ("falls", "opposite signs")
    return (
        f"{torque.name!r} {way} with {angle.name!r} (r = {r:+.2f}): if this trial is passive, "
        f"angle and torque need {signs}, as a passive torque rises with dorsiflexion"
    )


def _finite(column: Column) -> tuple[FloatArray, FloatArray] | None:
    """Times that increase and finite values, None where there are not two."""
    good = np.isfinite(column.time) & np.isfinite(column.values)
    time = column.time[good]
    values = column.values[good]
    return None if len(time) < 2 or np.any(np.diff(time) <= 0) else (time, values)


def _detrended(values: FloatArray, span_s: float) -> FloatArray:
    """A signal without what changes slowly: its average over `_DRIFT_S` around each sample."""
    width = min(max(round(len(values) * _DRIFT_S / span_s), 1), len(values))
    total = np.cumsum(np.concatenate(([0.0], values - values[0])))
    slow = (total[width:] - total[:-width]) / width
    return np.asarray(values[width // 2 :][: len(slow)] - values[0] - slow)


def _is_steady(fast: FloatArray, span_s: float) -> bool:
    """Whether the strength of what is fast stays the same throughout, as far as can be told.

    In the second or two of a stride an envelope at rest may be its recorder's noise alone.
    """
    pieces = np.array_split(fast, max(int(span_s / _PIECE_S), 1))
    low, high = np.quantile([piece.std() for piece in pieces], (0.1, 0.9))
    return bool(len(pieces) <= _FEW or high < _STEADY * low)


def _crossings(values: FloatArray) -> int:
    """How often a signal changes its sign."""
    signs = np.sign(values)
    signs = signs[signs != 0]
    return int(np.count_nonzero(np.diff(signs)))
