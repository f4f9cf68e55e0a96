"""Measurement protocols: position profiles, effort tasks, device limits, coverage, files."""

from surae.protocol.adaptation import Adaptation
from surae.protocol.chirp import chirp_rate
from surae.protocol.coverage import Coverage, coverage
from surae.protocol.device import DEVICES, Device, named_device
from surae.protocol.effort import TASKS, Task
from surae.protocol.export import write_csv, write_mat
from surae.protocol.profiles import PROFILES, Profile
from surae.protocol.protocol import Protocol, Trajectory, generate

__all__ = [
    "DEVICES",
    "PROFILES",
    "TASKS",
    "Adaptation",
    "Coverage",
    "Device",
    "Profile",
    "Protocol",
    "Task",
    "Trajectory",
    "chirp_rate",
    "coverage",
    "generate",
    "named_device",
    "write_csv",
    "write_mat",
]
