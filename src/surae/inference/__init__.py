"""Parameters from recordings, and what they are worth: search, uncertainty, verdicts.

``__init__.pyi`` lists what it offers; each is loaded when it is first used.
"""

from surae._lazy import lazy_names

__getattr__, __dir__ = lazy_names(__name__, __file__)
