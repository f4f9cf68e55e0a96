"""Ankle muscle parameters from a robot's recording of one leg, with honest uncertainty.

Everything public is loaded when it is first used, so that importing surae costs nothing.
"""

from importlib import import_module
from typing import TYPE_CHECKING, Any

from surae._version import __version__
from surae.errors import ComputationError, InputError, SuraeError

if TYPE_CHECKING:
    from surae.api import (
        Fit,
        bootstrap,
        check,
        compare,
        emg_bias,
        fit,
        leave_one_out,
        load,
        normalise,
        posterior,
        profile,
        simulate,
        simulate_parts,
        simulate_tendon,
        validate,
    )
    from surae.assessment import Baseline, Comparison
    from surae.model.anthropometry import foot_mass
    from surae.quality import Finding, Quality
    from surae.recording import (
        Inspection,
        Recording,
        inspect,
        read,
        write_bids,
        write_csv,
        write_sto,
    )
    from surae.settings import FitSettings
    from surae.signals import (
        EmgReference,
        ModelInputs,
        Preparation,
        Weighting,
    )
    from surae.signals.prepare import prepare

_HOMES = {
    "Baseline": "surae.assessment",
    "Comparison": "surae.assessment",
    "EmgReference": "surae.signals",
    "Finding": "surae.quality",
    "Fit": "surae.api",
    "FitSettings": "surae.settings",
    "Inspection": "surae.recording",
    "ModelInputs": "surae.signals",
    "Preparation": "surae.signals",
    "Quality": "surae.quality",
    "Recording": "surae.recording",
    "Weighting": "surae.signals",
    "bootstrap": "surae.api",
    "check": "surae.api",
    "compare": "surae.api",
    "emg_bias": "surae.api",
    "fit": "surae.api",
    "foot_mass": "surae.model.anthropometry",
    "inspect": "surae.recording",
    "leave_one_out": "surae.api",
    "load": "surae.api",
    "normalise": "surae.api",
    "posterior": "surae.api",
    "prepare": "surae.signals",
    "profile": "surae.api",
    "read": "surae.recording",
    "simulate": "surae.api",
    "simulate_parts": "surae.api",
    "simulate_tendon": "surae.api",
    "validate": "surae.api",
    "write_bids": "surae.recording",
    "write_csv": "surae.recording",
    "write_sto": "surae.recording",
}

__all__ = [
    "Baseline",
    "Comparison",
    "ComputationError",
    "EmgReference",
    "Finding",
    "Fit",
    "FitSettings",
    "InputError",
    "Inspection",
    "ModelInputs",
    "Preparation",
    "Quality",
    "Recording",
    "SuraeError",
    "Weighting",
    "__version__",
    "bootstrap",
    "check",
    "compare",
    "emg_bias",
    "fit",
    "foot_mass",
    "inspect",
    "leave_one_out",
    "load",
    "normalise",
    "posterior",
    "prepare",
    "profile",
    "read",
    "simulate",
    "simulate_parts",
    "simulate_tendon",
    "validate",
    "write_bids",
    "write_csv",
    "write_sto",
]


def __getattr__(name: str) -> Any:
    """Load a public name when it is first used."""
    if name not in _HOMES:
        raise AttributeError(f"module 'surae' has no attribute {name!r}")
    return getattr(import_module(_HOMES[name]), name)


def __dir__() -> list[str]:
    """List the public names, loaded or not."""
    return __all__
