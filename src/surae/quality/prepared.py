"""Prepared signals as a recording, for fits of what no file holds."""

from surae.recording import MUSCLES, Channel, Recording
from surae.signals import ModelInputs
from surae.units import FloatArray


def recording_of(inputs: ModelInputs) -> Recording:
    """The recording whose channels are prepared signals, EMG as envelopes."""

    def channel(role: str, values: FloatArray, unit: str) -> Channel:
        return Channel(role, inputs.time, values, unit, "prepared")

    channels = {"angle": channel("angle", inputs.angle, "rad")}
    if inputs.torque is not None:
        channels["torque"] = channel("torque", inputs.torque, "Nm")
    for k, muscle in enumerate(MUSCLES):
        if muscle not in inputs.missing_emg:
            channels[f"emg_{muscle}"] = channel(f"emg_{muscle}", inputs.emg[:, k], inputs.emg_unit)
    return Recording(inputs.name, channels, emg="envelope", fixed=inputs.fixed, files=inputs.files)
