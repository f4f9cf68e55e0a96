"""A folder of trials of one virtual leg, as a laboratory would keep it."""

from pathlib import Path

import numpy as np

from surae.base.files import PathLike
from surae.protocol import Given, Protocol, Trajectory, generate, named_device
from surae.recording import csv_columns, write_csv
from surae.studies import realistic_imperfections, virtual_recording, virtual_subject

#: Sampling rate of all channels [Hz].
_RATE = 1024.0
#: Held angles [deg], and for how long [s].
_HELD = (-15, 0, 10, 18)
_HOLD = 8.0
#: Trials that move: name, profile, effort, duration [s].
_MOVED = (
    ("slow_stretch", "ramp-and-hold", "passive", 30.0),
    ("active_1", "multiple-holds", "active", 25.0),
    ("active_2", "multi-sine-holds", "active", 25.0),
)


def example_leg(folder: PathLike) -> tuple[Path, ...]:
    """Write trials of one virtual leg, with what real measurements have, and give their files."""
    leg = virtual_subject(seed=1)
    movements = {f"held_{angle}deg": _hold(angle) for angle in _HELD}
    for name, profile, task, seconds in _MOVED:
        movements[name] = generate(
            Protocol(
                profile=profile,
                task=task,
                duration=seconds,
                rate_hz=_RATE,
                device=named_device("achilles"),
            )
        )
    files = []
    for number, (name, movement) in enumerate(movements.items()):
        recording = virtual_recording(
            leg, movement, seed=number, imperfections=realistic_imperfections(leg)
        )
        files.append(Path(folder) / f"{name}.csv")
        write_csv(files[-1], csv_columns(recording), [f"name: {name}", "emg: raw", "side: right"])
    return tuple(files)


def _hold(degrees: int) -> Trajectory:
    """The ankle held still and relaxed."""
    time = np.arange(round(_HOLD * _RATE)) / _RATE
    still = np.zeros(len(time))
    angle = np.radians(degrees)
    around = (angle - 0.01, angle + 0.01)
    return Trajectory(
        settings=Given(profile="hold", task="passive", angle_range=around, rate_hz=_RATE),
        time=time,
        angle=still + angle,
        velocity=still,
        acceleration=still,
        effort=np.zeros((len(time), 4)),
    )
