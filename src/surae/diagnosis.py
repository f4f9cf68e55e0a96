"""Signs, units and zeros of a recording that are wrong: what it might be is tried by quick fits.

Numbers alone rarely say that an angle is turned. A model does: with the right signs it explains
the torque, with the wrong ones it cannot, for active muscles only pull. A quick fit is model 1.0
on some 500 samples with the zero of the torque free, a few milliseconds; R² is about the mean.
"""

from dataclasses import dataclass, replace

import numpy as np

from surae.errors import InputError
from surae.estimation import make_problem
from surae.estimation.curved import curved_move
from surae.estimation.least_squares import minimise
from surae.estimation.residuals import Residuals
from surae.estimation.separable import scan_lengths
from surae.frozen import read_only
from surae.quality import Commanded, Finding, Quality, check_recording
from surae.quality.numeric import quantile, quantiles, shifted, smooth
from surae.quality.registry import ordered, unfit
from surae.quality.torque import GRAVITY
from surae.quality.trial import Signals, signals_of
from surae.quality.wording import muscle_name
from surae.recording import MUSCLES, Recording
from surae.signals import ModelInputs
from surae.threads import one_blas_thread
from surae.units import FloatArray

#: Samples of a quick fit, and the rate [Hz] that it keeps at least.
_SAMPLES, _RATE = 500, 15.0
#: An EMG whose highest level is not so many times its level at rest is at rest throughout.
_ACTIVE = 2.5
#: Largest level [V] to which the EMG is brought, whatever its unit: weights then suit their bounds.
_FULL = 6e-4
#: R² from which on nothing else is tried.
_GOOD = 0.99
#: What is claimed must explain this much, and leave so many times less than what is given.
_EXPLAINS, _CLEARLY = 0.8, 2.5
#: Part of what a fit leaves that shifting the EMG must take away before a lag is claimed.
_SHIFT_GAIN = 0.03
#: An angle that keeps within this [rad] for all but a hundredth of the time is held still.
STILL = 0.03
#: Torque of an ankle [Nm] and duration [s] and rate [Hz] of a trial: least and most.
_TORQUES, _SECONDS, _RATES = (1.0, 400.0), (2.0, 3600.0), (20.0, 50_000.0)
#: A zero that is worth a word [Nm], in a fit that explains so much and leaves so much less by it.
_ZERO, _GOOD_ENOUGH, _ZERO_GAIN = 8.0, 0.9, 1.3
#: Part of a zero told by the torque's constant part that a fit must find too.
_AGREED = 0.25
#: No two muscles of a leg differ by this factor.
_MUSCLES = 100.0
#: The largest EMG that skin gives [V], and the largest of any amplifier's output.
_SKIN, _AMPLIFIER = 0.012, 12.0


@dataclass(frozen=True, slots=True)
class QuickFit:
    """How well model 1.0 can explain a recording's torque.

    Attributes
    ----------
    r2 : float
        R² about the mean, the torque's zero being free.
    zero : float
        That zero [Nm].
    """

    r2: float
    zero: float

    @property
    def left(self) -> float:
        """Part of the torque's variance that is not explained."""
        return max(1.0 - self.r2, 1e-4)


def examined(recording: Recording, commanded: Commanded | None = None) -> Quality:
    """All findings of a recording: those of the checks, and what is wrong with signs and units.

    What is found to be wrong is put right before the checks look at the recording, so that what
    follows from it is no finding of its own.

    Parameters
    ----------
    recording : Recording
        As it was read.
    commanded : Commanded, optional
        The motion that the device was to follow.
    """
    told, right = wrong_units(recording)
    quality = check_recording(right, commanded)
    if unfit(right) is not None:
        return _together(quality, told)
    signals = signals_of(right)
    degrees = _degrees(right, signals, quality)
    if degrees is not None:
        told.append(degrees[0])
        right = degrees[1]
        signals = signals_of(right)
        quality = check_recording(right, commanded)
    still = _still(signals)
    if still is not None:
        return _together(quality, [*told, still], but=("angle-units", "rom-not-covered"))
    fit = None if signals.torque is None else quick_fit(right, signals)
    if fit is None:
        return _together(quality, told)
    turned = _signs(right, signals, fit)
    if turned is not None:
        if turned[1] is not right:
            quality = check_recording(turned[1], commanded)
        return _together(quality, [*told, *turned[0]], but=("torque-sign",))
    constant = next((f for f in quality.findings if f.code == "torque-offset"), None)
    if constant is None:
        zero = _zero(right, signals, fit)
        told += [] if zero is None else [zero]
    elif fit.r2 >= _GOOD_ENOUGH and not _borne_out(constant, fit):
        findings = tuple(f for f in quality.findings if f is not constant)
        quality = replace(quality, findings=findings)
    return _together(_without_false_lags(right, signals, quality, fit), told)


def wrong_units(recording: Recording) -> tuple[list[Finding], Recording]:
    """Units that cannot be what they are said to be, and the recording with them put right."""
    told: list[Finding] = []
    if "angle" not in recording.channels:
        return told, recording
    for of_unit in (_time_unit, _torque_unit, *[_emg_unit] * len(MUSCLES)):
        righted = of_unit(recording)
        if righted is not None and righted[0] not in told:
            told.append(righted[0])
            recording = righted[1]
    return told, recording


def _together(quality: Quality, told: list[Finding], but: tuple[str, ...] = ()) -> Quality:
    """The findings of the checks, but for those of some codes, and what else was told."""
    own = {*but, *(finding.code for finding in told)}
    if not told:
        return quality
    kept = [finding for finding in quality.findings if finding.code not in own]
    skipped = tuple(reason for reason in quality.skipped if reason.check not in own)
    return replace(quality, findings=ordered([*told, *kept]), skipped=skipped)


def _degrees(
    recording: Recording, signals: Signals, quality: Quality
) -> tuple[Finding, Recording] | None:
    """Radians taken for degrees: a small angle that explains the torque when it is made larger."""
    claimed = next((f for f in quality.findings if f.code == "angle-units"), None)
    if claimed is None or np.ptp(signals.angle) > STILL * 1.5 or signals.torque is None:
        return None
    right = _scaled(recording, "angle", float(np.rad2deg(1.0)))
    before, after = quick_fit(recording, signals), quick_fit(right, signals_of(right))
    if before is None or after is None or after.r2 < max(_EXPLAINS, before.r2):
        return None
    message = (
        f"{claimed.message[:-1]}: with the larger angle R² rises from {_percent(before.r2)} to "
        f"{_percent(after.r2)}."
    )
    return replace(claimed, message=message), right


def quick_fit(
    recording: Recording,
    signals: Signals,
    *,
    angle: float = 1.0,
    torque: float = 1.0,
    later: dict[str, float] | None = None,
    zero: bool = True,
) -> QuickFit | None:
    """Fit model 1.0 quickly to what a recording might be.

    Parameters
    ----------
    recording : Recording
        For what it prescribes.
    signals : Signals
        Its signals.
    angle, torque : float
        Factors: signs or units.
    later : dict of str to float, optional
        By how much the EMG of a muscle is late [s], which is taken away.
    zero : bool
        Whether the torque's zero is free.

    Returns
    -------
    QuickFit or None
        None where the model cannot be fitted to it.
    """
    assert signals.torque is not None
    rate = signals.rate_hz
    step = max(1, min(int(rate / _RATE), len(signals.time) // _SAMPLES))
    thin = slice(step // 2, None, step)
    moved = angle * smooth(signals.angle, round(0.05 * rate))
    velocity = np.gradient(moved, 1.0 / rate)
    emg = np.zeros((len(signals.time), len(MUSCLES)))
    for muscle, envelope in signals.fast.items():
        rest, top = quantiles(envelope, 0.05, 0.98)
        if top > _ACTIVE * max(rest, 0.0):
            level = np.maximum(envelope - rest, 0.0) * (_FULL / (top - rest))
            if later and muscle in later:
                level = shifted(level, -round(later[muscle] * rate))
            emg[:, MUSCLES.index(muscle)] = smooth(level, step)
    silent = [f"g{k + 1}" for k in range(len(MUSCLES)) if not emg[:, k].any()]
    inputs = ModelInputs(
        recording.name,
        rate / step,
        time=read_only(signals.time[thin]),
        angle=read_only(moved[thin]),
        velocity=read_only(velocity[thin]),
        acceleration=read_only(np.gradient(velocity, 1.0 / rate)[thin]),
        emg=read_only(emg[thin]),
        emg_unit="V",
        torque=read_only(torque * signals.torque[thin]),
    )
    mass = {name: value for name, value in recording.fixed.items() if name == "m"}
    try:
        problem = make_problem([inputs], fixed={**dict.fromkeys(silent, 0.0), **mass})
    except InputError:
        return None
    measured = inputs.torque
    assert measured is not None
    residuals = Residuals(problem)

    def rows(x: FloatArray) -> FloatArray:
        """Rows without their means, where the torque's zero is to be solved for."""
        every = residuals.data_rows(x)
        if zero:
            every -= every.mean(axis=1, keepdims=True)
        return every

    power = float(((measured - measured.mean()) ** 2).sum())
    if power <= 0.0:
        return None
    with one_blas_thread(), np.errstate(over="ignore", invalid="ignore"):
        best = minimise(
            rows, scan_lengths(problem, rows, problem.start), problem.lower, problem.upper,
            move=curved_move(problem), max_iterations=40, ftol=1e-3, stall=1e-3,
        )  # fmt: skip
        offset = float(np.mean(residuals.of(best.x)[0])) if zero else 0.0
    return QuickFit(1.0 - best.sse / power, torque * offset) if np.isfinite(best.sse) else None


def _signs(
    recording: Recording, signals: Signals, first: QuickFit
) -> tuple[list[Finding], Recording] | None:
    """What is said of the signs, and the recording with them right; None where nothing is."""
    if first.r2 >= _GOOD:
        return None
    tried = {
        pair: quick_fit(recording, signals, angle=pair[0], torque=pair[1])
        for pair in ((-1.0, 1.0), (1.0, -1.0), (-1.0, -1.0))
    }
    fits = {pair: fit for pair, fit in tried.items() if fit is not None}
    if not fits:
        return None
    best = max(fits.values(), key=lambda fit: fit.r2)
    if best.r2 < _EXPLAINS or first.left < _CLEARLY * best.left:
        return None
    possible = [signs for signs, fit in fits.items() if fit.left < _CLEARLY * best.left]
    turned = [n for k, n in enumerate(("angle", "torque")) if all(s[k] < 0.0 for s in possible)]
    unsure = [
        n
        for k, n in enumerate(("angle", "torque"))
        if n not in turned and any(s[k] < 0.0 for s in possible)
    ]
    span = float(signals.time[0]), float(signals.time[-1])
    numbers = f"R² rises from {_percent(first.r2)} to {_percent(best.r2)}"
    if not turned:
        text = (
            f"The angle or the torque is turned: with one sign = −1 {numbers}; which of them, the "
            "data cannot tell."
        )
        turned, unsure = ["angle", "torque"], []
        advice = (
            "Find out which: the angle is positive in dorsiflexion, the torque when the triceps "
            "pulls."
        )
    else:
        both = " and so is the torque" if len(turned) > 1 else ""
        sign = "both signs" if both else "sign"
        text = f"The {turned[0]} is turned{both}: with {sign} = −1 {numbers}"
        text += f"; whether the {unsure[0]} is too, the data cannot tell." if unsure else "."
        advice = f"Write sign = -1 for the {' and the '.join(turned)} in the TOML."
        for name in turned:
            recording = _scaled(recording, name, -1.0)
    texts = [text, "The same of the torque, see angle-sign."]
    return [
        Finding(f"{name}-sign", "error", name, *span, best.r2, "1", message, advice)
        for name, message in zip(turned, texts, strict=False)
    ], recording


def _percent(r2: float) -> str:
    """R² in percent, with the digits that matter near 100."""
    text = f"{100.0 * r2:.1f}" if r2 > 0.9 else f"{100.0 * r2:.0f}"
    return f"{text.replace('-', '−')} %"


def _scaled(recording: Recording, role: str, factor: float) -> Recording:
    channel = recording.channels[role]
    scaled = replace(channel, values=read_only(channel.values * factor))
    return replace(recording, channels={**recording.channels, role: scaled})


def _still(signals: Signals) -> Finding | None:
    """A static hold: nothing moves, so nothing says what depends on the angle."""
    low, high = quantiles(signals.angle, 0.005, 0.995)
    if high - low >= STILL:
        return None
    return Finding(
        "angle-still", "error", "angle", signals.time[0], signals.time[-1], high - low, "rad",
        f"The angle stays within {np.rad2deg(high - low):.2g}°: a static hold, nothing moves.",
        "Record a trial that moves; a hold says nothing of stiffness, lengths and relaxation.",
    )  # fmt: skip


def _zero(recording: Recording, signals: Signals, fit: QuickFit) -> Finding | None:
    """A torque whose zero is off by more than a foot can weigh."""
    if recording.fixed.get("m") == 0.0 or abs(fit.zero) < _ZERO or fit.r2 < _GOOD_ENOUGH:
        return None
    without = quick_fit(recording, signals, zero=False)
    if without is None or without.left < _ZERO_GAIN * fit.left:
        return None
    return Finding(
        "torque-offset", "warning", "torque", signals.time[0], signals.time[-1], fit.zero, "Nm",
        f"The torque's zero is off by about {fit.zero:.2g} Nm: with that taken away R² rises from "
        f"{_percent(without.r2)} to {_percent(fit.r2)}.",
        "Set the sensor to zero with the empty footplate and record again, or give the torque an "
        "offset in the TOML.",
    )  # fmt: skip


def _borne_out(constant: Finding, fit: QuickFit) -> bool:
    """Whether a fit's zero goes the way, and a part of it, that the torque's constant part says."""
    beyond = (constant.value or 0.0) - sum(GRAVITY) / 2
    return bool(fit.zero * beyond >= _AGREED * beyond**2)


#: A finding on a unit, and the recording with that unit put right.
_Righted = tuple[Finding, Recording]


def _time_unit(recording: Recording) -> _Righted | None:
    """Times in ms or µs that are said to be in seconds."""
    angle = recording.channels["angle"]
    seconds, rate = float(angle.time[-1] - angle.time[0]), angle.rate_hz
    for unit, factor in (("ms", 1e-3), ("µs", 1e-6)):
        lasting, true_rate = seconds * factor, rate / factor
        plausible = _SECONDS[0] <= lasting <= _SECONDS[1] and _RATES[0] <= true_rate <= _RATES[1]
        if rate >= _RATES[0] or not plausible:
            continue
        message = (
            f"The time goes on for {seconds:.4g} s with {rate:.3g} samples a second: in {unit}, "
            f"these are {lasting:.3g} s at {true_rate:.4g} Hz."
        )
        advice = (
            f"The times are in {unit}: name the column time_{unit}, or divide by {1 / factor:g}."
        )
        told = Finding(
            "time-unit", "error", "time", angle.time[0], angle.time[-1], seconds, "s", message,
            advice,
        )  # fmt: skip
        channels = {
            role: replace(c, time=read_only(c.time * factor))
            for role, c in recording.channels.items()
        }
        return told, replace(recording, channels=channels)
    return None


def _torque_unit(recording: Recording) -> _Righted | None:
    """A torque in mNm or kNm that is said to be in Nm."""
    torque = recording.channels.get("torque")
    if torque is None:
        return None
    top = quantile(np.abs(torque.values), 0.99)
    least, most = _TORQUES
    for unit, factor in (("mNm", 1e-3), ("kNm", 1e3)):
        if least <= top <= 2.0 * most or not least <= top * factor <= most:
            continue
        right = _scaled(recording, "torque", factor)
        before, after = (_r2(each) for each in (recording, right))
        numbers = f" R² rises from {before} to {after}." if before and after else ""
        told = Finding(
            "torque-unit", "error", "torque", torque.time[0], torque.time[-1], top, "Nm",
            f"The torque reaches {top:.3g} Nm: taken as {unit}, {top * factor:.3g} Nm.{numbers}",
            f'Write unit = "{unit}" for the torque in the TOML, or multiply it by {factor:g}.',
        )  # fmt: skip
        return told, right
    return None


def _r2(recording: Recording) -> str:
    signals = signals_of(recording) if unfit(recording) is None else None
    fit = None if signals is None else quick_fit(recording, signals, zero=False)
    return "" if fit is None else _percent(fit.r2)


def _emg_unit(recording: Recording) -> _Righted | None:
    """EMG of one muscle, or of all, in mV or µV that is said to be in volts."""
    tops = {}
    for role, channel in recording.channels.items():
        if role.startswith("emg_") and channel.unit == "V":
            low, middle, high = quantiles(channel.values, 0.01, 0.5, 0.99)
            if high > low:
                tops[role] = max(high - middle, middle - low)
    if not tops:
        return None
    largest = max(tops, key=lambda role: tops[role])
    others = [top for role, top in tops.items() if role != largest]
    channel, top = recording.channels[largest], tops[largest]
    span = float(channel.time[0]), float(channel.time[-1])
    muscle = muscle_name(largest.removeprefix("emg_"))
    if others and top > _MUSCLES * max(others):
        factor = 1e-6 if top > 1e4 * max(others) else 1e-3
        unit = "µV" if factor == 1e-6 else "mV"
        told = Finding(
            "emg-unit", "error", largest, *span, top, "V",
            f"The EMG of the {muscle} reaches {top:.3g} V, that of the others {max(others):.2g} V: "
            f"taken as {unit}, {top * factor:.2g} V.",
            f'Write unit = "{unit}" for {largest} in the TOML.',
        )  # fmt: skip
        return told, _scaled(recording, largest, factor)
    if others and top * _MUSCLES < max(others):
        return None
    if top <= _SKIN:
        return None
    if top <= _AMPLIFIER:
        return Finding(
            "emg-unit", "info", None, *span, top, "V",
            f"The EMG reaches {top:.2g} V, more than skin gives: mV, or volts behind an amplifier.",
            "Give the unit or the amplifier's gain if weights are to be compared with other legs.",
        ), recording  # fmt: skip
    told = Finding(
        "emg-unit", "error", None, *span, top, "V",
        f"The EMG reaches {top:.3g} V: taken as µV, {top * 1e-6:.2g} V.",
        'Write unit = "µV" for the EMG in the TOML.',
    )  # fmt: skip
    for role in tops:
        recording = _scaled(recording, role, 1e-6)
    return told, recording


def _without_false_lags(
    recording: Recording, signals: Signals, quality: Quality, first: QuickFit
) -> Quality:
    """Leave out the lags that do not make a fit better when they are taken away."""
    kept = []
    for finding in quality.findings:
        if finding.code in ("electrode-lag", "emg-torque-lag") and finding.value is not None:
            muscles = MUSCLES if finding.channel is None else (finding.channel[4:],)
            later = dict.fromkeys(muscles, finding.value)
            shifted_fit = quick_fit(recording, signals, later=later)
            if shifted_fit is None or shifted_fit.left > (1.0 - _SHIFT_GAIN) * first.left:
                continue
        kept.append(finding)
    return replace(quality, findings=tuple(kept))
