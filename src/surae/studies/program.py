"""What computes a study's numbers, as one hash: another program's results are not these results."""

import hashlib
from functools import cache
from importlib.metadata import PackageNotFoundError, version
from pathlib import Path

from surae._version import __version__

_PACKAGE = Path(__file__).resolve().parents[1]
#: Folders whose code a result depends on.
_COMPUTING = ("signals", "model", "protocol", "estimation", "assessment", "studies")
#: Modules of this folder that plan, keep and hand on results, and change none.
BOOKKEEPING = ("run", "store", "study", "table")
_LIBRARIES = ("numba", "numpy", "scipy")


@cache
def fingerprint() -> str:
    """Hash of surae's version, the sources that compute, and the libraries they use."""
    digest = hashlib.sha256(__version__.encode())
    for name in _LIBRARIES:
        try:
            digest.update(f"{name} {version(name)}\n".encode())
        except PackageNotFoundError:  # part of a bundle without metadata
            digest.update(f"{name}\n".encode())
    for folder in _COMPUTING:
        for source in sorted((_PACKAGE / folder).rglob("*.py")):
            if folder != "studies" or source.stem not in BOOKKEEPING:
                digest.update(source.relative_to(_PACKAGE).as_posix().encode())
                digest.update(source.read_bytes())
    return digest.hexdigest()
