"""The signals of one recording beside what the model makes of them, muscles and tendons too."""

import base64
import hashlib
import json
from collections.abc import Sequence
from dataclasses import dataclass
from functools import cache
from importlib.resources import files
from typing import Any

import numpy as np
import numpy.typing as npt

from surae.base.frozen import read_only
from surae.base.units import FloatArray
from surae.inference import FitResult
from surae.inference.judging.fascicles import Fascicles, followed
from surae.model import TendonState
from surae.model.joint import ANKLE, Joint
from surae.model.simulator import TorqueParts
from surae.recording import MUSCLES
from surae.report.provenance import excluded_spans

#: What figures call parts of the torque that the model calls otherwise: what a muscle adds is no
#: nerve's, whatever made it contract; a reflex has a line of its own.
PARTS = {"neural": "muscle"}

__all__ = ["Traces", "extremes", "min_max", "traces_of"]


@dataclass(frozen=True, slots=True)
class Traces:
    """What the figures of one recording show, each of shape (n,) unless stated."""

    name: str  #: The recording's.
    rate_hz: float  #: Samples a second.
    time: FloatArray  #: Time [s].
    emg: FloatArray  #: EMG envelopes in the order TA, GL, SOL, GM, shape (n, 4).
    emg_unit: str  #: "V", "1": Volts, or a normalised envelope.
    missing_emg: Sequence[str]  #: Muscles without EMG.
    angle: FloatArray  #: Ankle angle [rad].
    #: `measured`, `modelled`: torque [Nm].
    measured: FloatArray
    modelled: FloatArray
    parts: TorqueParts  #: Parts of the modelled torque [Nm].
    tendon: TendonState | None  #: What muscles and tendons do; None where tendons are rigid.
    #: Optimal lengths of triceps surae and tibialis anterior [m]; NaN where the model has none.
    optimal: tuple[float, float]
    weight: FloatArray | None  #: What each sample counts in the fit.
    films: tuple[Fascicles, ...] = ()  #: Filmed fascicles, beside the model's.
    joint: Joint = ANKLE  #: The joint, whose words its figures have.

    @property
    def counted(self) -> npt.NDArray[np.bool_]:
        """Which samples count in the fit."""
        return np.ones(len(self.time), dtype=bool) if self.weight is None else self.weight > 0

    @property
    def excluded(self) -> tuple[tuple[int, int], ...]:
        """First and last sample of every stretch that the fit left out."""
        return excluded_spans(self.weight)

    @property
    def residual(self) -> FloatArray:
        """Measured minus modelled torque [Nm]."""
        return self.measured - self.modelled


def traces_of(result: FitResult) -> tuple[Traces, ...]:
    """The traces of every recording of a fit."""
    problem = result.problem
    vector = np.array([result.values[name] for name in problem.spec.names])
    tied = [
        (recording, problem.spec.simulator(recording, problem.options))
        for recording in problem.inputs
    ]
    return tuple(
        Traces(
            recording.name,
            recording.rate_hz,
            recording.time,
            recording.emg,
            recording.emg_unit,
            recording.missing_emg,
            recording.angle,
            recording.torque,
            modelled=read_only(recording.torque - residual),
            parts=simulator.parts(vector),
            tendon=simulator.tendon(vector),
            optimal=(result.values.get("l0_tri", np.nan), result.values.get("l0_tib", np.nan)),
            weight=recording.weight,
            films=followed(problem.spec, problem.options, result.values, recording),
            joint=problem.options.anatomy,
        )
        for (recording, simulator), residual in zip(tied, result.residuals, strict=True)
        if recording.torque is not None
    )


IndexArray = npt.NDArray[np.intp]

#: Points of a curve from which more cannot be told apart on paper or screen.
POINTS = 4000


def min_max(
    time: FloatArray, values: FloatArray, points: int = POINTS
) -> tuple[FloatArray, FloatArray]:
    """The least and greatest sample of each of `points`/2 equal stretches; a short signal whole."""
    index = extremes([values], points)
    return time[index], values[index]


def extremes(signals: Sequence[FloatArray], points: int = POINTS) -> IndexArray:
    """Which samples to show of signals with common instants, so that none loses a peak.

    Where any signal is least or greatest within each of equal stretches, and both ends: at most
    `points` + 2.
    """
    n = len(signals[0])
    if n <= points:
        return np.arange(n)
    size = -(-n // max(points // (2 * len(signals)), 1))
    begins = np.arange(0, n, size)
    shown = [np.array([0, n - 1])]
    for values in signals:
        rows = np.pad(values, (0, -n % size), mode="edge").reshape(-1, size)
        shown += [begins + rows.argmin(axis=1), begins + rows.argmax(axis=1)]
    return np.unique(np.concatenate(shown))


#: Samples of all recordings that a page holds at most, and of each at least.
_POINTS = 12_000
_FEWEST = 1500
#: Steps between the least and the largest value of a line; the next number says: none.
_STEPS = 65534


def signals_of(recordings: Sequence[Traces]) -> str:
    """JSON of every recording's signals, with no sign that ends an element; empty without any."""
    if not recordings:
        return ""
    points = max(_POINTS // len(recordings), _FEWEST)
    data = json.dumps([_recording(traces, points) for traces in recordings], separators=(",", ":"))
    return data.replace("<", "\\u003c")


@cache
def plots() -> dict[str, Any]:
    """Scripts and style sheet of the plots; the page runs no others."""
    package = files("surae.report") / "static"
    library = package / "vendor" / "uplot"
    ours = package / "explore.js"
    scripts = [
        path.read_text(encoding="utf-8").strip() for path in (library / "uPlot.iife.min.js", ours)
    ]
    style = (library / "uPlot.min.css").read_text(encoding="utf-8").strip()
    hashes = (_base64(hashlib.sha256(script.encode()).digest()) for script in scripts)
    policy = " ".join(f"'sha256-{each}'" for each in hashes)
    return {"scripts": scripts, "style": style, "policy": policy}


def _recording(traces: Traces, points: int) -> dict[str, Any]:
    names = ("tissue", "neural", "inertial", "gravitational", "reflex", "zero")
    every = [(n, getattr(traces.parts, n)) for n in names]
    parts = [(PARTS.get(n, n), values) for n, values in every if values is not None]
    volts = traces.emg_unit == "V"
    muscles = [muscle for muscle in MUSCLES if muscle not in traces.missing_emg]
    panels: list[tuple[str, str, list[tuple[str, FloatArray]]]] = [
        ("Torque", "Nm", [("measured", traces.measured), ("modelled", traces.modelled)]),
        ("Residual", "Nm", [("measured minus modelled", traces.residual)]),
        ("Parts of the modelled torque", "Nm", parts),
        (traces.joint.worded("Ankle angle"), "°", [("angle", np.degrees(traces.angle))]),
    ]
    if muscles:
        emg = traces.emg * (1e3 if volts else 1.0)
        lines = [(name.upper(), emg[:, MUSCLES.index(name)]) for name in muscles]
        panels.append(("EMG", "mV" if volts else "-", lines))
    finite = [
        np.nan_to_num(values, posinf=0.0, neginf=0.0) for *_, lines in panels for _, values in lines
    ]
    index = extremes(finite, points)
    return {
        "name": traces.name,
        "start": float(traces.time[0]),
        "rate": traces.rate_hz,
        "every": len(index) == len(traces.time),
        "index": _base64(index.astype("<u4")),
        "left": [
            [float(traces.time[first]), float(traces.time[last])] for first, last in traces.excluded
        ],
        "panels": [
            [title, unit, [[name, *_packed(values[index])] for name, values in lines]]
            for title, unit, lines in panels
        ],
    }


def _packed(values: FloatArray) -> tuple[float, float, str]:
    """Least value, largest value, and every value as a step between them."""
    finite = values[np.isfinite(values)]
    low, high = (float(finite.min()), float(finite.max())) if finite.size else (0.0, 0.0)
    share = np.clip((values - low) / ((high - low) or 1.0), 0.0, 1.0)
    steps = np.where(np.isfinite(values), np.round(share * _STEPS), _STEPS + 1)
    return low, high, _base64(steps.astype("<u2"))


def _base64(numbers: "bytes | np.ndarray[Any, Any]") -> str:
    return base64.b64encode(bytes(numbers)).decode()
