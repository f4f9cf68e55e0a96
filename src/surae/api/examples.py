"""A recording for whoever has none at hand."""

from dataclasses import replace

from surae.files import PathLike
from surae.protocol import Protocol, generate, named_device
from surae.recording import Recording, csv_columns, write_csv
from surae.studies import Imperfections, virtual_recording, virtual_subject

#: The torque sensor's noise [Nm]; raw EMG brings its own.
_NOISE = Imperfections(torque_noise=0.3, torque_noise_time=0.02)
#: Sampling rate of all channels, as raw EMG needs it [Hz].
_RATE = 2048.0


def example(path: PathLike | None = None, *, trial: int = 1) -> Recording:
    """A trial of a virtual subject on an ankle robot: angle, torque and raw EMG of four muscles.

    Parameters
    ----------
    path : path, optional
        A file to write it to as well, as our CSV.
    trial : int
        1, 2, …: trials of the same leg, which differ in their noise.

    Returns
    -------
    Recording
        In SI units; always the same.

    Raises
    ------
    InputError
        The file cannot be written.
    """
    protocol = Protocol(
        profile="multiple-holds",
        chirp_amplitude=0.2,
        chirp_rate=0.159,
        rate_hz=_RATE,
        device=named_device("achilles"),
    )
    made = virtual_recording(
        virtual_subject(seed=1), generate(protocol), seed=trial, imperfections=_NOISE
    )
    channels = {role: replace(each, source="simulated") for role, each in made.channels.items()}
    name = f"virtual subject, trial {trial}"
    recording = replace(made, name=name, side="right", channels=channels)
    if path is not None:
        write_csv(path, csv_columns(recording), [f"name: {name}", "emg: raw"])
    return recording
