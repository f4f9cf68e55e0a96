"""What README promises of one trial, and when a count keeps it.

Shares are README's table, counted on legs that depart from every model. Values of few legs scatter
about them: a count fails only where so few true ones came once in twenty times.

Arms and paths are doubted since, and take nine of ten claims of muscle-space parameters. That
enough is claimed is asked of fits that are judged as if they were known; truth, of both.
"""

from collections.abc import Iterator
from contextlib import contextmanager

import pytest
from scipy.stats import binom

import surae

#: Part of what is called identified that is true; part of what is free that is identified where
#: arms and paths are known; part of all intervals that hold.
PROMISED, IDENTIFIED, HOLD = 0.93, 0.09, 0.95


def keeps_the_promise(true: int, claimed: int, promised: float = PROMISED) -> bool:
    """Whether so few true ones come once in twenty times at least where `promised` are true."""
    return bool(true >= binom.ppf(0.05, claimed, promised))


@contextmanager
def arms_known() -> Iterator[None]:
    """Judge as if arms and paths were the leg's own; what they add: test_arms_and_paths.py.

    Else nothing that rests on them is identified, and what a test asks of noise, EMG or another
    tissue would hold whatever the code does.
    """
    with pytest.MonkeyPatch.context() as patch:
        patch.setattr("surae.inference.uncertainty.combined.arms_and_paths", lambda *_: None)
        yield


def with_known_arms(fit: surae.Fit) -> surae.Fit:
    """The fit, judged so."""
    with arms_known():
        return fit.reassess()
