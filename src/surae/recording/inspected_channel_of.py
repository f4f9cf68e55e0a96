"""One channel of a data file, as an inspection shows it: unit, rate, role, and what is amiss."""

from dataclasses import replace

import numpy as np

from surae.base.errors import InputError
from surae.base.units import FloatArray
from surae.recording.channels import gaps_of, stated_unit, written_unit
from surae.recording.described import LONGEST_BRIDGE_S
from surae.recording.emg_kind import look_of
from surae.recording.inspected_advice import COUNTS
from surae.recording.inspected_channels import InspectedChannel
from surae.recording.recording import FILM_ROLES
from surae.recording.roles import Guess, guess_role
from surae.recording.table import Column, Sampling, Table, sampling_of
from surae.recording.times import counts

#: A dead input takes so many of its converter's steps at most; so many samples show them.
_DEAD = 3.0
_LOOKED_AT = 5000
_FEW = 100


def _guess_of(table: Table, name: str, unit: str | None) -> Guess | None:
    """The role of a column by its name, or by what its file says of it beside."""
    guess = guess_role(name, unit)
    vague = guess is None or guess.role is None or guess.confidence == "possible"
    if vague and (described := table.descriptions.get(name)):
        by_it = guess_role(described, unit)
        if by_it is not None and (guess is None or by_it.role is not None):
            return replace(by_it, rule=f"{by_it.rule}, in its description {described!r}")
    return guess


def described_channel(
    path: str, table: Table, name: str, column: Column | InputError
) -> InspectedChannel:
    """One channel of a file, with its samples where they can be read."""
    count = table.names.count(name)
    usable = count == 1
    unit = written_unit(table, name)
    remarks = [
        table.remarks.get(name, "") if usable else f"{count} columns have this name: rename one"
    ]
    guess = _guess_of(table, name, unit)
    if isinstance(column, InputError):
        reason = str(column).removeprefix(f"{table.file}: ").removeprefix(f"column {name!r}: ")
        remark = "; ".join(filter(None, (reason, *remarks)))
        return InspectedChannel(path, name, unit, guess=guess, remark=remark, usable=False)
    role = guess.roles[0] if guess else None
    finite = column.values[np.isfinite(column.values)]
    bridge_s = 0.0
    if wrong := len(column.values) - len(finite):
        first = int(np.argmin(np.isfinite(column.values)))
        why = column.reason(first) if column.reason else ""
        why = why or f"{column.values[first]} is not a finite number"
        if role in FILM_ROLES:  # whose tracker may have lost frames
            remarks.insert(0, f"{wrong} samples are no finite numbers")
        else:
            usable = False
            gaps = gaps_of(column.time, column.values)
            what = f"{wrong} of {len(column.values)} samples" if gaps is None else gaps.text
            remarks.insert(0, f"{column.position(first)}: {why} ({what})")
            wordless = "write" not in why  # else it is a number, written otherwise
            if gaps and gaps.longest_s <= LONGEST_BRIDGE_S and column.time_name and wordless:
                bridge_s = gaps.bridge_s
    remarks.append(column.remark)
    if guess is None and column.time_name and counts(column.values):
        remarks.insert(0, f"it {COUNTS}")
    sampling = Sampling(len(column.time))
    if column.time_name:
        sampling = sampling_of(column.time)
    else:
        frames = table.offered
        by_frames = f": column {frames.column!r} {COUNTS}" if frames else ""
        remarks.insert(0, f"no times{by_frames}: give start_s and rate_hz")
    if role is not None:  # a file may state one unit for all signals of a kind
        unit = written_unit(table, name, role)
    emg = role is not None and role.startswith("emg_")
    known = None if role is None else stated_unit(table, role, name)
    settled = known is not None and not known.per_kg
    known_unit, scale = (known.unit, known.scale) if known is not None and settled else (None, 1.0)
    look = look_of(column.time, column.values) if emg else None
    if look is not None and not column.time_name:  # how fast it changes is not known
        look = replace(look, rule="positive and negative") if look.kind == "raw" else None
    alive = role in ("angle", "torque") or len(finite) < _FEW or _is_alive(finite)
    if not alive:
        remarks.insert(0, "it never changes by more than its own steps: not connected?")
    end_s = None if sampling.start_s is None else float(column.time[-1])
    low, high = (float(finite.min()), float(finite.max())) if len(finite) else (None, None)
    return InspectedChannel(
        path,
        name,
        unit,
        known_unit,
        scale,
        sampling.n,
        sampling.rate_hz,
        sampling.start_s,
        end_s,
        low,
        high,
        guess,
        look,
        "; ".join(filter(None, remarks)),
        usable and sampling.n > 1,
        bridge_s,
        alive,
    )


def _is_alive(values: FloatArray) -> bool:
    """Whether a signal is more than the steps of a converter to which nothing is connected."""
    low = float(values.min())
    high = float(values.max())
    levels = np.unique(values[:: max(len(values) // _LOOKED_AT, 1)])
    return low < high and (len(levels) < 2 or high - low > _DEAD * float(np.diff(levels).min()))
