"""Ankle muscle parameters from a robot's recording of one leg, with honest uncertainty.

Everything public is loaded when it is first used, so that importing surae costs nothing;
``__init__.pyi`` lists it.
"""

from surae._lazy import lazy_names
from surae._version import __version__ as __version__
from surae.base.errors import ComputationError as ComputationError
from surae.base.errors import InputError as InputError
from surae.base.errors import SuraeError as SuraeError

__getattr__, __dir__ = lazy_names(__name__, __file__)
