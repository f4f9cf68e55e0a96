"""Virtual subjects and what is learnt from fitting them."""

from surae._lazy import lazy_names

__getattr__, __dir__ = lazy_names(__name__, __file__)
