"""Models of the ankle: parameters, equations, simulators with exact sensitivities."""

from surae.model.options import ModelOptions
from surae.model.parameters import Parameter, adapted
from surae.model.registry import (
    MODELS,
    ModelSpec,
    check_names,
    check_value,
    get_model,
    with_optional,
)
from surae.model.simulator import (
    Simulator,
    TendonLaw,
    TendonState,
    TorqueParts,
    check_finite_torque,
)

__all__ = [
    "MODELS",
    "ModelOptions",
    "ModelSpec",
    "Parameter",
    "Simulator",
    "TendonLaw",
    "TendonState",
    "TorqueParts",
    "adapted",
    "check_finite_torque",
    "check_names",
    "check_value",
    "get_model",
    "with_optional",
]
