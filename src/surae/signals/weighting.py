"""What each sample counts in a fit: stretches of time, and peaks more than rest."""

import math
from collections.abc import Sequence
from dataclasses import dataclass, replace

import numpy as np
import numpy.typing as npt

from surae.base.errors import InputError
from surae.base.frozen import read_only
from surae.base.names import ACTIVITIES
from surae.base.records import OrInfinite, OrMinusInfinite
from surae.base.setting import Request, documented, is_number, setting
from surae.base.units import FloatArray
from surae.base.words import N_, Message
from surae.recording import MUSCLES
from surae.signals.inputs import ModelInputs
from surae.signals.lead_in import LONG, SETTLING_S, led_in
from surae.signals.normalise import emg_levels, quiet_levels, smooth_effort, steady_emg

#: Activity is averaged over this time [s], so that a weight does not follow the torque's noise: it
#: would pull the estimates to one side.
_SMOOTH_S = 0.25
#: Percentile of the activity that counts as a full peak; an artefact above it counts no more.
_PEAK = 95.0
#: A muscle whose EMG begins above this part of what it reaches is active when a recording begins.
#: What its EMG was before is not recorded: nothing counts until an activation has forgotten it.
_ACTIVE = 0.1


@documented
@dataclass(frozen=True, slots=True)
class Weighting(Request):
    """What the samples of a recording count, for `weighted`; the parts multiply.

    Attributes
    ----------
    {settings}
    """

    windows: tuple[tuple[OrMinusInfinite, OrInfinite, float], ...] = setting(
        (),
        "Start and end [s, of the recording's own time axis, both included; ∞ is allowed] and what "
        "the samples between them count: 0 leaves them out, 2 counts them twice. Where windows "
        "overlap their weights multiply.",
        type="tuple of (float, float, float)",
    )
    peaks: float = setting(
        0.0,
        "A sample at full activity counts 1 + `peaks` times as much as one at rest; 0: all alike.",
        least=0.0,
        label=N_("Weight of peaks"),
    )
    activity: str = setting(
        "torque",
        "What a peak is one of: the size of the measured torque, or the mean of the EMG envelopes.",
        choices=ACTIVITIES,
        label=N_("Peaks are those of"),
        words={"torque": N_("torque"), "emg": N_("EMG")},
    )

    def __post_init__(self) -> None:
        """Refuse what has no meaning."""
        Request.__post_init__(self)
        for window in self.windows:
            if not (
                isinstance(window, Sequence) and len(window) == 3 and all(map(is_number, window))
            ):
                raise InputError(f"window {window!r}: give a start, an end [s] and a weight")
            start, end, weight = window
            if not start <= end:
                raise InputError(f"window {_span(start, end)}: its end must follow its start")
            if not 0 <= weight < math.inf:
                raise InputError(
                    f"window {_span(start, end)}: its weight is {weight:g}; give a finite number "
                    "of zero or more"
                )

    def excluding(self, stretches: Sequence[tuple[float, float]]) -> "Weighting":
        """The same, and stretches of time that do not count.

        Parameters
        ----------
        stretches : sequence of (float, float)
            Start and end of each [s, of the recording's own time axis, both included].

        Returns
        -------
        Weighting
            Its windows are those of before and these.

        Raises
        ------
        InputError
            A stretch is no start and end.
        """
        for stretch in stretches:
            if not (isinstance(stretch, Sequence) and len(stretch) == 2):
                raise InputError(f"exclude {stretch!r}: give a start and an end [s], as (2.0, 5.5)")
        left_out = tuple((start, end, 0.0) for start, end in stretches)
        return replace(self, windows=(*self.windows, *left_out))


def weighted(
    inputs: Sequence[ModelInputs], weighting: Weighting | Sequence[Weighting]
) -> tuple[ModelInputs, ...]:
    """Recordings with weights, for all or one for each; those they have already are multiplied.

    The weight of activity is (1 + peaks·a)/mean, where a goes from 0 at rest to 1 at a peak: the
    activity, averaged over 0.25 s, over its own 95th percentile, at most 1. With mean 1 a
    recording keeps its share among others.

    Raises
    ------
    InputError
        A window holds no sample of any recording it is for, or leaves none to count.
    """
    shared = isinstance(weighting, Weighting)
    each = [weighting] * len(inputs) if isinstance(weighting, Weighting) else list(weighting)
    if len(each) != len(inputs):
        raise InputError(f"{len(each)} weightings for {len(inputs)} recordings; give one for each")
    for recording, how in zip(inputs, each, strict=True):
        among = inputs if shared else [recording]
        for start, end, _ in how.windows:
            if not any(_within(one, start, end).any() for one in among):
                spans = ", ".join(f"{r.where}: {r.time[0]:g} … {r.time[-1]:g} s" for r in among)
                raise InputError(f"window {_span(start, end)} holds no sample ({spans})")
    return tuple(_weighted(recording, how) for recording, how in zip(inputs, each, strict=True))


def settled(inputs: Sequence[ModelInputs]) -> tuple[ModelInputs, ...]:
    """Recordings of a leg without the first moments of those in which muscles are active at once.

    An activation follows EMG from before the recording; a model has to assume some. A short one
    that ends as it began, as a stride does, has its end before it (`surae.signals.lead_in`).
    """
    rest = np.array(quiet_levels(inputs))
    level = np.array(emg_levels(inputs))
    begins = rest + _ACTIVE * (level - rest)
    begins[np.array(steady_emg(inputs)) | (level <= 0.0)] = np.inf
    return tuple(_settled(recording, begins) for recording in inputs)


def _settled(recording: ModelInputs, begins: FloatArray) -> ModelInputs:
    """One recording, where EMG at first above these levels is an effort."""
    start = float(recording.time[0])
    seconds = recording.n / recording.rate_hz
    first = smooth_effort(recording.emg.T, recording.rate_hz)[:, 0]
    if not (first > begins).any():
        return recording
    if seconds < LONG * SETTLING_S:
        return led_in(recording)
    left_out = Weighting(windows=((-math.inf, start + SETTLING_S, 0.0),))
    why = "Muscles are active from the first sample, and what their EMG was before is not recorded."
    made = _weighted(recording, left_out)
    return replace(made, steps=(*made.steps, why))


def _within(recording: ModelInputs, start: float, end: float) -> npt.NDArray[np.bool_]:
    return (recording.time >= start) & (recording.time <= end)


def _weighted(recording: ModelInputs, how: Weighting) -> ModelInputs:
    """One recording with weights."""
    weight = recording.weights.copy()
    steps = []
    for start, end, factor in how.windows:
        within = _within(recording, start, end)
        if not within.any():
            continue
        weight[within] *= factor
        effect = "left out of the fit" if factor == 0 else f"counts {factor:g} times"
        steps.append(f"Weights: {_span(start, end)} {effect}.")
    if not weight.any():
        raise InputError(f"{recording.where}: the windows leave no sample to count; leave out less")
    if how.peaks > 0:
        factors = 1.0 + how.peaks * activity(recording, how.activity, weight > 0)
        weight *= factors / factors[weight > 0].mean()
        steps.append(Message(f"made/peaks/{how.activity}", times=1 + how.peaks))
    if not steps:
        return recording
    counted = weight[weight > 0]
    return replace(
        recording,
        weight=read_only(weight),
        emphasised=recording.emphasised or not bool(np.all(counted == counted[0])),
        steps=(*recording.steps, *steps),
    )


def activity(
    recording: ModelInputs, kind: str, counted: npt.NDArray[np.bool_] | None = None
) -> FloatArray:
    """How active a recording is over time, from 0 at rest to 1 at a peak, shape (n,).

    `kind` is "torque", its size, or "emg", the mean of the envelopes, each over its own peak;
    `counted` are the samples that tell how high a peak is.
    """
    mask = np.ones(recording.n, dtype=bool) if counted is None else counted
    if kind == "torque":
        if recording.torque is None:
            raise InputError(f"{recording.where}: there is no torque whose peaks could count")
        return _scaled(np.abs(recording.torque), recording.rate_hz, mask)
    recorded = [c for c, muscle in enumerate(MUSCLES) if muscle not in recording.missing_emg]
    if not recorded:
        raise InputError(f"{recording.where}: there is no EMG whose peaks could count")
    levels = [_scaled(np.abs(recording.emg[:, c]), recording.rate_hz, mask) for c in recorded]
    return _scaled(np.mean(levels, axis=0), recording.rate_hz, mask)


def _scaled(level: FloatArray, rate_hz: float, mask: npt.NDArray[np.bool_]) -> FloatArray:
    """A level averaged over `_SMOOTH_S`, over its own peak, at most 1."""
    width = min(2 * int(_SMOOTH_S * rate_hz / 2) + 1, 2 * ((len(level) - 1) // 2) + 1)
    window = np.ones(width)
    smooth = np.convolve(level, window, "same") / np.convolve(np.ones(len(level)), window, "same")
    peak = float(np.percentile(smooth[mask], _PEAK))
    if not peak > 0:
        return np.zeros(len(level))
    return np.asarray(np.minimum(smooth / peak, 1.0), dtype=np.float64)


def _span(start: float, end: float) -> str:
    first = "the beginning" if start == -math.inf else f"{start:g}"
    return f"{first} … {'the end' if end == math.inf else f'{end:g} s'}"
