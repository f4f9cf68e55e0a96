"""Engines: the same outcomes from all of them, and a worker that dies costs a retry at most."""

import json
import multiprocessing
import os
import signal
import subprocess
import sys
import time
from collections.abc import Iterator
from contextlib import ExitStack, closing
from dataclasses import replace
from pathlib import Path

import pytest

from surae.errors import ComputationError, InputError
from surae.studies.engines import Engine, outcomes
from surae.studies.study import parse_study
from surae.studies.tasks import Task, planned, run_task

#: Seconds that anything may take on a computer that is busy with other things.
PATIENCE = 300.0
TEXT = """
protocol = "ramp-and-hold"
rate_hz = 50
starts = 1
chirp_amplitude = [0.1, 0.2]
subjects = {}
"""


def tasks(subjects: int) -> dict[str, Task]:
    return {task.key: task for _, task in planned(parse_study(TEXT.format(subjects)))}


class Poison(Task):
    """A task that kills the worker that looks at it."""

    @property
    def key(self) -> str:
        name = multiprocessing.current_process().name
        if name != "MainProcess" or "SURAE_TEST_WORKER" in os.environ:
            os.kill(os.getpid(), signal.SIGKILL)
        return "poison"


class Foreign(Task):
    """A task that another program planned."""

    @property
    def key(self) -> str:
        return "another"


def of(kind: type[Task], task: Task) -> Task:
    return kind(**{name: getattr(task, name) for name in Task.__dataclass_fields__})


def results(given: dict[str, Task], engine: Engine) -> dict[str, object]:
    found = [pair for batch in outcomes(given, engine) for pair in batch]
    assert len(found) == len(dict(found))
    return {key: replace(outcome, seconds=0.0) for key, outcome in found}


@pytest.fixture(scope="module")
def expected() -> dict[str, object]:
    return {key: replace(run_task(task), seconds=0.0) for key, task in tasks(4).items()}


@pytest.mark.parametrize(
    "engine", [Engine("threads", 1), Engine("threads", 3), Engine("processes", 1),
               Engine("processes", 2)],
)  # fmt: skip
def test_every_engine_gives_the_same_bits(engine, expected) -> None:
    assert results(tasks(4), engine) == expected
    backwards = dict(reversed(tasks(4).items()))
    assert results(backwards, engine) == expected


def test_a_task_that_kills_its_workers_fails_alone(expected) -> None:
    given = tasks(4)
    given["poison"] = of(Poison, next(iter(given.values())))
    found = results(dict(reversed(given.items())), Engine("processes", 2))
    bad = found.pop("poison")
    assert (bad.status, bad.vaf) == ("failed", None)
    assert bad.message == "its worker died 3 times: out of memory, or killed"
    assert found == expected


def test_another_program_in_a_worker_is_refused() -> None:
    given = {"planned": of(Foreign, next(iter(tasks(1).values())))}
    with pytest.raises(ComputationError, match="a worker has another surae"):
        results(given, Engine("processes", 1))


def test_stopping_half_way_ends_the_workers() -> None:
    psutil = pytest.importorskip("psutil")
    before = set(psutil.Process().children(recursive=True))
    with closing(outcomes(tasks(200), Engine("processes", 2))) as found:
        next(found)
        assert len(set(psutil.Process().children(recursive=True)) - before) >= 2
    end = time.monotonic() + PATIENCE
    while workers := [
        child
        for child in set(psutil.Process().children(recursive=True)) - before
        if "resource_tracker" not in " ".join(child.cmdline())
    ]:
        assert time.monotonic() < end, workers
        time.sleep(0.05)


def test_engines_that_are_none() -> None:
    with pytest.raises(InputError, match="engine 'gpu' is not known; use one of: processes"):
        Engine("gpu")
    with pytest.raises(InputError, match="0 workers; give at least 1"):
        Engine("threads", 0)


@pytest.fixture
def cluster(request, tmp_path, monkeypatch) -> Iterator[tuple[str, list[subprocess.Popen[bytes]]]]:
    """A scheduler and two workers, processes of their own, over TCP: its address, the workers."""
    pytest.importorskip("distributed")
    monkeypatch.setattr("surae.studies.pools._PATIENCE", PATIENCE)  # the workers may start slowly
    where = tmp_path / "scheduler.json"
    path = os.pathsep.join([str(Path(__file__).parent), *filter(None, sys.path)])
    settings = os.environ | {"PYTHONPATH": path, "SURAE_TEST_WORKER": "1"}
    settings |= getattr(request, "param", {})
    host = ["--host", "127.0.0.1", "--no-dashboard"]
    alone = ["--scheduler-file", where, "--nthreads", "1", "--no-nanny", *host]
    alone += ["--local-directory", tmp_path]
    kinds = [["scheduler", "--port", "0", "--scheduler-file", where, *host]]
    kinds += [["worker", *alone]] * 2
    with ExitStack() as stack:
        started = []
        for kind in kinds:
            process = subprocess.Popen(
                [sys.executable, "-m", "dask", *kind], env=settings, cwd=tmp_path,
                stdout=subprocess.DEVNULL, stderr=subprocess.DEVNULL,
            )  # fmt: skip
            stack.callback(process.wait)
            stack.callback(process.kill)
            started.append(process)
        end = time.monotonic() + PATIENCE
        while not where.exists() or not where.read_text().strip():
            assert time.monotonic() < end
            time.sleep(0.05)
        yield json.loads(where.read_text())["address"], started[1:]


def test_a_cluster_that_loses_a_worker_half_way(cluster, expected) -> None:
    address, workers = cluster
    given = tasks(100)
    found = {}
    for batch in outcomes(given, Engine("dask", address=address)):
        found |= dict(batch)
        if len(found) >= 60:
            workers[0].kill()
    assert found.keys() == given.keys()
    assert all(outcome.vaf is not None for outcome in found.values())
    shared = [key for key in expected if key in found]
    assert len(shared) == len(expected)
    assert {key: replace(found[key], seconds=0.0) for key in shared} == expected


def test_a_cluster_that_is_not_there(monkeypatch) -> None:
    pytest.importorskip("distributed")
    monkeypatch.setattr("surae.studies.pools._PATIENCE", 1.0)
    with pytest.raises(InputError, match=r"no cluster at tcp://127\.0\.0\.1:9: .*; give the sch"):
        results(tasks(1), Engine("dask", address="tcp://127.0.0.1:9"))


def test_without_dask_a_cluster_is_refused_kindly(monkeypatch) -> None:
    monkeypatch.setitem(sys.modules, "distributed", None)
    with pytest.raises(InputError, match=r"pip install 'surae\[cluster\]'"):
        results(tasks(1), Engine("dask", address="tcp://127.0.0.1:9"))


@pytest.mark.parametrize(
    "cluster", [{"DASK_DISTRIBUTED__SCHEDULER__ALLOWED_FAILURES": "0"}], indirect=True
)
def test_a_task_that_kills_a_cluster_s_worker_fails(cluster) -> None:
    address, workers = cluster
    given = {"poison": of(Poison, next(iter(tasks(1).values())))}
    ((key, outcome),) = next(outcomes(given, Engine("dask", address=address)))
    assert (key, outcome.status) == ("poison", "failed")
    assert outcome.message == "its worker died: out of memory, or killed"
    end = time.monotonic() + PATIENCE  # the cluster may know of the death before its parent does
    while all(worker.poll() is None for worker in workers):
        assert time.monotonic() < end
        time.sleep(0.05)
    assert sum(worker.poll() is not None for worker in workers) == 1
