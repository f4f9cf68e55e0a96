"""A fit keeps nothing that its answer does not need."""

import gc
import weakref

import pytest

import surae
from surae.inference.posterior.linearised import Observed
from surae.inference.posterior.log_posterior import LogPosterior

#: By how much the memory of a process may differ after more fits [MiB].
LEVEL = 30.0


@pytest.fixture(scope="module")
def trial() -> surae.ModelInputs:
    return surae.prepare(surae.example())


def test_a_posterior_goes_with_its_fit(trial, monkeypatch) -> None:
    """None waits for the collector of cycles, which counts objects and not how large they are."""
    alive: weakref.WeakSet[LogPosterior | Observed] = weakref.WeakSet()
    for kind in (LogPosterior, Observed):
        make = kind.__init__

        def made(self, *args, make=make, **more):
            alive.add(self)
            make(self, *args, **more)

        monkeypatch.setattr(kind, "__init__", made)
    gc.collect()  # which no test does by itself
    fit = surae.fit(trial, quality=())
    assert fit.status == "converged"
    assert len(alive) == 0


@pytest.mark.slow
def test_memory_stays_level_however_often_one_fits(trial) -> None:
    psutil = pytest.importorskip("psutil")
    process = psutil.Process()

    def size() -> float:
        surae.fit(trial, quality=())
        return process.memory_info().rss / 2**20

    gc.enable()  # as wherever one fits
    try:
        first = max(size() for _ in range(3))
        assert max(size() for _ in range(6)) < first + LEVEL
    finally:
        gc.disable()
