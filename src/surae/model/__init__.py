"""Models of the ankle: parameters, equations, simulators with exact sensitivities.

``__init__.pyi`` lists what it offers; help needs the options alone, so each is loaded when it is
first used.
"""

from surae._lazy import lazy_names

__getattr__, __dir__ = lazy_names(__name__, __file__)
