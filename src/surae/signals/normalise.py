"""EMG as a part of one reference for each muscle: of a session's largest envelope, or of MVC's.

One number per muscle and session, never one per trial: trials of one leg share the weights g, and
a trial divided by its own largest EMG would need weights of its own. Dividing by a constant only
changes the unit of the weights, from N/V to N: what an active muscle pulls at its reference.
"""

from collections.abc import Sequence
from dataclasses import replace
from typing import Literal

import numpy as np

from surae.base.errors import InputError
from surae.base.frozen import read_only
from surae.base.units import FloatArray
from surae.recording import MUSCLES, SourceFile
from surae.signals.inputs import EmgReference, ModelInputs

#: An envelope's peak is that of its average over this time [s], so that no single spike sets it.
AVERAGED_S = 0.25

#: How long a muscle rests at least [s], and largest part of an effort that is taken for its rest.
_QUIET_S = 1.0
_QUIET_PART = 0.02
#: EMG shows an effort where its strongest moments are so many times its weakest.
_EFFORT = 2.0
#: Cut-off [Hz] of what effort is smoothed by (-3 dB).
_EFFORT_HZ = 6.0
#: Part of the strongest EMG below which what is steady is noise: muscles of a leg differ tenfold.
_FAINT = 0.05
#: Largest envelope of a leg by the unit of its EMG, which bounds and priors of weights are given
#: for: volts at the skin (`studies.leg`), or a part of an effort.
_USUAL = {"V": 6e-4, "1": 1.0}
#: Part of a largest effort that steady EMG is taken for where no electrode shows any effort: it is
#: rest or a light effort, and nothing but its unit would say which.
_LIGHT = 0.03
_OF = {"session": "the session's largest envelope", "mvc": "maximum voluntary contractions"}


def normalise(
    inputs: Sequence[ModelInputs], reference: str = "session", *, mvc: Sequence[ModelInputs] = ()
) -> tuple[ModelInputs, ...]:
    """Divide the EMG of a session's recordings, in volts, by one number for each muscle.

    The reference is ``"session"``, the largest envelope in any of `inputs`, or ``"mvc"``, in any of
    `mvc`, each averaged over 0.25 s. It goes along as `ModelInputs.emg_reference`.

    Raises
    ------
    InputError
        EMG is normalised already or silent, or has no reference, or `mvc` does not go with it.
    """
    if reference == "mvc" and not mvc:
        raise InputError("normalising by MVC needs recordings of maximum contractions; give mvc")
    if reference == "session" and mvc:
        raise InputError("recordings of MVC have no effect on session normalisation; use 'mvc'")
    for recording in (*inputs, *mvc):
        _require_volts(recording)
    largest = emg_reference(mvc or inputs, "mvc" if mvc else "session")
    return tuple(normalised(recording, largest) for recording in inputs)


def emg_reference(
    inputs: Sequence[ModelInputs], kind: Literal["session", "mvc"] = "session"
) -> EmgReference:
    """The largest envelope of each muscle in any of the recordings, averaged over 0.25 s.

    Raises
    ------
    InputError
        A muscle's EMG is zero throughout.
    """
    values: list[float | None] = []
    for column, muscle in enumerate(MUSCLES):
        peaks = [
            (largest_envelope(recording.emg[:, column], recording.rate_hz), recording.where)
            for recording in inputs
            if muscle not in recording.missing_emg
        ]
        if not peaks:
            values.append(None)
            continue
        best, where = max(peaks, key=lambda peak: peak[0])
        if not best > 0:
            raise InputError(f"{where}: emg_{muscle} is zero throughout; check its channel")
        values.append(best)
    files: dict[str, SourceFile] = {f.sha256: f for recording in inputs for f in recording.files}
    return EmgReference(kind, tuple(values), tuple(files.values()), len(inputs))


def normalised(recording: ModelInputs, reference: EmgReference | None) -> ModelInputs:
    """A recording's EMG in parts of a reference, as the recordings of a fit have it.

    One that has the reference already, or is given none, is returned as it is.

    Raises
    ------
    InputError
        Its EMG was normalised otherwise, or a muscle has no reference.
    """
    if reference is None or recording.emg_reference == reference:
        return recording
    _require_volts(recording)
    factors = np.ones(len(MUSCLES))
    levels = []
    for column, (muscle, value) in enumerate(zip(MUSCLES, reference.values, strict=True)):
        if muscle in recording.missing_emg:
            continue
        if value is None:
            raise InputError(
                f"{recording.where}: emg_{muscle} has no reference: no recording that it was taken "
                "from has this muscle; add one, or leave the channel out"
            )
        factors[column] = value
        levels.append(f"{muscle} {value:.4g} V")
    count = f"{reference.count} recording{'s' if reference.count != 1 else ''}"
    step = (
        f"EMG normalised: divided by {_OF[reference.kind]} (of {count}, averaged over "
        f"{AVERAGED_S:g} s): {', '.join(levels)}."
    )
    emg = read_only(recording.emg / factors)
    steps = (*recording.steps, step)
    return replace(recording, emg=emg, emg_unit="1", emg_reference=reference, steps=steps)


def _require_volts(recording: ModelInputs) -> None:
    """Refuse EMG that was normalised before."""
    if recording.emg_unit == "V":
        return
    raise InputError(
        f"{recording.where}: its EMG is normalised already, by another reference; normalise all "
        "recordings of a session together, from volts"
    )


def largest_envelope(envelope: FloatArray, rate_hz: float) -> float:
    """The maximum of an envelope averaged over `AVERAGED_S`, only where the window is full."""
    width = min(max(round(AVERAGED_S * rate_hz), 1), len(envelope))
    total = np.cumsum(np.concatenate(([0.0], np.abs(envelope))))
    return float(np.max(total[width:] - total[:-width])) / width


def quiet_levels(inputs: Sequence[ModelInputs]) -> tuple[float, float, float, float]:
    """EMG levels of a leg at rest, of TA, GL, SOL, GM, in the EMG's unit; 0 without EMG.

    Root mean square of the quietest second of all recordings. Where the EMG changes it is at most
    2 % of what the electrode shows of an effort: a muscle that is busy throughout does not tell
    what is there at rest. Steady EMG may be all of it.
    """
    from scipy.ndimage import uniform_filter1d

    lowest = np.full(4, np.inf)
    for recording in inputs:
        size = min(max(int(_QUIET_S * recording.rate_hz), 1), recording.n)
        power = uniform_filter1d(recording.emg**2, size, axis=0)
        inside = power[size // 2 : recording.n - (size - 1) // 2]
        lowest = np.minimum(lowest, np.sqrt(np.maximum(inside.min(axis=0), 0.0)))
    most = np.where(steady_emg(inputs), np.inf, _QUIET_PART * np.array(emg_levels(inputs)))
    ta, gl, sol, gm = np.minimum(lowest, most)
    return float(ta), float(gl), float(sol), float(gm)


def steady_emg(inputs: Sequence[ModelInputs]) -> tuple[bool, ...]:
    """Whether the EMG of TA, GL, SOL, GM hardly changes, so that it may be rest or an effort."""
    emg = np.concatenate([_averaged(recording)[recording.counts] for recording in inputs])
    weak, strong = np.percentile(emg, [25.0, 99.0], axis=0)
    return tuple((strong <= np.maximum(_EFFORT * weak, 0.0)).tolist())


def emg_sizes(inputs: Sequence[ModelInputs]) -> tuple[float, float, float, float]:
    """How many times larger than usual the EMG of TA, GL, SOL, GM is; 1 without EMG.

    Skin and amplifier make it anything. Bounds and priors of what has the EMG's unit are adapted to
    it (`surae.model.parameter.adapted`), so that no unit and no gain decides in a fit. An electrode
    whose EMG is steady beside others that show effort is taken to be amplified as these are.
    """
    usual = _USUAL[inputs[0].emg_unit]
    each = [_averaged(recording)[recording.counts].max(axis=0) for recording in inputs]
    sizes = np.max(each, axis=0) / usual
    there = sizes > 0.0
    steady = np.array(steady_emg(inputs))
    if (shown := there & ~steady).any():
        sizes[steady] = np.exp(np.log(sizes[shown]).mean())
    else:
        sizes /= _LIGHT
    ta, gl, sol, gm = np.where(there, sizes, 1.0)
    return float(ta), float(gl), float(sol), float(gm)


def noise_alone(inputs: Sequence[ModelInputs]) -> set[int]:
    """Channels whose EMG is steady, and too weak beside the strongest to be an effort."""
    top = np.max([_averaged(recording).max(axis=0) for recording in inputs], axis=0)
    steady = steady_emg(inputs)
    return {c for c in range(len(MUSCLES)) if steady[c] and top[c] <= _FAINT * top.max()}


def _averaged(recording: ModelInputs) -> FloatArray:
    """EMG averaged over `AVERAGED_S`: rectified noise fluctuates by as much as itself, (n, 4)."""
    from scipy.ndimage import uniform_filter1d

    size = max(1, round(AVERAGED_S * recording.rate_hz))
    return np.asarray(uniform_filter1d(recording.emg, size, axis=0, mode="nearest"))


def emg_levels(inputs: Sequence[ModelInputs]) -> tuple[float, float, float, float]:
    """EMG levels of a leg that only 1 % of its samples exceed, of TA, GL, SOL, GM [V].

    A reference for `emg_shape` (`ModelOptions.emg_ref`), over all recordings of a session together;
    0 for a muscle without EMG.
    """
    efforts = [smooth_effort(recording.emg.T, recording.rate_hz) for recording in inputs]
    ta, gl, sol, gm = np.percentile(np.concatenate(efforts, axis=1), 99.0, 1)
    return float(ta), float(gl), float(sol), float(gm)


def smooth_effort_s() -> float:
    """Standard deviation of the Gaussian of `smooth_effort` [s]."""
    return float(np.sqrt(np.log(2.0)) / (2.0 * np.pi * _EFFORT_HZ))


def smooth_effort(emg: FloatArray, rate_hz: float) -> FloatArray:
    """EMG envelopes, shape (4, n), as smooth as effort is: what a force may be curved over.

    Rectified EMG fluctuates by as much as itself, and a curve makes another mean of that. Lloyd and
    Besier (2003) took its low-pass of 6 Hz before; this one is a Gaussian's, which neither delays
    nor undershoots.
    """
    from scipy.ndimage import gaussian_filter1d

    width = smooth_effort_s() * rate_hz
    return np.asarray(gaussian_filter1d(emg, width, axis=1, mode="nearest"))
