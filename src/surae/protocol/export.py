"""A trajectory as a file for a device's controller: CSV, read back too, or MATLAB."""

import io

import numpy as np

from surae.base.errors import InputError
from surae.base.files import PathLike, shown, write_atomic
from surae.base.names import FITTED
from surae.base.units import FloatArray
from surae.protocol.protocol import Given, Protocol, Trajectory
from surae.recording import MUSCLES
from surae.recording.formats import open_table
from surae.recording.source import open_source
from surae.signals.resample import derivatives

#: What a file says of the virtual legs by which its torque is judged, where they are others.
_LEGS = "virtual legs: "
#: Column names: the position to follow and the effort to show to the subject.
COLUMNS = ("time_s", "angle_rad", *(f"emg_{muscle}" for muscle in MUSCLES))


def write_protocol(
    trajectory: Trajectory, path: PathLike, *, without_limits: str | None = None
) -> None:
    """Write a protocol for a device: CSV, or MATLAB where the path ends in ``.mat``.

    Parameters
    ----------
    trajectory : Trajectory
        The protocol.
    path : path
        Where to.
    without_limits : str, optional
        Why it may be written though no device's limits were kept; the reason goes into the file.

    Raises
    ------
    InputError
        It was made for no device and no reason is given, or the file cannot be written.
    """
    reason = " ".join((without_limits or "").split())
    if trajectory.settings.device is None and not reason:
        raise InputError(
            "no device: its limits would not be kept, so nothing is written; name the device, or "
            "say why it may be written without limits"
        )
    write = write_protocol_mat if str(path).lower().endswith(".mat") else write_protocol_csv
    write(trajectory, path, note=f"without limits: {reason}" if reason else "")


def write_protocol_target(trajectory: Trajectory, path: PathLike) -> None:
    """Write what the subject's screen shows: time, and the target effort of either direction.

    Columns are ``time_s,plantarflexion,dorsiflexion``, 0 to 1 of the largest effort; of the
    triceps it is the mean of its heads.

    Raises
    ------
    InputError
        The file cannot be written.
    """
    effort = trajectory.effort[:, 1:].mean(axis=1), trajectory.effort[:, 0]
    _write(path, "time_s,plantarflexion,dorsiflexion", [trajectory.time, *effort], "%.6g")


def write_protocol_csv(trajectory: Trajectory, path: PathLike, *, note: str = "") -> None:
    """Write `COLUMNS` as CSV, 12 significant digits, all of it or nothing, after a note.

    Raises
    ------
    InputError
        The file cannot be written.
    """
    columns = [trajectory.time, trajectory.angle, *trajectory.effort.T]
    made_for = trajectory.settings.legs
    about = [note] * bool(note) + [_LEGS + made_for] * (made_for != Protocol.legs)
    _write(path, "".join(f"# {line}\n" for line in about) + ",".join(COLUMNS), columns, "%.12g")


def _write(path: PathLike, header: str, columns: list[FloatArray], form: str) -> None:
    text = io.StringIO()
    table = np.column_stack(columns)
    np.savetxt(text, table, fmt=form, delimiter=",", header=header, comments="")
    write_atomic(path, text.getvalue())


def write_protocol_mat(trajectory: Trajectory, path: PathLike, *, note: str = "") -> None:
    """Write a MATLAB v5 file, all of it or nothing.

    Its variables are column vectors: `COLUMNS`, ``angular_velocity_rad_s`` and
    ``angular_acceleration_rad_s2``; the scalar ``rate_hz``; and the text ``note``, if there is one.

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
    if note:
        variables["note"] = np.array(note)
    data = io.BytesIO()
    savemat(data, variables, oned_as="column")
    write_atomic(path, data.getvalue())


def read_protocol(path: PathLike) -> Trajectory:
    """Read a protocol that was written as CSV; its velocity and acceleration are differences.

    Parameters
    ----------
    path : path
        With the columns `COLUMNS`, in any order.

    Returns
    -------
    Trajectory
        Its range of motion is that of the angles.

    Raises
    ------
    InputError
        It cannot be read, lacks a column, or is no uniformly sampled protocol.
    """
    source = open_source(path)
    table = open_table(source)
    where = source.shown
    if missing := [name for name in COLUMNS[1:] if name not in table.names]:
        raise InputError(
            f"{where}: no column {', '.join(missing)}; a protocol has {', '.join(COLUMNS)} "
            "(the effort from 0 to 1), as `surae protocol` writes them"
        )
    loaded = table.load(COLUMNS[1:])
    time = loaded["angle_rad"].time
    angle = loaded["angle_rad"].values
    columns = {name: column.values for name, column in loaded.items()}
    if len(time) < 16 or not all(np.isfinite(each).all() for each in (time, *columns.values())):
        raise InputError(f"{where}: needs 16 samples or more, all of them numbers")
    step = float(time[-1] - time[0]) / (len(time) - 1)
    if not step > 0.0 or np.abs(np.diff(time) - step).max() > 0.01 * step:
        raise InputError(f"{where}: time_s must rise in equal steps; sample it uniformly")
    effort = np.column_stack([columns[name] for name in COLUMNS[2:]])
    if effort.min() < 0.0 or effort.max() > 1.0:
        raise InputError(f"{where}: the effort must lie from 0 to 1; it is a part of the largest")
    if np.abs(angle).max() > 3.0:
        raise InputError(f"{where}: angle_rad goes beyond ±3 rad; is it in degrees?")
    rate_hz = 1.0 / step
    velocity, acceleration = derivatives(angle, rate_hz, where=where)
    task = "as in the file" if effort.any() else "passive"
    span = float(angle.min()), float(angle.max())
    made_for = [line.rpartition(_LEGS)[2].strip() for line in source.head() if _LEGS in line]
    legs = made_for[0] if made_for and made_for[0] in FITTED else Protocol.legs
    given = Given(profile=shown(path), task=task, angle_range=span, rate_hz=rate_hz, legs=legs)
    return Trajectory(given, time - time[0], angle, velocity, acceleration, effort)
