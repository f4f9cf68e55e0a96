"""A recording's channels as they would arrive, all at one rate."""

import numpy as np

from surae.base.errors import InputError
from surae.base.units import FloatArray
from surae.recording import MUSCLES, Recording
from surae.signals import ModelInputs
from surae.signals.resample import MINIMUM_SAMPLES, resample, uniform
from surae.signals.timebase import Axis


def arriving(
    recording: Recording, rate_hz: float, emg: str, like: ModelInputs
) -> tuple[FloatArray, FloatArray, FloatArray | None]:
    """Angle (n,), EMG (n, 4) and the measured torque (n,), if any, at a rate.

    Raises
    ------
    InputError
        There is no angle, EMG comes otherwise than the predictor takes it, or a muscle's is missing
        that the fit has.
    """
    if "angle" not in recording.channels:
        raise InputError(f"{recording.where}: there is no angle; add its column")
    comes = "raw" if recording.emg == "raw" else "envelope"
    if comes != emg and any(role.startswith("emg_") for role in recording.channels):
        raise InputError(
            f"{recording.where}: its EMG is {recording.emg}, the predictor takes {emg}; make one "
            f"with emg={comes!r}"
        )
    wanted = [f"emg_{m}" for m in MUSCLES if m not in like.missing_emg]
    if missing := [role for role in wanted if role not in recording.channels]:
        raise InputError(f"{recording.where}: no {', '.join(missing)}, which the fit has")
    roles = ["angle", *wanted, *(["torque"] if "torque" in recording.channels else [])]
    sources = {role: uniform(recording.channels[role], recording.where) for role in roles}
    start = max(source.axis.start for source in sources.values())
    end = min(source.axis.end for source in sources.values())
    n = int(np.floor((end - start) * rate_hz + 1e-6)) + 1
    if n < MINIMUM_SAMPLES:
        raise InputError(f"{recording.where}: only {n} samples at {rate_hz:g} Hz are shared")
    axis = Axis(start, rate_hz, n)
    signals = {
        role: resample(source, axis, ends="even" if role.startswith("emg_") else "odd")
        for role, source in sources.items()
    }
    columns = np.zeros((n, len(MUSCLES)))
    for at, muscle in enumerate(MUSCLES):
        if (role := f"emg_{muscle}") in signals:
            columns[:, at] = signals[role]
    return signals["angle"], columns, signals.get("torque")
