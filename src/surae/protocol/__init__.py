"""Measurement protocols: position profiles, effort tasks, device limits, coverage, files."""

from surae.protocol.adaptation import Adaptation
from surae.protocol.coverage import L0_TRI, Coverage, TricepsPath, coverage, triceps_path
from surae.protocol.device import DEVICES, Device, allowed_range, named_device, read_device
from surae.protocol.effort import DIRECTIONS, TASKS, Task
from surae.protocol.export import (
    read_protocol,
    write_protocol,
    write_protocol_csv,
    write_protocol_mat,
    write_protocol_target,
)
from surae.protocol.profiles import PROFILES, Profile, chirp, chirp_rate
from surae.protocol.protocol import Given, Protocol, Trajectory, generate

__all__ = [
    "DEVICES",
    "DIRECTIONS",
    "L0_TRI",
    "PROFILES",
    "TASKS",
    "Adaptation",
    "Coverage",
    "Device",
    "Given",
    "Profile",
    "Protocol",
    "Task",
    "Trajectory",
    "TricepsPath",
    "allowed_range",
    "chirp",
    "chirp_rate",
    "coverage",
    "generate",
    "named_device",
    "read_device",
    "read_protocol",
    "triceps_path",
    "write_protocol",
    "write_protocol_csv",
    "write_protocol_mat",
    "write_protocol_target",
]
