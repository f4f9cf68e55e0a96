"""Many calls of one function: run anywhere, stopped at any time, kept, and gone on with."""

from surae._lazy import lazy_names

__getattr__, __dir__ = lazy_names(__name__, __file__)
