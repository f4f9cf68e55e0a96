"""The torque sensor: limit, sign, offset."""

import math

import numpy as np

from surae.protocol import DEVICES
from surae.quality.baseline import baseline
from surae.quality.finding import Finding, Skipped
from surae.quality.numeric import correlation, equal_runs
from surae.quality.torque_model import passive_columns
from surae.quality.trial import Trial

#: Samples in a row exactly at the largest torque that make a plateau, and how many there are in
#: all: a measured or simulated torque repeats no number.
PLATEAU_RUN, PLATEAU = 3, 6
#: A plateau behind a noisy sensor: this part of the limit above and below it...
_BAND = 0.005
#: ...holds so many times the samples of the band next below. The top of a smooth peak has 2.4.
_EXCESS = 4.0
#: Torque of the groups has the wrong sign when the EMG explains this part of what the angle
#: leaves; chance explains 0.05.
_GAINED = 0.3
#: Passive torque whose correlation with the stretch of the triceps is below minus this.
_AGAINST = -0.6
#: m·g·la of foot and footplate is 1.8 to 4.4 Nm (1.2 to 3 kg at 0.15 m); what the two exponentials
#: cannot follow (relaxation, knee) adds up to 2.7 Nm either way in virtual trials.
LOWEST, HIGHEST = -1.2, 7.1


def limit(trial: Trial) -> tuple[Finding, ...] | Skipped:
    """A torque that stops at a limit: the device's, or its sensor's."""
    channel = trial.recording.channels.get("torque")
    if channel is None:
        return Skipped("torque-limit", "There is no torque.")
    stated = trial.recording.device.get("max_torque")
    known = DEVICES["achilles"].max_torque or math.inf
    most = float(stated) if isinstance(stated, int | float) and stated > 0 else known
    size = np.abs(channel.values)
    top = float(size.max())
    first, length = equal_runs(channel.values)
    level = np.abs(channel.values[first]) >= top * (1.0 - 1e-9)
    flat = bool((length[level] >= PLATEAU_RUN).any()) and int(length[level].sum()) >= PLATEAU
    within = np.abs(size - most) <= _BAND * most
    below = np.abs(size - (1.0 - 2.0 * _BAND) * most) <= _BAND * most
    held = (
        int(within.sum()) >= max(PLATEAU, _EXCESS * int(below.sum()))
        and int((size > (1.0 + 2.0 * _BAND) * most).sum()) == 0
    )
    beyond = isinstance(stated, int | float) and top >= (1.0 - _BAND) * most
    if not ((flat and top > 1.0) or held or beyond):
        return ()
    at = np.flatnonzero(size >= top * (1.0 - 1e-9) if flat else size >= (1.0 - _BAND) * most)
    how = "stops" if flat or held else "reaches"
    device = f", the limit of {most:g} Nm" if abs(top - most) <= 2.0 * _BAND * most else ""
    return (
        Finding(
            "torque-limit",
            "error",
            "torque",
            float(channel.time[at[0]]),
            float(channel.time[at[-1]]),
            top,
            "Nm",
            f"The torque {how} at {top:.3g} Nm{device}, in {len(at)} samples.",
            "Ask for less effort or a slower motion and record again; at its limit the device no "
            "longer follows the profile.",
        ),
    )


def sign(trial: Trial) -> tuple[Finding, ...] | Skipped:
    """A torque that acts against the muscles that make it."""
    if trial.torque is None or trial.model is None:
        return Skipped("torque-sign", "There is no torque, or too little of it.")
    model = trial.model
    wrong: str | None = None
    strength = None
    if model.gained > _GAINED and model.part:
        # The stronger group decides: the weaker may only show the other's crosstalk.
        group = max(model.part, key=lambda name: abs(model.part[name]))
        strength = model.part[group]
        if group == "triceps" and strength < 0.0:
            wrong = f"the triceps pulls with {strength:.2g} Nm, which should be positive"
        elif group == "ta" and strength > 0.0:
            wrong = f"the tibialis anterior pulls with {strength:.2g} Nm, which should be negative"
    elif float(np.ptp(trial.angle)) > 0.2:
        stretch = passive_columns(trial.angle)[0]
        alike = correlation(stretch, trial.torque)
        strength = alike
        if alike < _AGAINST:
            wrong = "it falls where the triceps is stretched, instead of rising"
    else:
        return Skipped("torque-sign", "Neither EMG nor angle say what the torque should be.")
    if wrong is None:
        return ()
    return (
        Finding(
            "torque-sign",
            "error",
            "torque",
            trial.start,
            trial.end,
            strength,
            "Nm" if model.gained > _GAINED and model.part else "1",
            f"The torque has the wrong sign: {wrong}.",
            "Write sign = -1 for the torque (positive when the triceps pulls), or for the angle "
            "(positive in dorsiflexion) if that is turned.",
        ),
    )


def offset(trial: Trial) -> tuple[Finding, ...] | Skipped:
    """A torque whose constant part is not that of gravity."""
    if trial.torque is None:
        return Skipped("torque-offset", "There is no torque.")
    flipped = bool(sign(trial)) and not isinstance(sign(trial), Skipped)
    torque = -trial.torque if flipped else trial.torque
    level = baseline(trial.rate_hz, trial.angle, torque, trial.fast)
    if level is None:
        return Skipped("torque-offset", "Too little rest, or too little of the range, to tell.")
    if LOWEST <= level <= HIGHEST:
        return ()
    return (
        Finding(
            "torque-offset",
            "warning",
            "torque",
            trial.start,
            trial.end,
            level,
            "Nm",
            f"The constant part of the torque is {level:.2g} Nm; foot and footplate make 1.8 to "
            "4.4 Nm.",
            "Set the sensor to zero with the empty footplate and record again, or give the torque "
            "an offset in the TOML.",
        ),
    )
