"""Versions of everything that a number can depend on."""

import platform


def versions() -> dict[str, str]:
    """Versions of surae, Python, NumPy, SciPy and numba, by name."""
    import numba
    import numpy as np
    import scipy

    from surae._version import __version__

    return {
        "surae": __version__,
        "python": platform.python_version(),
        "numpy": np.__version__,
        "scipy": scipy.__version__,
        "numba": numba.__version__,
    }
