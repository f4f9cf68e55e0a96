"""A recording of the virtual subject, for whoever has none at hand."""

from surae.recording import Recording
from surae.studies.imperfections import Imperfections

#: The torque sensor's noise [Nm]; raw EMG brings its own.
_NOISE = Imperfections(torque_noise=0.3, torque_noise_time=0.02)
#: Sampling rate of all channels, as raw EMG needs it [Hz].
_RATE = 2048.0


def demo_recording(trial: int) -> Recording:
    """A trial of the subject of `surae demo`, on the same device, with raw EMG.

    Parameters
    ----------
    trial : int
        1, 2 …; trials differ in their noise.
    """
    from dataclasses import replace

    from surae.protocol import Protocol, generate, named_device
    from surae.studies import virtual_recording, virtual_subject

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
    channels = {role: replace(one, source="simulated") for role, one in made.channels.items()}
    return replace(made, name=f"virtual subject, trial {trial}", side="right", channels=channels)
