"""Measurement protocols: position profiles, effort tasks, device limits, files."""

from surae._lazy import lazy_names

__getattr__, __dir__ = lazy_names(__name__, __file__)
