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
#: The slow stretch: there and back between these angles [deg] at such a speed [deg/s], at rest so
#: long at each end [s]; the drive rounds corners within so long [s].
_STRETCHED = (-50.0, 34.0)
_SLOW = 5.0
_RESTS = 2.0
_ROUNDED = 0.3
#: Trials that move: name, profile, effort, duration [s].
_MOVED = (
    ("active_1", "multiple-holds", "active", 25.0),
    ("active_2", "multi-sine-holds", "active", 25.0),
)


def example_leg(folder: PathLike) -> tuple[Path, ...]:
    """Write trials of one virtual leg, with what real measurements have, and give their files."""
    leg = virtual_subject(seed=1)
    movements = {f"held_{angle}deg": _hold(angle) for angle in _HELD}
    movements["slow_stretch"] = _slow_stretch()
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


def _slow_stretch() -> Trajectory:
    """The relaxed ankle, turned slowly over its range and back."""
    low, high = _STRETCHED
    turn = (high - low) / _SLOW
    corners = np.cumsum([0.0, _RESTS, turn, _RESTS, turn, _RESTS])
    time = np.arange(round(corners[-1] * _RATE)) / _RATE
    size = round(_ROUNDED * _RATE) // 2
    there = np.interp(time, corners, [low, low, high, high, low, low])
    padded = np.pad(there, size, mode="edge")
    angle = np.radians(np.convolve(padded, np.full(2 * size + 1, 1.0 / (2 * size + 1)), "valid"))
    velocity = np.gradient(angle, 1.0 / _RATE)
    return Trajectory(
        settings=Given(
            profile="slow-stretch",
            task="passive",
            angle_range=(float(angle.min()), float(angle.max())),
            rate_hz=_RATE,
        ),
        time=time,
        angle=angle,
        velocity=velocity,
        acceleration=np.gradient(velocity, 1.0 / _RATE),
        effort=np.zeros((len(time), 4)),
    )


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
