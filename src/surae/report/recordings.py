"""One recording in words: its facts, and what its figures show."""

from dataclasses import dataclass

import numpy as np

from surae.assessment import RecordingQuality, Whiteness
from surae.recording.samples import sample
from surae.report.cycles import find_cycles
from surae.report.formatting import chance, percentage, short, signed, significant
from surae.report.provenance import Setting, excluded_text
from surae.report.traces import GROUPS, TendonRow, Traces, tendon_rows


@dataclass(frozen=True, slots=True)
class RecordingSection:
    """One recording: its facts, what is wrong with it, and what its figures show in words."""

    name: str
    cycles: int
    left_out: bool
    facts: tuple[Setting, ...]
    warnings: tuple[str, ...]
    torque_alt: str
    residual_alt: str
    residual_text: str
    tendon_alt: str
    tendon: tuple[TendonRow, ...]


def recording_section(
    quality: RecordingQuality, traces: Traces, white: Whiteness
) -> RecordingSection:
    """Describe a recording, its fit and the residual."""
    low, high = float(traces.angle.min()), float(traces.angle.max())
    span = f"{signed(low, 2)} … {signed(high, 2)} rad"
    degrees = f"{signed(np.degrees(low), 0)} … {signed(np.degrees(high), 0)}°"
    least, most = float(traces.measured.min()), float(traces.measured.max())
    duration = quality.n / quality.rate_hz
    facts: tuple[Setting, ...] = (
        Setting("Centred R²", f"{percentage(quality.r2)} %"),
        Setting("VAF", f"{percentage(quality.vaf)} %"),
        Setting("RMSE", f"{significant(quality.rmse, 3)} Nm"),
        Setting("Mean residual", f"{significant(quality.bias, 2)} Nm"),
        Setting("Measured torque", f"{signed(least, 1)} … {signed(most, 1)} Nm"),
        Setting("Angle", f"{span} ({degrees})"),
        Setting("Duration", f"{short(round(duration, 2))} s"),
        Setting("Samples", f"{quality.n} at {short(quality.rate_hz)} Hz"),
    )
    if quality.vaf_weighted is not None:
        facts += (Setting("VAF, weighted as in the fit", f"{percentage(quality.vaf_weighted)} %"),)
    if excluded := excluded_text(traces.time, traces.weight):
        facts += (Setting("Left out of the fit", excluded),)
    tendon = tendon_rows(traces)
    shares = ", ".join(
        f"{name} {signed(float(part.min()), 1)} to {signed(float(part.max()), 1)} Nm"
        for name, part in (
            ("tissue", traces.parts.tissue),
            ("neural", traces.parts.neural),
            ("inertial", traces.parts.inertial),
            ("gravitational", traces.parts.gravitational),
        )
    )
    text = (
        f"Lag-1 autocorrelation {significant(white.lag1, 2)}; white noise would stay within "
        f"±{significant(white.band, 2)}. "
    )
    test = f"Ljung–Box test over {white.lags} lags: {chance(white.p_value)}"
    if white.white:
        text += f"{test}: the residual passes for white noise."
    else:
        text += (
            f"It takes {significant(white.fall_s, 2)} s to fall within that band. {test}: the "
            "residual is correlated over time."
        )
    cycles = find_cycles(traces.angle, traces.rate_hz, traces.counted)
    return RecordingSection(
        name=quality.name,
        cycles=0 if cycles is None else len(cycles.spans),
        left_out=bool(traces.excluded),
        facts=facts,
        warnings=_warnings(traces),
        torque_alt=(
            f"Panels against {short(round(duration, 2))} s of time: EMG that was recorded; "
            f"ankle angle from {span.replace('…', 'to')}; measured and modelled torque, VAF "
            f"{percentage(quality.vaf)} %; parts of the modelled torque: {shares}."
        ),
        residual_alt=(
            f"Residual torque against time, RMS {significant(quality.rmse, 3)} Nm; its "
            f"autocorrelation, {significant(white.lag1, 2)} at the first lag and within the "
            f"white-noise band after {significant(white.fall_s, 2)} s; its histogram."
        ),
        residual_text=text,
        tendon_alt=(
            "Muscle length and velocity in optimal lengths, tendon elongation and tendon force "
            "against time, and force against elongation of the fitted tendon, for both groups. "
            f"{' '.join(row.text for row in tendon)}"
        ),
        tendon=tendon,
    )


def _warnings(traces: Traces) -> tuple[str, ...]:
    """Warn where the model has no finite number."""
    texts = []
    if traces.tendon is not None:
        for name, first in zip(GROUPS, traces.tendon.unsolved, strict=True):
            if first is not None:
                texts.append(
                    f"{name}: the balance of forces could not be solved at {_at(traces, first)}; "
                    "from there on there is no length, force or torque."
                )
    wrong = np.flatnonzero(~np.isfinite(traces.modelled))
    if wrong.size and not texts:
        texts.append(
            "With these parameters the model overflows: its torque is not finite, first at "
            f"{_at(traces, int(wrong[0]))}."
        )
    return tuple(texts)


def _at(traces: Traces, index: int) -> str:
    return f"{sample(index)} ({short(round(float(traces.time[index]), 3))} s)"
