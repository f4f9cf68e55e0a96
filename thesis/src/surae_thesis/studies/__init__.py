"""Studies: thousands of fits of virtual trials over crossed factors, that resume.

``__init__.pyi`` lists what it offers; each is loaded when it is first used.
"""

from surae._lazy import lazy_names

__getattr__, __dir__ = lazy_names(__name__, __file__)
