"""What the package offers, one line each, and where it is made."""

from surae.protocol.adaptation import Adaptation as Adaptation
from surae.protocol.device import DEVICES as DEVICES
from surae.protocol.device import Device as Device
from surae.protocol.device import allowed_range as allowed_range
from surae.protocol.device import named_device as named_device
from surae.protocol.device import read_device as read_device
from surae.protocol.effort import DIRECTIONS as DIRECTIONS
from surae.protocol.effort import TASKS as TASKS
from surae.protocol.effort import Task as Task
from surae.protocol.export import read_protocol as read_protocol
from surae.protocol.export import write_protocol as write_protocol
from surae.protocol.export import write_protocol_csv as write_protocol_csv
from surae.protocol.export import write_protocol_mat as write_protocol_mat
from surae.protocol.export import write_protocol_target as write_protocol_target
from surae.protocol.profiles import PROFILES as PROFILES
from surae.protocol.profiles import Profile as Profile
from surae.protocol.profiles import chirp as chirp
from surae.protocol.profiles import chirp_rate as chirp_rate
from surae.protocol.protocol import Given as Given
from surae.protocol.protocol import Protocol as Protocol
from surae.protocol.protocol import Trajectory as Trajectory
from surae.protocol.protocol import generate as generate
