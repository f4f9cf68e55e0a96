"""Measurement protocols: position profiles, effort tasks, device limits, files."""

from surae.protocol.adaptation import Adaptation
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
    "PROFILES",
    "TASKS",
    "Adaptation",
    "Device",
    "Given",
    "Profile",
    "Protocol",
    "Task",
    "Trajectory",
    "allowed_range",
    "chirp",
    "chirp_rate",
    "generate",
    "named_device",
    "read_device",
    "read_protocol",
    "write_protocol",
    "write_protocol_csv",
    "write_protocol_mat",
    "write_protocol_target",
]
