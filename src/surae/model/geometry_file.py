"""A geometry from a file: our CSV, or the tables that OpenSim's MuscleAnalysis writes."""

import re
from collections.abc import Mapping
from pathlib import Path
from typing import TYPE_CHECKING

import numpy as np
import numpy.typing as npt

from surae.base.errors import InputError
from surae.base.files import PathLike
from surae.base.units import FACTORS, FloatArray
from surae.model.geometry_table import TOLERANCE, GeometryTable
from surae.recording import delimited, opensim
from surae.recording.source import Source, open_source
from surae.recording.table import some

#: Muscles of each group, and the part of each in its cross-section: of 51.8, 21.1 and 9.7 cm²
#: (Ward et al. 2009, Clinical Orthopaedics and Related Research 467:1074-1082).
_SHARES = ({"sol": 51.8 / 82.6, "gm": 21.1 / 82.6, "gl": 9.7 / 82.6}, {"ta": 1.0})
_GROUPS = ("tri", "tib")
#: What OpenSim's models call them.
_OPENSIM = {
    "sol": r"sol(eus)?",
    "gm": r"gas_?med|med_?gas|gasmed|gastroc_?m\w*|gm",
    "gl": r"gas_?lat|lat_?gas|gaslat|gastroc_?l\w*|gl",
    "ta": r"tib_?ant|tibialis_?anterior|ta",
}
#: The two that a model of one gastrocnemius has in one, and what it is called there.
_HEADS = ("gm", "gl")
_WHOLE = r"(?:gas|gastroc|gastrocnemius)"
_COLUMN = re.compile(r"(length|arm)_(tri|tib|ta|gl|gm|sol)_(mm|cm|m)")
_NOTE = re.compile(
    r"#?\s*(?:(tolerance|slack_tri|slack_tib)_(mm|cm|m)|(second_angle)_(deg|rad))"
    r"\s*=\s*([-+.\deE]+)\s*"
)
_SOURCE = re.compile(r"#\s*source\s*[:=]\s*(.*?)\s*")
_ANALYSIS = re.compile(r"(.*)_MuscleAnalysis_(?:Length|MomentArm_\w+)\.sto", re.IGNORECASE)

#: A knee that turns by less is still [rad]; digits to which angles of a grid are the same.
_STILL = 1e-3
_DIGITS = 6

#: Moment arms that muscles of a limb have [m]; parts of its arm by which a muscle's length changes,
#: which pennation and tendons leave; lengths of muscle and tendon beyond the tendon's own [m].
_ARMS = (0.006, 0.15)
_GEARS = (0.2, 1.3)
_LEAST = 0.0
_MOST = 0.5

if TYPE_CHECKING:
    from scipy.interpolate import CubicSpline

Columns = Mapping[tuple[str, str], FloatArray]


def read_geometry(path: PathLike) -> GeometryTable:
    """Lengths and moment arms over the angle, from a file.

    A CSV has the columns ``angle_deg`` (or ``_rad``) and ``length_tri_mm``, ``arm_tri_mm``,
    ``length_tib_mm``, ``arm_tib_mm`` (or ``_m``), or those of single muscles (``sol``, ``gm``,
    ``gl``, ``ta``). One of length and arm is enough: the other is its integral or slope. Of
    OpenSim's MuscleAnalysis give the ``…_Length.sto``; its moment arms and the angles of the
    Kinematics analysis are found beside it.
    """
    if _ANALYSIS.fullmatch(Path(path).name):
        return _of_opensim(Path(path))
    return geometry_of(open_source(path))


def geometry_of_text(name: str, text: str) -> GeometryTable:
    """The geometry in the text of a CSV, called by its file's name; see `read_geometry`."""
    return geometry_of(Source(name, text.encode(), ""))


def geometry_of(source: Source) -> GeometryTable:
    """The geometry in a CSV; see `read_geometry`."""
    table = delimited.open_table(source)
    where = source.shown
    name = Path(source.path).name
    angles, seconds = (
        [n for n in table.names if n in (f"{of}_rad", f"{of}_deg")]
        for of in ("angle", "second_angle")
    )
    known = [n for n in table.names if _COLUMN.fullmatch(n)]
    if len(angles) != 1 or len(seconds) > 1 or not known:
        raise InputError(
            f"{where}: a geometry needs angle_deg (or angle_rad) and columns like length_tri_mm "
            f"and arm_tri_mm; columns found: {some(table.names)}"
        )
    loaded = table.load([*angles, *seconds, *known])
    columns: dict[tuple[str, str], FloatArray] = {}
    for each in known:
        what, muscle, unit = each.split("_")
        columns[what, muscle] = loaded[each].values * FACTORS["length"][unit]
    angle, *second = (
        loaded[each].values * FACTORS["angle"][each.rpartition("_")[2]]
        for each in (*angles, *seconds)
    )
    stated = (_SOURCE.fullmatch(line.strip()) for line in source.lines())
    where_from = next((match[1] for match in stated if match), "")
    return _table(name, source, angle, second[0] if second else None, columns, where_from)


def _notes(source: Source) -> dict[str, float]:
    """What a file's lines state beside its columns, in SI units."""
    notes = dict[str, float]()
    for line in source.lines():
        if match := _NOTE.fullmatch(line.strip()):
            kind, unit = ("length", match[2]) if match[1] else ("angle", match[4])
            try:
                notes[match[1] or match[3]] = float(match[5]) * FACTORS[kind][unit]
            except ValueError:
                raise InputError(f"{source.shown}: {match[5]!r} is not a number") from None
    return notes


def _table(
    name: str,
    source: Source,
    angle: FloatArray,
    second: FloatArray | None,
    columns: Columns,
    stated: str,
) -> GeometryTable:
    """Both groups, from columns of groups or of their muscles."""
    where = source.shown
    notes = _notes(source)
    angle, seconds, order = _grid(angle, second, where)
    lengths = []
    arms = []
    for group, shares, sign in zip(_GROUPS, _SHARES, (1.0, -1.0), strict=True):
        length, arm = (
            None if pair is None else pair[order]
            for pair in (_group(what, group, shares, columns, where) for what in ("length", "arm"))
        )
        if length is None and (arm is None or len(seconds)):
            without = "" if arm is None else ", which a table over a second angle needs"
            raise InputError(
                f"{where}: no length{' and no arm' * (arm is None)} of {group} (or of "
                f"{', '.join(shares)}){without}"
            )
        if arm is not None:
            arm = arm * sign * np.sign(arm.sum())  # an arm that turns round is kept so
            _check_arm(arm, group, where)
            if length is not None:
                _check_slope(angle, length, arm, group, where)
        elif length is not None:
            arm = _spline(angle, length, where).derivative()(angle)
        if length is None:
            integral = _spline(angle, arm, where).antiderivative()
            length = integral(angle) - integral(0.0)
        length = length - notes.get(f"slack_{group}", 0.0)
        if f"slack_{group}" in notes and not _LEAST < length.min() <= length.max() < _MOST:
            raise InputError(
                f"{where}: less its slack length, {group} is {1e3 * length.min():.4g} to "
                f"{1e3 * length.max():.4g} mm long; give lengths of muscle and tendon, from origin "
                "to insertion"
            )
        lengths.append(tuple(length.ravel().tolist()))
        assert arm is not None
        arms.append(tuple(arm.ravel().tolist()))
    slack = {f"slack_{group}" for group in _GROUPS} <= notes.keys()
    table = GeometryTable(
        name,
        tuple(angle.tolist()),
        (lengths[0], lengths[1]),
        (arms[0], arms[1]),
        notes.get("tolerance", TOLERANCE),
        slack,
        stated,
        tuple(seconds.tolist()),
    )
    return table.at_second(notes["second_angle"]) if "second_angle" in notes else table


def _check_arm(arm: FloatArray, group: str, where: str) -> None:
    """Refuse an arm that no muscle of a limb has: it is in another unit than its column says."""
    size = float(np.median(np.abs(arm)))
    if not _ARMS[0] <= size <= _ARMS[1]:
        raise InputError(
            f"{where}: the moment arm of {group} is {1e3 * size:.3g} mm; give it in the unit that "
            "its column names"
        )


def _check_slope(
    angle: FloatArray, length: FloatArray, arm: FloatArray, group: str, where: str
) -> None:
    """Refuse lengths that change by another part of the arm than pennation and tendons leave."""
    slope = np.gradient(length, angle, axis=0)
    ratio = float(np.sum(slope * arm) / np.sum(arm * arm))
    if not _GEARS[0] <= ratio <= _GEARS[1]:
        raise InputError(
            f"{where}: the length of {group} changes by {ratio:.3g} times its moment arm, and a "
            f"muscle's by {_GEARS[0]:g} to {_GEARS[1]:g}; check units and signs of length, arm and "
            "angle"
        )


def _grid(
    angle: FloatArray, second: FloatArray | None, where: str
) -> tuple[FloatArray, FloatArray, npt.NDArray[np.intp]]:
    """Angles, second angles (none without), and the row of each pair, shape (n,) or (n, k)."""
    if second is None:
        order = np.argsort(angle, kind="stable")
        return angle[order], np.zeros(0), order
    angles = np.unique(angle)
    seconds = np.unique(second)
    n = len(angles)
    k = len(seconds)
    if not n * k == len(angle) == len({*zip(angle, second, strict=True)}):
        raise InputError(
            f"{where}: {len(angle)} rows of {n} angles and {k} second angles; give one row for "
            "each pair of them"
        )
    return angles, seconds, np.lexsort((second, angle)).reshape(n, k)


def _spline(angle: FloatArray, values: FloatArray | None, where: str) -> "CubicSpline":
    from scipy.interpolate import CubicSpline

    try:
        return CubicSpline(angle, values)
    except ValueError:
        raise InputError(f"{where}: angles must differ, and be numbers") from None


def _group(
    what: str, group: str, shares: Mapping[str, float], columns: Columns, where: str
) -> FloatArray | None:
    """A group's own column, or that of its muscles by their parts in its cross-section."""
    if (what, group) in columns:
        return columns[what, group]
    present = {muscle: columns[what, muscle] for muscle in shares if (what, muscle) in columns}
    if not present:
        return None
    if missing := [muscle for muscle in shares if muscle not in present]:
        raise InputError(
            f"{where}: {what} of {', '.join(present)}, but not of {', '.join(missing)}"
        )
    return np.asarray(np.sum([shares[m] * values for m, values in present.items()], axis=0))


def _of_opensim(path: Path) -> GeometryTable:
    """Lengths, moment arms and angles, from the three tables of one analysis."""
    match = _ANALYSIS.fullmatch(path.name)
    assert match is not None
    prefix = match[1]
    arms = sorted(path.parent.glob(f"{prefix}_MuscleAnalysis_MomentArm_*ankle*angle*.sto"))
    files = {
        "lengths": path.parent / f"{prefix}_MuscleAnalysis_Length.sto",
        "moment arms of the ankle": arms[0] if arms else None,
        "angles": path.parent / f"{prefix}_Kinematics_q.sto",
    }
    for what, file in files.items():
        if file is None or not file.exists():
            named = f" in {file.name}" if file is not None else ""
            raise InputError(
                f"{path}: no {what}{named} beside it; run MuscleAnalysis and Kinematics together"
            )
    length, arm, kinematics = (open_source(file) for file in files.values() if file is not None)
    coordinate = Path(arm.path).name.split("_MomentArm_")[1].removesuffix(".sto")
    table = opensim.open_table(kinematics)
    if coordinate not in table.names:
        raise InputError(f"{kinematics.shown}: no column {coordinate!r}; {some(table.names)}")
    side = coordinate[-2:] if coordinate[-2:] in ("_r", "_l") else ""
    knees = [n for n in (f"knee_angle{side}", f"knee_flexion{side}") if n in table.names]
    factor = FACTORS["angle"][table.units_of_kind.get("angle", "rad")]
    turned = table.load([coordinate, *knees])
    angle, *knee = (turned[n].values * factor for n in (coordinate, *knees))
    columns: dict[tuple[str, str], FloatArray] = {}
    for what, source in (("length", length), ("arm", arm)):
        headed = opensim.open_table(source)
        for muscle, pattern in _OPENSIM.items():
            called = re.compile(rf"(?:{pattern}){side}", re.IGNORECASE)
            match_of = [n for n in headed.names if called.fullmatch(n)]
            if not match_of and muscle in _HEADS:  # models of one gastrocnemius
                whole = re.compile(rf"{_WHOLE}{side}", re.IGNORECASE)
                match_of = [n for n in headed.names if whole.fullmatch(n)]
            if len(match_of) != 1:
                which = f"{len(match_of)} columns are" if match_of else "no column is"
                raise InputError(
                    f"{source.shown}: {which} the {muscle} muscle; columns: {some(headed.names)}"
                )
            columns[what, muscle] = headed.load(match_of)[match_of[0]].values
    if len(angle) != len(columns["length", "sol"]):
        raise InputError(f"{kinematics.shown}: not as many rows as {length.shown}")
    second = knee[0].round(_DIGITS) if knee and np.ptp(knee[0]) > _STILL else None
    angle = angle.round(9 if second is None else _DIGITS)
    pairs = angle[:, None] if second is None else np.stack([angle, second], 1)
    kept = np.unique(pairs, axis=0, return_index=True)[1]
    columns = {key: values[kept] for key, values in columns.items()}
    return _table(
        path.name,
        length,
        angle[kept],
        None if second is None else second[kept],
        columns,
        f"OpenSim, {prefix}",
    )
