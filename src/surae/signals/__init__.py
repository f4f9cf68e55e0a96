"""Recordings to model inputs: filters, resampling, derivatives."""

from surae.signals.inputs import ModelInputs

__all__ = ["ModelInputs"]
