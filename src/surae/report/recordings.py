"""One recording in words: its facts, and what its figures show."""

from dataclasses import dataclass

import numpy as np

from surae.assessment import RecordingQuality
from surae.report.digits import percentage, short, signed, significant
from surae.report.provenance import Setting
from surae.report.traces import Traces
from surae.report.whiteness import Whiteness


@dataclass(frozen=True, slots=True)
class RecordingSection:
    """One recording: its facts, and what its figures show in words."""

    name: str
    facts: tuple[Setting, ...]
    torque_alt: str
    residual_alt: str
    residual_text: str


def recording_section(
    quality: RecordingQuality, traces: Traces, white: Whiteness
) -> RecordingSection:
    """Describe a recording, its fit and the residual."""
    low, high = float(traces.angle.min()), float(traces.angle.max())
    span = f"{signed(low, 2)} … {signed(high, 2)} rad"
    degrees = f"{signed(np.degrees(low), 0)} … {signed(np.degrees(high), 0)}°"
    least, most = float(traces.measured.min()), float(traces.measured.max())
    duration = quality.n / quality.rate_hz
    facts = (
        Setting("VAF", f"{percentage(quality.vaf)} %"),
        Setting("RMSE", f"{significant(quality.rmse, 3)} Nm"),
        Setting("Mean residual", f"{significant(quality.bias, 2)} Nm"),
        Setting("Measured torque", f"{signed(least, 1)} … {signed(most, 1)} Nm"),
        Setting("Angle", f"{span} ({degrees})"),
        Setting("Duration", f"{short(round(duration, 2))} s"),
        Setting("Samples", f"{quality.n} at {short(quality.rate_hz)} Hz"),
    )
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
    if white.coloured:
        text += (
            f"It takes {significant(white.fall_s, 2)} s to fall within that band: the residual is "
            "not white, and the intervals are too narrow by a factor of about "
            f"{significant(white.widening, 2)} (rough guide)."
        )
    else:
        text += "The residual does not make the intervals too narrow."
    return RecordingSection(
        name=quality.name,
        facts=facts,
        torque_alt=(
            f"Four panels against {short(round(duration, 2))} s of time: EMG of four muscles; "
            f"ankle angle from {span.replace('…', 'to')}; measured and modelled torque, VAF "
            f"{percentage(quality.vaf)} %; parts of the modelled torque: {shares}."
        ),
        residual_alt=(
            f"Residual torque against time, RMS {significant(quality.rmse, 3)} Nm; its "
            f"autocorrelation, {significant(white.lag1, 2)} at the first lag and within the "
            f"white-noise band after {significant(white.fall_s, 2)} s; its histogram."
        ),
        residual_text=text,
    )
