"""Recordings within a FIT.json: what the fit saw of them."""

from collections.abc import Mapping
from typing import Any

import numpy as np

from surae.assessment.saved.arrays import decode, encode
from surae.assessment.saved.json_file import real
from surae.recording import MUSCLES, SourceFile
from surae.signals import EmgReference, ModelInputs
from surae.units import FloatArray

_SERIES = ("time", "angle", "velocity", "acceleration")


def trace_as_dict(recording: ModelInputs, residual: FloatArray) -> dict[str, Any]:
    """What a fit saw of one recording, and what it left of the torque, as plain data."""
    torque = recording.torque if recording.torque is not None else np.zeros(0)
    return {
        "name": recording.name,
        "rate_hz": recording.rate_hz,
        "n": recording.n,
        "emg_unit": recording.emg_unit,
        "emg_reference": _reference_as_dict(recording.emg_reference),
        "missing_emg": list(recording.missing_emg),
        "prepared": recording.prepared,
        "steps": list(recording.steps),
        "fixed": dict(recording.fixed),
        "files": [{"path": file.name, "sha256": file.sha256} for file in recording.files],
        **{name: encode(getattr(recording, name)) for name in _SERIES},
        "emg": encode(recording.emg),
        "torque": encode(torque),
        "weight": None if recording.weight is None else encode(recording.weight),
        "emphasised": recording.emphasised,
        "lowpass": None if recording.lowpass is None else list(recording.lowpass),
        "measured": list(recording.measured),
        "residual": encode(residual),
    }


def _reference_as_dict(reference: EmgReference | None) -> dict[str, Any] | None:
    if reference is None:
        return None
    return {
        "kind": reference.kind,
        "values_V": dict(zip(MUSCLES, reference.values, strict=True)),
        "recordings": reference.count,
        "files": [{"path": file.name, "sha256": file.sha256} for file in reference.files],
    }


def _reference(data: Mapping[str, Any] | None) -> EmgReference | None:
    if data is None:
        return None
    kind = data["kind"]
    if kind not in ("session", "mvc"):
        raise ValueError(f"emg_reference is of {kind!r:.40}")
    values = [data["values_V"][muscle] for muscle in MUSCLES]
    if any(value is not None and not real(value) > 0 for value in values):
        raise ValueError("a reference of the EMG is not above zero")
    return EmgReference(
        kind=kind,
        values=tuple(None if value is None else real(value) for value in values),
        files=tuple(SourceFile(str(f["path"]), str(f["sha256"])) for f in data["files"]),
        count=int(data["recordings"]),
    )


def _lowpass(data: Any) -> tuple[float, int] | None:
    if data is None:
        return None
    cutoff, order = data
    return real(cutoff), int(order)


def read_trace(trace: Mapping[str, Any]) -> ModelInputs:
    """What `trace_as_dict` wrote of a recording."""
    n = int(trace["n"])
    return ModelInputs(
        name=str(trace["name"]),
        rate_hz=real(trace["rate_hz"]),
        emg=decode(trace["emg"], (n, 4)),
        emg_unit=str(trace["emg_unit"]),
        emg_reference=_reference(trace.get("emg_reference")),
        torque=decode(trace["torque"], (n,)),
        missing_emg=tuple(map(str, trace["missing_emg"])),
        steps=tuple(map(str, trace["steps"])),
        prepared=bool(trace["prepared"]),
        weight=None if trace["weight"] is None else decode(trace["weight"], (n,)),
        emphasised=bool(trace.get("emphasised", False)),
        lowpass=_lowpass(trace.get("lowpass")),
        measured=tuple(map(str, trace.get("measured", ()))),
        fixed={str(name): real(value) for name, value in trace["fixed"].items()},
        files=tuple(SourceFile(str(f["path"]), str(f["sha256"])) for f in trace["files"]),
        **{name: decode(trace[name], (n,)) for name in _SERIES},
    )
