"""Versions of everything that a number can depend on."""

import platform
from functools import cache
from importlib.metadata import version

from surae._version import __version__
from surae.base.frozen import FrozenDict


@cache
def versions() -> FrozenDict[str, str]:
    """Versions of surae, Python, NumPy, SciPy and numba, by name."""
    libraries = {name: version(name) for name in ("numpy", "scipy", "numba")}
    return FrozenDict({"surae": __version__, "python": platform.python_version(), **libraries})
