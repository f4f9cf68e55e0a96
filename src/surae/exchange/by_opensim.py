"""Lengths of paths as OpenSim itself states them, where its package is installed.

Of a path that goes round two cylinders at once OpenSim 4.6 states a length that is not that of the
path that it draws, by some millimetres. A model that is to run there needs OpenSim's.
"""

import importlib.util
from collections.abc import Mapping
from typing import Any

import numpy as np

from surae.base.errors import ComputationError, InputError
from surae.base.units import FloatArray
from surae.processes import guarded

#: What OpenSim may take at most [s, bytes].
_SECONDS = 60.0
_MEMORY = 4 * 2**30


def is_there() -> bool:
    """Whether OpenSim's package can be used."""
    return importlib.util.find_spec("opensim") is not None


def lengths(
    path: str, muscle: str, coordinate: str, values: FloatArray, pose: Mapping[str, float]
) -> FloatArray | None:
    """Lengths [m] of a muscle's path at values of a coordinate, others in a pose [rad, m].

    None where OpenSim cannot say them: its package is not installed, or fails of this model.
    """
    if not is_there():
        return None
    try:
        answer: Any = guarded(
            f"{__name__}:measured",
            {
                "path": path,
                "muscle": muscle,
                "coordinate": coordinate,
                "values": values.tolist(),
                "pose": dict(pose),
            },
            seconds=_SECONDS,
            memory=_MEMORY,
        )
    except (ComputationError, InputError):
        return None
    return np.asarray(answer["lengths"], dtype=np.float64)


def measured(
    path: str, muscle: str, coordinate: str, values: list[float], pose: dict[str, float]
) -> dict[str, Any]:
    """What `lengths` says, in a child process."""
    import opensim

    opensim.Logger.setLevelString("off")
    model = opensim.Model(path)
    state = model.initSystem()
    coordinates = model.getCoordinateSet()
    for place in range(coordinates.getSize()):
        each = coordinates.get(place)
        if each.getName() in pose and not each.isConstrained(state):
            each.setValue(state, pose[each.getName()], False)
    turned = coordinates.get(coordinate)
    of = model.getMuscles().get(muscle)
    lengths = []
    for value in values:
        turned.setValue(state, value, False)
        model.realizePosition(state)
        lengths.append(float(of.getLength(state)))
    return {"lengths": lengths}
