"""Ankle muscle parameters from a robot's recording of one leg, with honest uncertainty."""

from surae._version import __version__

__all__ = ["__version__"]
