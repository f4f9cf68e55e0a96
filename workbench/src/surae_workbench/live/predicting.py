"""A fit's torque while a stream comes in: that of each sample at once, and how late it was."""

import time
from collections.abc import Callable
from dataclasses import dataclass
from typing import TYPE_CHECKING, Any

import numpy as np

from surae.api import MUSCLES
from surae.base.errors import InputError
from surae.base.units import FloatArray
from surae_workbench.live.lsl import lsl, outlet

if TYPE_CHECKING:
    from surae.api import Predictor

#: What the stream of predictions is called.
STREAM = "surae torque"
#: How long a stream is looked for [s].
_PATIENCE_S = 10.0
#: How long is waited for the next sample before the end is looked at [s].
_WAIT_S = 0.2


@dataclass(frozen=True, slots=True)
class LivePrediction:
    """What was predicted of a stream; arrays of shape (n,)."""

    time: FloatArray  #: Stamps of the samples [s].
    torque: FloatArray  #: Predicted [Nm].
    sd: FloatArray  #: Its standard deviation [Nm].
    measured: FloatArray  #: Torque that came with each sample [Nm]; NaN without one.
    latency: FloatArray  #: From a sample's stamp to when its torque was sent [s].

    @property
    def vaf(self) -> float:
        """Variance of the measured torque that is accounted for [%]; NaN without one."""
        e = self.measured - self.torque
        with np.errstate(invalid="ignore", divide="ignore"):
            return float(100.0 * (1.0 - np.sum(e**2) / np.sum(self.measured**2)))

    def __repr__(self) -> str:
        median, late = (1e3 * float(np.percentile(self.latency, q)) for q in (50, 99))
        return (
            f"{len(self.time)} torques sent: VAF {self.vaf:.2f} %, latency {median:.2g} ms "
            f"(median), {late:.2g} ms (99th percentile)"
        )


def predict_stream(
    predictor: "Predictor",
    name: str,
    seconds: float,
    *,
    ready: Callable[[], object] | None = None,
) -> LivePrediction:
    """Predict the torque of every sample of a stream, and send it on as a stream of its own.

    The stream has the channels angle [rad] and emg_ta … emg_gm [V], and may have torque [Nm]; its
    rate is the predictor's.

    Parameters
    ----------
    predictor : Predictor
        As `Fit.predictor` gives it.
    name : str
        Of the stream.
    seconds : float
        How long it is followed [s].
    ready : callable, optional
        Is called once predictions can be heard.

    Returns
    -------
    LivePrediction
        Torques beside the measured ones, and how late each was sent.

    Raises
    ------
    InputError
        There is no such stream, a channel is missing, or its rate is another.
    """
    pylsl = lsl()
    streams = pylsl.resolve_byprop("name", name, timeout=_PATIENCE_S)
    if not streams:
        raise InputError(f"no stream {name!r} within {_PATIENCE_S:g} s; start what sends it")
    inlet = pylsl.StreamInlet(streams[0], max_buflen=60)
    at = _channels(inlet.info(), predictor, name)
    sender = outlet(STREAM, "torque", ["torque", "sd"], ["Nm", "Nm"], predictor.rate_hz, STREAM)
    offset = float(inlet.time_correction(timeout=_PATIENCE_S))
    inlet.open_stream(timeout=_PATIENCE_S)  # else the first samples wait for it
    predictor.reset()
    if ready is not None:
        ready()
    rows: list[tuple[float, ...]] = []
    emg = np.zeros(len(MUSCLES))
    end = time.monotonic() + seconds
    while time.monotonic() < end:
        sample, stamp = inlet.pull_sample(timeout=_WAIT_S)
        if sample is None:
            continue
        for k, column in enumerate(at["emg"]):
            emg[k] = 0.0 if column < 0 else sample[column]
        torque = predictor.step(sample[at["angle"][0]], emg)
        sd = predictor.sd
        sender.push_sample([torque, sd])
        late = pylsl.local_clock() - (stamp + offset)
        measured = float("nan") if at["torque"][0] < 0 else sample[at["torque"][0]]
        rows.append((stamp, torque, sd, measured, late))
    inlet.close_stream()
    if not rows:
        raise InputError(f"stream {name!r} sent no sample in {seconds:g} s")
    return LivePrediction(*np.array(rows).T)


def _channels(info: Any, predictor: "Predictor", name: str) -> dict[str, list[int]]:
    """Where each signal is in a sample; −1 where it is not."""
    labels = list(info.get_channel_labels() or [])
    rate = float(info.nominal_srate())
    if abs(rate - predictor.rate_hz) > 1e-6 * predictor.rate_hz:
        raise InputError(
            f"stream {name!r} comes at {rate:g} Hz, the predictor steps at {predictor.rate_hz:g}; "
            f"make one with fit.predictor({rate:g})"
        )
    if "angle" not in labels:
        raise InputError(f"stream {name!r} has no channel angle; it has: {', '.join(labels)}")
    places = {role: labels.index(role) if role in labels else -1 for role in ("angle", "torque")}
    emg = [labels.index(f"emg_{m}") if f"emg_{m}" in labels else -1 for m in MUSCLES]
    if missing := [m for m, k in zip(MUSCLES, emg, strict=True) if k < 0 and m in predictor.needs]:
        raise InputError(f"stream {name!r} has no emg_{missing[0]}, which the fit has")
    return {"angle": [places["angle"]], "torque": [places["torque"]], "emg": emg}
