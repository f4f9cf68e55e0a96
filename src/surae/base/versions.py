"""Versions of everything that a number can depend on."""

import platform
from importlib.metadata import version

from surae._version import __version__


def versions() -> dict[str, str]:
    """Versions of surae, Python, NumPy, SciPy and numba, by name."""
    libraries = {name: version(name) for name in ("numpy", "scipy", "numba")}
    return {"surae": __version__, "python": platform.python_version(), **libraries}
