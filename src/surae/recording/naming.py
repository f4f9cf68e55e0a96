"""Our column names, ``torque_Nm``: which role and unit they state."""

from collections.abc import Mapping

from surae.errors import InputError
from surae.recording.recording import ROLES
from surae.units import FACTORS, kind, plain, to_si

#: Column names of the time, and their factor to seconds.
TIMES: Mapping[str, float] = {f"time_{unit}": factor for unit, factor in FACTORS["time"].items()}


def _suffixes(role: str) -> dict[str, str]:
    """Units of a role by how they are written at the end of a column's name."""
    return {unit.replace("/", "_"): unit for unit in FACTORS[kind(role)]}


#: Role and unit of every column name that is ours.
NAMES: Mapping[str, tuple[str, str]] = {
    f"{role}_{suffix}": (role, unit) for role in ROLES for suffix, unit in _suffixes(role).items()
}


def role_and_unit(name: str, where: str) -> tuple[str, str] | None:
    """Role and unit that a column's name states, or None for a column that isn't ours.

    A name such as ``torque_passive_Nm`` or ``angle_rad_target``, with something else beside the
    unit, is another quantity's.

    A name that begins as one of ours and has no unit, or one that is not known, is refused.
    """
    name = plain(name)
    if name in NAMES:
        return NAMES[name]
    for role in ROLES:
        if name.casefold() != role and not name.casefold().startswith(f"{role}_"):
            continue
        suffixes = _suffixes(role)
        ours = [f"{role}_{suffix}" for suffix in suffixes]
        suffix = name[len(role) + 1 :]
        if not suffix:
            raise InputError(f"{where}: the unit is missing; write one of: {', '.join(ours)}")
        if suffix in suffixes:
            raise InputError(f"{where}: write it in small letters, {role}_{suffix}")
        if any(suffix.endswith(f"_{known}") for known in suffixes) or any(
            suffix.startswith(f"{known}_") for known in suffixes
        ):
            return None
        to_si(role, suffix, where)
    return None
