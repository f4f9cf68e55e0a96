"""Where tasks run: threads, processes, or the workers of a Dask cluster, all behind one loop.

joblib's own loop over these is not used: it waits for ever for a Dask task whose workers died, and
ends with the first process that does. Its processes (loky) are.
"""

from collections import Counter, deque
from collections.abc import Generator, Iterator, Mapping
from concurrent.futures import FIRST_COMPLETED, Future, wait
from contextlib import contextmanager
from dataclasses import dataclass

from surae.errors import ComputationError, InputError
from surae.studies.pools import AGAIN, KINDS, Pool, started, without_interrupt
from surae.studies.tasks import Outcome, Task

#: What became of tasks: outcomes with the tasks' keys.
Batch = list[tuple[str, Outcome]]


@dataclass(frozen=True, slots=True)
class Engine:
    """Which engine, as plain data.

    Attributes
    ----------
    kind : {"processes", "threads", "dask"}
        Processes survive a task that kills its worker, and scale; threads start at once.
    workers : int
        Processes or threads; a cluster has its own.
    address : str
        Of the cluster's scheduler.
    """

    kind: str = "processes"
    workers: int = 1
    address: str = ""

    def __post_init__(self) -> None:
        """Refuse an unknown kind."""
        if self.kind not in KINDS:
            raise InputError(f"engine {self.kind!r} is not known; use one of: {', '.join(KINDS)}")
        if self.workers < 1:
            raise InputError(f"{self.workers} workers; give at least 1")


def outcomes(tasks: Mapping[str, Task], engine: Engine) -> Generator[Batch]:
    """Run tasks, in any order; what has come out since the last time, with the tasks' keys.

    A task that was at work when a worker died runs again, alone, so that only the guilty one is
    blamed: after as many deaths as the pool allows, it has failed.

    Raises
    ------
    InputError
        The cluster cannot be reached, or dask is not installed.
    ComputationError
        The workers are lost, or one of them has another surae.
    """
    pool = started(engine.kind, engine.workers, engine.address)
    waiting, suspects = deque(tasks), deque[str]()
    deaths: Counter[str] = Counter()
    flying: dict[Future[Outcome | None], str] = {}
    try:
        while waiting or suspects or flying:
            alone = bool(suspects)
            source = suspects if alone else waiting
            while source and len(flying) < (1 if alone else pool.ahead()):
                key = source.popleft()
                with without_interrupt(), _told(pool):
                    flying[pool.submit(key, tasks[key])] = key
            only = len(flying) == 1
            landed, _ = wait(flying, return_when=FIRST_COMPLETED)
            done, lost = _collected({future: flying.pop(future) for future in landed}, pool)
            if lost and pool.together:
                wait(flying)
                more, too = _collected(flying, pool)
                done, lost, flying = done + more, lost + too, {}
            for key in lost:
                deaths[key] += only
                if deaths[key] < pool.deaths:
                    suspects.append(key)
                    continue
                times = f" {pool.deaths} times" if pool.deaths > 1 else ""
                text = f"its worker died{times}: out of memory, or killed"
                done.append((key, Outcome("failed", text)))
            if done:
                yield done
    finally:
        pool.stop()


def _collected(
    futures: Mapping[Future[Outcome | None], str], pool: Pool
) -> tuple[Batch, list[str]]:
    """What came of futures that are over: outcomes, and the tasks whose worker died."""
    done, lost = [], []
    for future, key in futures.items():
        try:
            with _told(pool):
                outcome = future.result()
        except pool.died:
            lost.append(key)
            continue
        if outcome is None:
            raise ComputationError(
                "a worker has another surae, or other libraries, than the run: install the same "
                f"everywhere and {AGAIN}"
            )
        done.append((key, outcome))
    return done, lost


@contextmanager
def _told(pool: Pool) -> Iterator[None]:
    """An engine's own errors in words; a task's are outcomes."""
    try:
        yield
    except pool.died:
        raise
    except Exception as error:
        text = " ".join(f"{type(error).__name__}: {error}".split())
        raise ComputationError(f"the workers are lost ({text}); {AGAIN}") from error
