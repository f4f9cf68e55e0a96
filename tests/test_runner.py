"""Engines: the same from all of them, and a worker that dies costs a retry at most."""

import os
import signal
import sys
import time
from collections.abc import Iterator
from contextlib import closing

import pytest

from clusters import PATIENCE, Cluster, started_cluster
from surae.base.errors import ComputationError, InputError
from surae.processes.runner import Died, Engine, results

CALLS = {f"call {n}": {"n": n} for n in range(40)}
#: Calls that know the process that they must not kill.
POISON = {"poison": {"n": -1, "spared": os.getpid()}}


def work(n: int, spared: int = 0) -> dict[str, object]:
    """What is called, here and in workers; it kills them where n is negative."""
    if n < 0 and os.getpid() != spared:
        os.kill(os.getpid(), signal.SIGKILL)
    time.sleep(0.01)
    return {"third": n / 3, "text": "é" * n}


def refuse(n: int) -> None:
    raise InputError(f"no call {n}")


def fail(n: int) -> None:
    raise LookupError(f"no call {n}")


def all_of(
    calls: dict[str, dict[str, int]], engine: Engine, function: str = "work"
) -> dict[str, object]:
    pairs = [pair for batch in results(f"{__name__}:{function}", calls, engine) for pair in batch]
    assert len(pairs) == len(dict(pairs))
    return dict(pairs)


@pytest.fixture(scope="module")
def expected() -> dict[str, object]:
    return {key: {"third": n / 3, "text": "é" * n} for n, key in enumerate(CALLS)}


@pytest.mark.parametrize(
    "engine",
    [Engine("threads", 1), Engine("threads", 3), Engine("processes", 2)],
)
def test_every_engine_gives_the_same_bits(engine, expected) -> None:
    assert all_of(CALLS, engine) == expected
    assert all_of(dict(reversed(CALLS.items())), engine) == expected


def test_threads_call_functions_without_a_name() -> None:
    done = dict(
        pair for batch in results(lambda n: n + 0.5, CALLS, Engine("threads", 2)) for pair in batch
    )
    assert done == {f"call {n}": n + 0.5 for n in range(40)}


@pytest.mark.slow
def test_a_call_that_kills_its_workers_dies_alone(expected) -> None:
    done = all_of({**POISON, **CALLS}, Engine("processes", 2))
    assert done.pop("poison") == Died("its worker died 3 times: out of memory, or killed")
    assert done == expected


@pytest.mark.parametrize("kind", ["threads", "processes"])
def test_the_function_s_own_errors_end_the_run(kind) -> None:
    with pytest.raises(InputError, match=r"^no call \d+$"):
        all_of(CALLS, Engine(kind, 2), "refuse")
    with pytest.raises(
        ComputationError if kind == "processes" else LookupError,
        match="LookupErr" if kind == "processes" else "no call",
    ):
        all_of(CALLS, Engine(kind, 2), "fail")


def test_stopping_half_way_ends_the_workers() -> None:
    psutil = pytest.importorskip("psutil")
    before = set(psutil.Process().children(recursive=True))
    with closing(results(f"{__name__}:work", CALLS, Engine("processes", 2))) as batches:
        next(batches)
        assert len(set(psutil.Process().children(recursive=True)) - before) == 2
    assert set(psutil.Process().children(recursive=True)) <= before


def test_engines_that_are_none() -> None:
    with pytest.raises(InputError, match="engine 'gpu' is not known; use one of: processes"):
        Engine("gpu")
    with pytest.raises(InputError, match="workers is 0; give at least 1"):
        Engine("threads", 0)


@pytest.fixture
def cluster(request, tmp_path, monkeypatch) -> Iterator[Cluster]:
    """A scheduler and two workers, processes of their own, over TCP: its address, the workers."""
    pytest.importorskip("distributed")
    # the workers may start slowly
    monkeypatch.setattr("surae.processes.runner._PATIENCE", PATIENCE)
    with started_cluster(tmp_path, getattr(request, "param", {})) as both:
        yield both


@pytest.mark.slow
def test_a_cluster_that_loses_a_worker_half_way(cluster) -> None:
    address, workers = cluster
    calls = {f"call {n}": {"n": n} for n in range(100)}
    done = {}
    for batch in results(f"{__name__}:work", calls, Engine("dask", address=address)):
        done |= dict(batch)
        if len(done) >= 60:
            workers[0].kill()
    assert done == {f"call {n}": {"third": n / 3, "text": "é" * n} for n in range(100)}


def test_a_cluster_that_is_not_there(monkeypatch) -> None:
    pytest.importorskip("distributed")
    monkeypatch.setattr("surae.processes.runner._PATIENCE", 1.0)
    with pytest.raises(InputError, match=r"no cluster at tcp://127\.0\.0\.1:9: .*; give the sch"):
        all_of(CALLS, Engine("dask", address="tcp://127.0.0.1:9"))


def test_without_dask_a_cluster_is_refused_kindly(monkeypatch) -> None:
    monkeypatch.setitem(sys.modules, "distributed", None)
    with pytest.raises(InputError, match=r"pip install 'surae\[cluster\]'"):
        all_of(CALLS, Engine("dask", address="tcp://127.0.0.1:9"))


@pytest.mark.slow
@pytest.mark.parametrize(
    "cluster", [{"DASK_DISTRIBUTED__SCHEDULER__ALLOWED_FAILURES": "0"}], indirect=True
)
def test_a_cluster_gives_the_same_and_a_call_that_kills_its_worker_dies(cluster, expected) -> None:
    address, workers = cluster
    assert all_of(CALLS, Engine("dask", address=address)) == expected
    ((key, died),) = next(results(f"{__name__}:work", POISON, Engine("dask", address=address)))
    assert (key, died) == ("poison", Died("its worker died: out of memory, or killed"))
    end = time.monotonic() + PATIENCE  # the cluster may know of the death before its parent does
    while all(worker.poll() is None for worker in workers):
        assert time.monotonic() < end
        time.sleep(0.05)
    assert sum(worker.poll() is not None for worker in workers) == 1
