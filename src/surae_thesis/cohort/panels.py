"""Traces of single recordings: a prediction (Figure 31), three repetitions' spectra (Figure 40)."""

from collections.abc import Sequence

import numpy as np
from matplotlib.figure import Figure

from surae.report.figures import (
    BLUE,
    GREY,
    INK,
    OCHRE,
    RED,
    dress,
    heading,
    legend,
    new_figure,
    trace,
)
from surae.units import FloatArray

#: Length of the segments whose spectra are averaged [s], and the highest frequency drawn [Hz].
_SEGMENT, _HIGHEST = 8.0, 60.0
_LINES = ((INK, "-", 1.0), (RED, (0, (5, 1.5)), 1.1), (BLUE, (0, (1.2, 1.0)), 1.3))


def prediction_panels(
    time: FloatArray, angle: FloatArray, measured: FloatArray, predicted: FloatArray
) -> Figure:
    """Angle, and the torque measured and predicted, of one recording; arrays of shape (n,)."""
    figure = new_figure(4.6)
    top, bottom = figure.subplots(2, 1, sharex=True, height_ratios=(1.0, 1.6))
    dress(top, "Angle [rad]")
    heading(top, "Ankle angle, dorsiflexion positive")
    trace(top, time, angle, color=INK, linewidth=1.1)
    dress(bottom, "Torque [Nm]", "Time [s]")
    heading(bottom, "Torque, triceps positive")
    trace(bottom, time, measured, label="measured", color=GREY, linewidth=3.0)
    trace(bottom, time, predicted, label="predicted", color=BLUE, linewidth=1.0)
    legend(bottom, 2)
    bottom.set_xlim(float(time[0]), float(time[-1]))
    return figure


def spectrum(signal: FloatArray, rate_hz: float) -> tuple[FloatArray, FloatArray]:
    """Frequency [Hz] and power density (Welch, Hann windows of 8 s) of a signal, in dB."""
    from scipy.signal import welch

    n = min(int(_SEGMENT * rate_hz), len(signal))
    frequency, power = welch(signal - signal.mean(), rate_hz, nperseg=n)
    return frequency, 10.0 * np.log10(np.maximum(power, 1e-300))


def spectra_figure(signals: Sequence[FloatArray], rate_hz: float) -> Figure:
    """Power spectral density of the torque of repetitions [Nm]; two panels, wide and near zero."""
    figure = new_figure(3.6)
    wide, near = figure.subplots(1, 2, width_ratios=(1.3, 1.0))
    for axes, highest, title in ((wide, _HIGHEST, "Torque"), (near, 8.0, "Its lowest frequencies")):
        dress(axes, "Power density [dB re 1 Nm²/Hz]", "Frequency [Hz]")
        heading(axes, title)
        for number, signal in enumerate(signals):
            frequency, power = spectrum(signal, rate_hz)
            shown = (frequency <= highest) & (frequency > 0.0)
            colour, dash, width = (*_LINES, (OCHRE, "-", 1.0))[number]
            axes.plot(
                frequency[shown], power[shown], color=colour, linestyle=dash, linewidth=width,
                label=f"repetition {number + 1}",
            )  # fmt: skip
        axes.set_xlim(0.0, highest)
    wide.legend(loc="upper right", frameon=False, fontsize=8, labelcolor=INK)
    return figure
