"""A recording described anew after its import: other columns, units, signs, zeros.

What was imported stays as it was. Each description makes a version of the recording beside it, so
that undo has only to point at the one before, and a fit says which one it was made of.
"""

import math
import re
from collections.abc import Mapping, Sequence
from dataclasses import replace
from typing import Any

import numpy as np

from surae import api
from surae.base.errors import InputError
from surae.base.frozen import read_only
from surae.base.units import FACTORS, SI, FloatArray, kind
from surae.base.words import N_
from surae_workbench.web.imports import CLOCK, described, preview, read_recording
from surae_workbench.web.rows import Entry

#: What of a recording's row belongs to its description.
FIELDS = (
    "version",
    "version_sha256",
    "mapping",
    "emg",
    "fixed",
    "channels",
    "duration_s",
    "findings",
)
_UNIT = re.compile(r"\[([^\]]+)\]")
_ADVISED = re.compile(r'unit = "([^"]+)"')
_SCALED = re.compile(r"scale = ([\d.e+-]+) for")
_FILE = "for another column drop its file on the page Add trials again"


_TURN = {
    "both": N_("Turn both"),
    "angle": N_("Turn the angle"),
    "torque": N_("Turn the torque"),
}


def first_mapping(row: Entry) -> dict[str, Any]:
    """The description with which a recording was imported; one of its own where there was none."""
    first = row.get("first") or row["mapping"]
    if first is None:
        first = {
            "name": row["name"],
            "emg": row["emg"],
            "side": row["side"],
            "channels": {},
            "fixed": row["fixed"],
            "prepare": {},
        }
    channels_now = {channel["role"]: channel for channel in row["channels"]}
    plain = {"upload": row["id"], "sign": 1, "scale": 1.0, "offset": 0.0}
    channels = first["channels"] or {
        role: {**plain, "column": role, "unit": channel["unit"]}
        for role, channel in channels_now.items()
    }
    units = {
        role: channel["unit"] or _said_unit(channels_now[role]["source"], role)
        for role, channel in channels.items()
    }
    return {
        **first,
        "channels": {role: {**channels[role], "unit": units[role]} for role in channels},
    }


def present_mapping(row: Entry) -> dict[str, Any]:
    """The description that a recording has now."""
    return dict(row["mapping"]) if row.get("version") else first_mapping(row)


def _said_unit(source: str, role: str) -> str:
    """The unit that a channel's file gave by itself."""
    match = _UNIT.search(source)
    return match[1] if match and match[1] in FACTORS[kind(role)] else SI[kind(role)]


def described_anew(
    recording: api.Recording, first: Mapping[str, Any], wanted: Mapping[str, Any]
) -> api.Recording:
    """The recording as imported, with another description of the same columns.

    `first` is the description that it was imported with, `wanted` the one that it shall have.
    """
    roles = {(each["upload"], each["column"]): role for role, each in first["channels"].items()}
    channels = {}
    for role, new in wanted["channels"].items():
        source = roles.get((new["upload"], new["column"]))
        if source is None:
            raise InputError(f"{role}: {new['column']!r} was not imported: {_FILE}")
        old = first["channels"][source]
        measured = recording.channels[source]
        unit = new["unit"] or SI[kind(role)]
        if new["scale"] == 0:
            raise InputError(f"{role}: scale is 0, which would erase the signal")
        raw = (measured.values / (_factor(source, old["unit"]) * old["sign"]) - old["offset"]) / (
            old["scale"]
        )
        values: FloatArray = (
            new["sign"] * (new["scale"] * raw + new["offset"]) * _factor(role, unit)
        )
        times = _times(measured.time, new)
        known = "1" if unit == "1" else SI[kind(role)]
        origin = f"{measured.source.partition(' (')[0]} ({_told(new, unit)})"
        channels[role] = api.Channel(role, times, read_only(values), known, origin)
    return replace(
        recording,
        channels=channels,
        emg=wanted["emg"] or recording.emg,
        fixed=dict(wanted["fixed"]),
        prepare=dict(wanted["prepare"]),
    )


def _times(times: FloatArray, channel: Mapping[str, Any]) -> FloatArray:
    """The times of a channel's samples: as imported, but for what is said of a film's clock."""
    start = channel.get("start_s")
    rate = channel.get("rate_hz")
    since = times - times[0] if rate is None else np.arange(len(times)) / rate
    moved = start is not None or rate is not None
    return read_only((times[0] if start is None else start) + since) if moved else times


def _factor(role: str, unit: str) -> float:
    factors = FACTORS[kind(role)]
    if unit not in factors:
        raise InputError(f"{role}: {unit!r} is no unit of it; use {', '.join(factors)}")
    return factors[unit]


def _told(channel: Mapping[str, Any], unit: str) -> str:
    return (
        f"described as {unit}, sign {channel['sign']:+d}, scale {channel['scale']:g}, offset "
        + (f"{channel['offset']:g}")
    )


def redescribed(
    path: str, first: Mapping[str, Any], wanted: Mapping[str, Any], output: str | None
) -> dict[str, Any]:
    """Describe an imported recording anew, and keep it where `output` says so."""
    recording = described_anew(read_recording(path), first, wanted)
    if output is not None:
        api.write_hdf5(output, recording)
    return described(recording)


def imported_columns(path: str, first: Mapping[str, Any]) -> list[dict[str, Any]]:
    """The columns that a recording was imported from, in their files' own numbers."""
    recording = read_recording(path)
    columns = []
    for role, channel in first["channels"].items():
        plain = {**channel, "sign": 1, "scale": 1.0, "offset": 0.0}
        raw = described_anew(recording, first, {**first, "channels": {role: plain}})
        values = raw.channels[role].values / _factor(role, channel["unit"])
        columns.append(
            {
                "upload": channel["upload"],
                "name": channel["column"],
                "unit": channel["unit"],
                "low": float(values.min()),
                "high": float(values.max()),
                "preview": preview(recording.channels[role].time, values),
            }
        )
    return columns


def like(wanted: Mapping[str, Any], described: Mapping[str, Any], name: str) -> dict[str, Any]:
    """The description of another recording of the session, changed in the same way."""
    columns = {channel["column"]: channel for channel in described["channels"].values()}
    channels = {}
    for role, channel in wanted["channels"].items():
        if channel["column"] not in columns:
            raise InputError(f"{name} has no column {channel['column']!r}; leave it out")
        same = columns[channel["column"]]  # each film begins at a time of its own
        channels[role] = channel | {key: same.get(key) for key in ("upload", *CLOCK)}
    return {
        **described,
        "channels": channels,
        "emg": wanted["emg"],
        "fixed": wanted["fixed"],
        "prepare": wanted["prepare"],
    }


def proposals(
    findings: Sequence[Mapping[str, Any]], channels: Mapping[str, Mapping[str, Any]]
) -> list[dict[str, Any]]:
    """Findings, with what mends each in one click where the check is certain.

    `channels` are those of the description; a finding then has ``mend``: a label, and what changes
    of the channels.
    """
    return [{**finding, "mend": _mend(finding, channels)} for finding in findings]


def _mend(
    finding: Mapping[str, Any], channels: Mapping[str, Mapping[str, Any]]
) -> dict[str, Any] | None:
    role = finding["channel"]
    code = finding["code"]
    if role is None and code == "emg-unit":
        roles = [role for role in channels if role.startswith("emg_")]
    else:
        roles = [role] if role in channels else []
    if not roles:
        return None
    said, advised = (finding.get(part, {}).get("message") for part in ("said", "advised"))
    lines = _lines(finding)
    if advised in ("advice/angle-sign", "advice/torque-sign") or lines.startswith("sign = -1"):
        both = all(f"sign = -1 for the {each}" in lines for each in ("angle", "torque"))
        if both and code == "torque-sign":
            return None  # the finding on the angle turns both
        turned = ["angle", "torque"] if both else [role]
        return {
            "label": _TURN["both" if both else str(role)],
            "channels": {each: {"sign": -channels[each]["sign"]} for each in turned},
        }
    if said == "found/torque-offset/fitted":
        channel = channels[role]
        shift = finding["value"] / (_factor(role, channel["unit"]) * channel["sign"])
        return {
            "label": N_("Take {torque} Nm away"),
            "given": {"torque": f"{finding['value']:.3g}".replace("-", "−")},
            "channels": {role: {"offset": channel["offset"] - shift}},
        }
    if code in ("angle-units", "torque-unit", "emg-unit"):
        return _rescaled(finding, roles, channels)
    return None


def _rescaled(
    finding: Mapping[str, Any], roles: Sequence[str], channels: Mapping[str, Mapping[str, Any]]
) -> dict[str, Any] | None:
    """Another unit where one is what a finding is certain of, else another scale."""
    if unit := _unit(finding, channels[roles[0]], FACTORS[kind(roles[0])]):
        return {
            "label": N_("It is {unit}"),
            "given": {"unit": unit.replace("uV", "µV")},
            "channels": {each: {"unit": unit} for each in roles},
        }
    if (scaled := _SCALED.search(_lines(finding))) is None:
        return None
    factor = float(scaled[1])
    return {
        "label": N_("Scale by {factor}"),
        "given": {"factor": f"{factor:.6g}"},
        "channels": {each: {"scale": channels[each]["scale"] * factor} for each in roles},
    }


def _lines(finding: Mapping[str, Any]) -> str:
    """The lines of a mapping that a finding is certain of; empty where there are none."""
    advised = finding.get("advised", {})
    certain = advised.get("message") == "advice/write"
    return str(advised["given"]["lines"]) if certain else ""


def _unit(
    finding: Mapping[str, Any], channel: Mapping[str, Any], factors: Mapping[str, float]
) -> str | None:
    """The unit that a finding is certain of: it names it, or the scale that is between the two."""
    if advised := _ADVISED.search(finding["advice"]):
        unit = advised[1].replace("µ", "u")
        return unit if unit in factors else None
    scaled = _SCALED.search(_lines(finding))
    if scaled is None or channel["unit"] not in factors:
        return None
    right = float(scaled[1]) * factors[channel["unit"]]
    return next(
        (u for u, factor in factors.items() if math.isclose(factor, right, rel_tol=1e-5)), None
    )
