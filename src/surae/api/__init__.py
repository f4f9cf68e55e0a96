"""The public functions: what the command line, the workbench and Python code all call.

``__init__.pyi`` lists them; each is loaded when it is first used.
"""

from surae._lazy import lazy_names

__getattr__, __dir__ = lazy_names(__name__, __file__)
