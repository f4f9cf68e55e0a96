"""Models of the ankle: parameters, equations, simulators with exact sensitivities."""

from surae.model.options import ModelOptions
from surae.model.parameters import Parameter, adapted
from surae.model.registry import MODELS, ModelSpec, check_names, check_value, get_model
from surae.model.simulator import Simulator, TorqueParts

__all__ = [
    "MODELS",
    "ModelOptions",
    "ModelSpec",
    "Parameter",
    "Simulator",
    "TorqueParts",
    "adapted",
    "check_names",
    "check_value",
    "get_model",
]
