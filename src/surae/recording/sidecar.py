"""What BIDS keeps beside EMG data: the time of the first sample, and whether it is an envelope."""

import json
import math
from dataclasses import dataclass
from pathlib import Path

from surae.errors import InputError
from surae.files import read_bytes, shown

_ENDS = ("_emg.bdf", "_emg.edf")


@dataclass(frozen=True, slots=True)
class Sidecar:
    """What is known beside the file: time of the first sample [s], and of which kind its EMG is."""

    start_s: float = 0.0
    envelope: bool = False


def read_sidecar(path: str) -> Sidecar:
    """What the JSON beside ``…_emg.bdf`` says; nothing where there is none.

    Without it, files of one recording that begin at different times would be laid one upon the
    other, and an envelope would be rectified once more.

    Raises
    ------
    InputError
        It cannot be read or is no JSON object.
    """
    beside = Path(path).with_suffix(".json")
    if not path.casefold().endswith(_ENDS) or not beside.is_file():
        return Sidecar()
    try:
        found = json.loads(read_bytes(beside))
    except (ValueError, RecursionError):
        found = None
    if not isinstance(found, dict):
        raise InputError(f"{shown(beside)}: no JSON object, which BIDS keeps beside its data")
    start, filters = found.get("StartTime"), found.get("SoftwareFilters")
    if not isinstance(start, int | float) or isinstance(start, bool) or not math.isfinite(start):
        start = 0.0
    return Sidecar(
        start_s=float(start),
        envelope=isinstance(filters, dict) and "envelope" in filters,
    )
