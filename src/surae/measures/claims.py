"""Several claims at once: by how much their p-values grow.

References
----------
S. Holm (1979). A simple sequentially rejective multiple test procedure. Scandinavian Journal of
Statistics 6(2):65-70.
Y. Benjamini and Y. Hochberg (1995). Controlling the false discovery rate. Journal of the Royal
Statistical Society B 57(1):289-300.
"""

from collections.abc import Mapping
from typing import TypeVar

_Key = TypeVar("_Key", str, tuple[str, str])


def holm(p: Mapping[_Key, float]) -> dict[_Key, float]:
    """Holm's p-values: at a level, that part of all sets of claims at most has a false one."""
    adjusted: dict[_Key, float] = {}
    before = 0.0
    for done, key in enumerate(sorted(sorted(p), key=lambda key: p[key])):
        before = adjusted[key] = min(1.0, max(before, (len(p) - done) * p[key]))
    return adjusted


def false_discovery(p: Mapping[_Key, float]) -> dict[_Key, float]:
    """Benjamini and Hochberg's: at a level, that part of the claims is false on average.

    Where nothing at all has changed, that part of all sets of claims at most has any.
    """
    adjusted: dict[_Key, float] = {}
    after = 1.0
    for rank, key in zip(
        range(len(p), 0, -1), sorted(sorted(p), key=lambda key: p[key], reverse=True), strict=True
    ):
        after = adjusted[key] = min(after, len(p) / rank * p[key])
    return {key: adjusted[key] for key in p}
