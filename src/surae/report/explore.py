"""Plots to zoom into and read values from: their data, and the script that the page needs."""

import base64
import hashlib
import json
from collections.abc import Sequence
from dataclasses import dataclass
from functools import cache
from importlib.resources import files
from typing import Any

import numpy as np

from surae.recording import MUSCLES
from surae.report.traces import Traces, extremes
from surae.units import FloatArray

#: Samples of all recordings that a page holds at most, and of each at least.
_POINTS, _FEWEST = 12_000, 1500
#: Steps between the least and the largest value of a line; the next number says: none.
_STEPS = 65534


@dataclass(frozen=True, slots=True)
class Explorer:
    """What the page needs for its plots."""

    data: str  #: JSON of the signals, without any sign that could end an element of the page.
    scripts: tuple[str, ...]  #: The scripts, to stand in the page as they are.
    style: str  #: The plots' style sheet.
    policy: str  #: The scripts' hashes: the page runs these and no others.


def signals_of(recordings: Sequence[Traces]) -> str:
    """The signals of every recording of a fit, as the plots read them; empty without any."""
    if not recordings:
        return ""
    points = max(_POINTS // len(recordings), _FEWEST)
    data = json.dumps([_recording(traces, points) for traces in recordings], separators=(",", ":"))
    return data.replace("<", "\\u003c")


def explorer(signals: str) -> Explorer:
    """The plots of signals."""
    scripts, style = _vendored()
    hashes = (hashlib.sha256(script.encode()).digest() for script in scripts)
    policy = " ".join(f"'sha256-{base64.b64encode(each).decode()}'" for each in hashes)
    return Explorer(signals, scripts, style, policy)


@cache
def _vendored() -> tuple[tuple[str, ...], str]:
    """The library of the plots, which the workbench has too, and the script that uses it."""
    package = files("surae.report") / "static"
    library, own = package / "vendor" / "uplot", package / "explore.js"
    scripts = tuple(
        path.read_text(encoding="utf-8").strip() for path in (library / "uPlot.iife.min.js", own)
    )
    return scripts, (library / "uPlot.min.css").read_text(encoding="utf-8").strip()


def _recording(traces: Traces, points: int) -> dict[str, Any]:
    parts = traces.parts
    volts = traces.emg_unit == "V"
    muscles = [muscle for muscle in MUSCLES if muscle not in traces.missing_emg]
    panels: list[tuple[str, str, list[tuple[str, FloatArray]]]] = [
        ("Torque", "Nm", [("measured", traces.measured), ("modelled", traces.modelled)]),
        ("Residual", "Nm", [("measured minus modelled", traces.residual)]),
        (
            "Parts of the modelled torque",
            "Nm",
            [
                (name, values)
                for name in ("tissue", "neural", "inertial", "gravitational", "reflex", "zero")
                if (values := getattr(parts, name)) is not None
            ],
        ),
        ("Ankle angle", "°", [("angle", np.degrees(traces.angle))]),
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


def _base64(numbers: "np.ndarray[Any, Any]") -> str:
    return base64.b64encode(numbers.tobytes()).decode()
