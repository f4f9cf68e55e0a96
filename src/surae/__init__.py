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
        compare,
        fit,
        load,
        simulate,
        simulate_parts,
        simulate_tendon,
        validate,
    )
    from surae.assessment import Comparison
    from surae.recording import Recording, read, write_csv
    from surae.signals import ModelInputs, Preparation
    from surae.signals.prepare import prepare

_HOMES = {
    "Comparison": "surae.assessment",
    "Fit": "surae.api",
    "ModelInputs": "surae.signals",
    "Preparation": "surae.signals",
    "Recording": "surae.recording",
    "compare": "surae.api",
    "fit": "surae.api",
    "load": "surae.api",
    "prepare": "surae.signals",
    "read": "surae.recording",
    "simulate": "surae.api",
    "simulate_parts": "surae.api",
    "simulate_tendon": "surae.api",
    "validate": "surae.api",
    "write_csv": "surae.recording",
}

__all__ = [
    "Comparison",
    "ComputationError",
    "Fit",
    "InputError",
    "ModelInputs",
    "Preparation",
    "Recording",
    "SuraeError",
    "__version__",
    "compare",
    "fit",
    "load",
    "prepare",
    "read",
    "simulate",
    "simulate_parts",
    "simulate_tendon",
    "validate",
    "write_csv",
]


def __getattr__(name: str) -> Any:
    """Load a public name when it is first used."""
    if name not in _HOMES:
        raise AttributeError(f"module 'surae' has no attribute {name!r}")
    return getattr(import_module(_HOMES[name]), name)


def __dir__() -> list[str]:
    """List the public names, loaded or not."""
    return __all__
