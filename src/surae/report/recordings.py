"""One recording in words: its facts, and what its figures show."""

from collections.abc import Sequence

import numpy as np

from surae.base.formatting import NO_NUMBER, chance, percentage, short, signed, significant
from surae.base.units import FloatArray
from surae.inference import RecordingQuality, Whiteness
from surae.inference.judging.fascicles import FascicleQuality, Fascicles
from surae.recording.table import sample
from surae.report import block
from surae.report.provenance import excluded_text
from surae.report.traces import Traces
from surae.signals.cycles import find_cycles


def recording_section(
    number: int, quality: RecordingQuality, traces: Traces, white: Whiteness
) -> block.Section:
    """Describe a recording, its fit and the residual."""
    low = float(traces.angle.min())
    high = float(traces.angle.max())
    joint = traces.joint
    span = f"{signed(low, 2)} … {signed(high, 2)} rad"
    degrees = f"{signed(np.degrees(low), 0)} … {signed(np.degrees(high), 0)}°"
    least = float(traces.measured.min())
    most = float(traces.measured.max())
    duration = quality.n / quality.rate_hz
    facts = [
        ("Centred R²", f"{percentage(quality.r2)} %"),
        ("VAF", f"{percentage(quality.vaf)} %"),
        ("RMSE", f"{significant(quality.rmse, 3)} Nm"),
        ("Mean residual", f"{significant(quality.bias, 2)} Nm"),
        ("Measured torque", f"{signed(least, 1)} … {signed(most, 1)} Nm"),
        ("Angle", f"{span} ({degrees})"),
        ("Duration", f"{short(round(duration, 2))} s"),
        ("Samples", f"{quality.n} at {short(quality.rate_hz)} Hz"),
    ]
    if quality.vaf_weighted is not None:
        facts.append(("VAF, weighted as in the fit", f"{percentage(quality.vaf_weighted)} %"))
    if excluded := excluded_text(traces.time, traces.weight):
        facts.append(("Left out of the fit", excluded))
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
    count = 0 if cycles is None else len(cycles.spans)
    torque_alt = (
        f"Panels against {short(round(duration, 2))} s of time: EMG that was recorded; "
        f"{joint.name} angle from {span.replace('…', 'to')}; measured and modelled torque, VAF "
        f"{percentage(quality.vaf)} %; parts of the modelled torque."
    )
    over = (
        f"Beside time, the mean and the standard deviation over {count} cycles, each from one "
        f"largest {joint.directions[0]} to the next. "
    )
    residual = (
        block.Text(text),
        block.Picture(
            f"residual-{number}",
            f"Residual torque against time, RMS {significant(quality.rmse, 3)} Nm; its "
            f"autocorrelation, {significant(white.lag1, 2)} at the first lag and within the "
            f"white-noise band after {significant(white.fall_s, 2)} s.",
            "Top: residual over time. Bottom: its autocorrelation; a white residual stays within "
            "the band.",
            width=85,
        ),
    )
    blocks: list[block.Block] = [
        block.facts(facts),
        *block.paragraphs(warnings_of(traces), "warning"),
        block.Explorer(
            number, torque_alt, " Grey: left out of the fit." if traces.excluded else ""
        ),
        block.Picture(
            f"torque-{number}",
            torque_alt,
            (over if count else "")
            + joint.worded(
                "EMG envelopes, ankle angle, measured (wide, pale) and modelled (thin, dark) "
                "torque, and the parts of the modelled torque: passive tissue, muscle (active "
                "contraction), inertia and gravity of foot and footplate."
            ),
            "still cycles" if count else "still",
        ),
        block.Section("Residual: measured minus modelled torque", residual, look="residual"),
    ]
    if traces.tendon is not None:
        blocks.append(_tendons(number))
    blocks += [film_block(f"film-{number}-{place}", f) for place, f in enumerate(traces.films)]
    return block.Section(
        f"Recording: {quality.name}", tuple(blocks), f"recording-{number + 1}", "recording"
    )


def film_facts(film: FascicleQuality) -> list[tuple[str, str]]:
    """How well a filmed fascicle is followed: labels, and what they say."""
    facts = [
        ("RMS error", f"{significant(film.rmse_mm, 2)} mm"),
        ("mean error", f"{significant(film.bias_mm, 2)} mm"),
    ]
    if film.correlation is not None:
        facts.append(("correlation", f"{film.correlation:.3f}"))
    if film.noise_mm is not None:
        noise = f"{significant(film.noise_mm, 2)} mm from frame to frame"
        facts.append(("tracker noise", noise))
    return [*facts, ("frames", f"{film.n}")]


def film_lines(name: str, films: Sequence[FascicleQuality]) -> list[str]:
    """How well each film of a recording is followed, a line each."""
    return [
        f"{name}: {film.channel}: "
        + ", ".join(f"{label} {text}" for label, text in film_facts(film))
        for film in films
    ]


def film_block(name: str, film: Fascicles) -> block.Section:
    """How well a filmed fascicle is followed, and its figure."""
    lengths = _range(1e3 * film.measured, 1)
    picture = block.Picture(
        name,
        f"Measured and modelled torque, fascicle length and tendon stretch against time, and force "
        f"against both. The fascicle goes over {lengths} mm; RMS error "
        f"{significant(film.quality.rmse_mm, 2)} mm.",
        "Wide and pale: measured. Thin and dark: the model. The film shows the fascicle; the "
        "tendon’s part is the length of the path less the fascicle. Force is the model’s. A drift "
        "of the tracker by 1 to 2 mm is usual.",
    )
    facts = block.facts(
        (label[0].upper() + label[1:], text) for label, text in film_facts(film.quality)
    )
    return block.Section(f"Film: {film.channel} of {film.recording}", (facts, picture), look="film")


def _tendons(number: int) -> block.Section:
    """The figure of what muscle and tendon of each group do."""
    picture = block.Picture(
        f"tendon-{number}",
        "Muscle length and velocity in optimal lengths, tendon elongation and tendon force "
        "against time, and force against elongation of the fitted tendon, for both groups.",
        "Muscle length and velocity in optimal lengths l0, and what they would be on a rigid "
        "tendon (wide, pale); elongation and force of the tendon, with the force at which its toe "
        "ends. Bottom: the tendon’s force against its elongation, equation (18), with the range "
        "that this recording used (wide, pale).",
        width=64,
    )
    return block.Section("Muscles and tendons", (picture,), look="tendons")


def _range(values: FloatArray, decimals: int) -> str:
    known = values[np.isfinite(values)]
    if not known.size:
        return NO_NUMBER
    return f"{signed(float(known.min()), decimals)} … {signed(float(known.max()), decimals)}"


def warnings_of(traces: Traces) -> tuple[str, ...]:
    """Warn where the model has no finite number."""
    texts = []
    if traces.tendon is not None:
        for name, first in zip(traces.joint.headings, traces.tendon.unsolved, strict=True):
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
