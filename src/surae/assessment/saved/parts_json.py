"""Parts of a FIT.json: what the fit saw of recordings, outliers, and the family it chose from."""

import math
from collections.abc import Mapping, Sequence
from typing import Any

import numpy as np

from surae.assessment.saved.json_file import decode, encode, real
from surae.estimation import LOSSES, Candidate, Family, Outliers
from surae.estimation.noise import NoiseModel
from surae.estimation.result import OfRecording
from surae.frozen import FrozenDict
from surae.model.laboratory import Belief
from surae.model.sources import SOURCES
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


def outliers_as_dict(outliers: Outliers | None) -> dict[str, Any] | None:
    """Plain data; None for least squares."""
    if outliers is None:
        return None
    return {
        "loss": outliers.loss,
        "tuning": outliers.tuning,
        "scale_Nm": outliers.scale,
        "share_below_half": outliers.share,
        "widening": outliers.widening,
        "rounds": outliers.rounds,
        "weights": [encode(weight) for weight in outliers.weights],
    }


def read_outliers(data: dict[str, Any] | None, samples: Sequence[int]) -> Outliers | None:
    """What `outliers_as_dict` made, for recordings of so many samples."""
    if data is None:
        return None
    weights = tuple(decode(w, (n,)) for w, n in zip(data["weights"], samples, strict=True))
    numbers = [float(data[name]) for name in ("tuning", "scale_Nm", "widening")]
    if data["loss"] not in LOSSES or not all(math.isfinite(x) and x > 0 for x in numbers):
        raise ValueError("outliers: an unknown loss, or a number that is none")
    if not all(weight.min() > 0 and weight.max() <= 1 for weight in weights):
        raise ValueError("outliers: a weight is not between 0 and 1")
    tuning, scale, widening = numbers
    return Outliers(str(data["loss"]), tuning, scale, weights, widening, int(data["rounds"]))


#: Ways in which one source may shift the estimates, at most.
_MOST = 1000


def family_as_dict(family: Family | None) -> dict[str, Any] | None:
    """A family as plain data."""
    if family is None:
        return None
    return {
        "candidates": [
            {
                "model": candidate.model,
                "nuisances": list(candidate.groups),
                "evidence": candidate.evidence,
                "weight": candidate.weight,
                "values": dict(candidate.values),
            }
            for candidate in family.candidates
        ],
        "priors": {
            name: {"mean": belief.mean, "sd": belief.sd, "off": belief.off}
            for name, belief in family.beliefs.items()
        },
        "noise": [
            {
                "coefficients": noise.coefficients.tolist(),
                "variance": noise.variance,
                "autocovariance": noise.autocovariance.tolist(),
                "samples": noise.samples,
            }
            for noise in family.noise
        ],
        "zeros": list(family.zeros),
        "covariance": encode(family.covariance),
        "spread": {source: encode(by) for source, by in family.spread.items()},
        "recordings": [
            {"values": dict(each.values), "sem": dict(each.sem)} for each in family.recordings
        ],
    }


def read_family(data: Any, free: Sequence[str]) -> Family | None:
    """The family that `family_as_dict` made plain, of these free parameters."""
    if data is None:
        return None
    return Family(
        candidates=tuple(
            Candidate(
                str(candidate["model"]),
                tuple(str(group) for group in candidate["nuisances"]),
                real(candidate["evidence"]),
                real(candidate["weight"]),
                _numbers(candidate["values"]),
            )
            for candidate in data["candidates"]
        ),
        beliefs=FrozenDict(
            (str(name), Belief(real(belief["mean"]), real(belief["sd"]), real(belief["off"])))
            for name, belief in data["priors"].items()
        ),
        noise=tuple(
            NoiseModel(
                np.array([real(c) for c in noise["coefficients"]]),
                real(noise["variance"]),
                np.array([real(c) for c in noise["autocovariance"]]),
                real(noise["samples"]),
            )
            for noise in data["noise"]
        ),
        zeros=tuple(real(zero) for zero in data["zeros"]),
        covariance=decode(data["covariance"], (len(free), len(free))),
        spread=FrozenDict(
            (SOURCES[source].name, _shifts(by, free)) for source, by in data["spread"].items()
        ),
        recordings=tuple(
            OfRecording(_numbers(each["values"]), _numbers(each["sem"]))
            for each in data.get("recordings", ())
        ),
    )


def _shifts(packed: dict[str, Any], free: Sequence[str]) -> FloatArray:
    if "shape" not in packed:  # formerly standard deviations by name, each for itself
        return np.diag([real(packed.get(name, 0.0)) for name in free])
    rows = packed["shape"][0]
    if not isinstance(rows, int) or not 0 <= rows <= _MOST:
        raise ValueError(f"{rows} shifts, expected {_MOST} at most")
    return decode(packed, (rows, len(free)))


def _numbers(data: Mapping[str, Any]) -> FrozenDict[str, float]:
    return FrozenDict((str(name), real(value)) for name, value in data.items())
