"""A fitted leg as a model file of another simulator, and how far its torque is from ours."""

from surae_exchange.exported import FORMATS, ExportedModel, export

__all__ = ["FORMATS", "ExportedModel", "export"]
