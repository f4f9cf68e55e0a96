"""A trajectory as a file for a device's controller: CSV, or MATLAB."""

import io

import numpy as np

from surae.files import PathLike, write_atomic
from surae.protocol.protocol import Trajectory
from surae.recording import MUSCLES

#: Column names: the position to follow and the effort to show to the subject.
COLUMNS = ("time_s", "angle_rad", *(f"emg_{muscle}" for muscle in MUSCLES))


def write_csv(trajectory: Trajectory, path: PathLike) -> None:
    """Write `COLUMNS` as CSV, 12 significant digits, all of it or nothing.

    Raises
    ------
    InputError
        The file cannot be written.
    """
    table = np.column_stack([trajectory.time, trajectory.angle, trajectory.effort])
    text = io.StringIO()
    np.savetxt(text, table, fmt="%.12g", delimiter=",", header=",".join(COLUMNS), comments="")
    write_atomic(path, text.getvalue())


def write_mat(trajectory: Trajectory, path: PathLike) -> None:
    """Write a MATLAB v5 file, all of it or nothing.

    Its variables are column vectors: `COLUMNS`, ``angular_velocity_rad_s`` and
    ``angular_acceleration_rad_s2``; and the scalar ``rate_hz``.

    Raises
    ------
    InputError
        The file cannot be written.
    """
    from scipy.io import savemat

    columns = (trajectory.time, trajectory.angle, *trajectory.effort.T)
    variables = dict(zip(COLUMNS, columns, strict=True)) | {
        "angular_velocity_rad_s": trajectory.velocity,
        "angular_acceleration_rad_s2": trajectory.acceleration,
        "rate_hz": np.float64(trajectory.settings.rate_hz),
    }
    data = io.BytesIO()
    savemat(data, variables, oned_as="column")
    write_atomic(path, data.getvalue())
