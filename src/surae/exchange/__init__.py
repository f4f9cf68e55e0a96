"""A fitted leg as a model file of another simulator, and how far its torque is from ours."""

from surae.exchange.exported import FORMATS, ExportedModel, exported

__all__ = ["FORMATS", "ExportedModel", "exported"]
