"""What a step reads and what it remembers, field by field, for Python's kernel and for C alike."""

import numpy as np

from surae.model.compliant_stage import PAST
from surae.signals.settings import MAXIMUM_ORDER

#: Sections of one pass of a filter of the highest order; a high-pass goes over twice.
LOW_SECTIONS = (MAXIMUM_ORDER + 1) // 2
HIGH_SECTIONS = 2 * LOW_SECTIONS
#: Own parameters of a muscle group, as `surae.model.compliant` takes them.
GROUP = 16
#: Times with which a tissue's curve may relax.
RELAXING = 8
#: What a predicted torque's doubt is a quadratic form of, see `doubt_terms`.
DOUBT = 17
#: The first of these that is a torque [Nm].
FIRST_TORQUE = 4
#: Drives of each group: EMG, stretch. Stages of each sample: the first, the sample itself.
DRIVES = 2
STAGES = 2
#: Columns of a path's table: the knot, then cubics of length and arm, triceps before tibialis.
PATH = 17

#: What stays as it is: name, type and shape.
NUMBERS = (
    ("dt", "f8", ()),  # sample time [s]
    ("angle_gains", "f8", (3,)),  # of the angle, its speed and its acceleration
    ("raw", "i8", ()),  # whether EMG is raw
    ("high", "f8", (HIGH_SECTIONS, 6)),
    ("highs", "i8", ()),
    ("low", "f8", (LOW_SECTIONS, 6)),
    ("lows", "i8", ()),
    ("emg_scale", "f8", (4,)),  # what EMG is multiplied by, 0 of a muscle without it
    ("effort_gain", "f8", ()),  # of each of the three stages that smooth effort
    ("lag", "f8", ()),
    ("rest", "f8", (4,)),
    ("unmix", "i8", ()),  # 0: no crosstalk, 1: envelopes add up, 2: powers do
    ("inverse", "f8", (4, 4)),
    ("release", "f8", ()),
    ("curved", "i8", ()),
    ("shape", "f8", ()),
    ("power", "f8", ()),
    ("reference", "f8", (4,)),
    ("weights", "f8", (4,)),
    ("late", "i8", (DRIVES,)),  # whether a drive begins at its first sample and is delayed
    ("back", "i8", (DRIVES, STAGES)),  # whole samples of the delay
    ("part", "f8", (DRIVES, STAGES, 4)),  # the active state at a stage
    ("whole", "f8", (2, 4)),  # the filter one sample on
    ("held", "f8", (STAGES, 4)),  # what is not delayed: the drive's first sample
    ("reflexes", "f8", (2, 3)),  # gains of both groups to speed, length and force
    ("angle_zero", "f8", ()),
    ("has_axis", "i8", ()),
    ("forward", "f8", ()),
    ("up", "f8", ()),
    ("strap", "f8", ()),
    ("theta_foot", "f8", ()),
    ("mass", "f8", ()),
    ("range", "f8", (2,)),  # of the path's table [rad]
    ("has_own_path", "i8", (2,)),
    ("own_path", "f8", (2, 6)),  # scale, slope and bend of the arm, scale and bend, zero of length
    ("at_rest", "f8", (2,)),
    ("groups", "f8", (2, GROUP)),
    ("compliant", "i8", ()),
    ("tendon_unit", "f8", (2,)),  # what ε0 is multiplied by to be metres
    ("vmax_factor", "f8", ()),
    ("relax", "f8", (3,)),  # of a rigid group's tissue
    ("zero", "f8", ()),
    ("plate", "f8", (3,)),
    ("joint", "f8", (3,)),  # stiffness, torque, damping
    ("noise", "f8", ()),  # standard deviation that the parameters have no part in [Nm]
    ("doubt", "f8", (DOUBT, DOUBT)),
)

#: What a step remembers.
STATE = (
    ("count", "i8", ()),
    ("angle", "f8", ()),
    ("velocity", "f8", ()),
    ("acceleration", "f8", ()),
    ("high", "f8", (4, HIGH_SECTIONS, 2)),
    ("low", "f8", (4, LOW_SECTIONS, 2)),
    ("envelope", "f8", (4,)),
    ("envelope_rate", "f8", (4,)),
    ("smooth", "f8", (4, 3)),
    ("smooth_rate", "f8", (4,)),
    ("own", "f8", (4,)),  # the muscles' own envelopes
    ("first", "f8", (2, DRIVES)),
    ("filter", "f8", (2, DRIVES, STAGES, 2)),
    ("held", "f8", (2,)),
    ("elastic", "f8", (2,)),
    ("relaxation", "f8", (2,)),
    ("past", "f8", (2, PAST)),
    ("length", "f8", (2,)),
    ("speed", "f8", (2,)),
    ("active", "f8", (STAGES,)),
    ("curve", "f8", (RELAXING,)),
    ("curve_first", "f8", ()),
    ("parts", "f8", (8,)),
    ("neural", "f8", (2,)),
    ("neural_rate", "f8", (2,)),
    ("torque", "f8", ()),
    ("sd", "f8", ()),
    ("failed", "i8", ()),
)


def record(fields: tuple[tuple[str, str, tuple[int, ...]], ...]) -> "np.dtype[np.void]":
    """The record of these fields, as numba takes one."""
    return np.dtype([(name, kind, shape) for name, kind, shape in fields], align=True)


NUMBERS_RECORD = record(NUMBERS)
STATE_RECORD = record(STATE)
