"""Many independent calls of one function: in threads, processes, or the workers of a cluster.

One loop over futures serves all three. A call's result never depends on where it runs, when, or
beside what.
"""

import threading
import time
from collections import Counter, deque
from collections.abc import Callable, Generator, Iterator, Mapping
from concurrent.futures import FIRST_COMPLETED, Future, ThreadPoolExecutor, wait
from contextlib import contextmanager
from dataclasses import dataclass
from functools import cache
from queue import SimpleQueue
from typing import Any

from surae.base.errors import ComputationError, InputError, SuraeError
from surae.base.threads import cores
from surae.processes import Child, Plain, function, one_line, without_interrupt

#: What there is.
KINDS = ("processes", "threads", "dask")
#: What the user does about an engine that failed.
AGAIN = "run the same command again: what is finished is kept"
#: How long to wait for a cluster's scheduler, and for its first worker [s].
_PATIENCE = 10.0
#: How often to ask a cluster for its size [s].
_OFTEN = 5.0
#: How often to look for Ctrl-C where it does not end a wait [s].
_LOOK = 0.5

#: What is called: a function, or ``module:name`` where it is called elsewhere.
Work = str | Callable[..., Plain]


@dataclass(frozen=True, slots=True)
class Engine:
    """Which engine, as plain data."""

    #: "processes", "threads", "dask": Processes survive a call that kills its worker, and scale;
    #: threads start at once, and call functions that have no name.
    kind: str = "processes"
    workers: int = 1  #: Processes or threads; a cluster has its own.
    address: str = ""  #: Of the cluster's scheduler.

    def __post_init__(self) -> None:
        """Refuse an unknown kind."""
        if self.kind not in KINDS:
            raise InputError(f"engine {self.kind!r} is not known; use one of: {', '.join(KINDS)}")
        if self.workers < 1:
            raise InputError(f"workers is {self.workers}; give at least 1")


def engine_of(dask: str | None, workers: int | None) -> Engine:
    """Where the work is done: a Dask cluster, or so many processes.

    Parameters
    ----------
    dask : str, optional
        Address of a cluster's scheduler.
    workers : int, optional
        Processes on this machine, where there is no cluster; by default one for each core.

    Returns
    -------
    Engine
        What `results` runs calls on.

    Raises
    ------
    InputError
        A cluster brings workers of its own, and yet a number of them is given.
    """
    if dask is None:
        count = workers or cores()
        return Engine("processes" if count > 1 else "threads", count)
    if workers is not None:
        raise InputError("--dask brings workers of its own; give it without --workers")
    return Engine("dask", address=dask)


@dataclass(frozen=True, slots=True)
class Died:
    """What came of a call whose workers died, in a line."""

    message: str


#: What has come out since the last time, by the calls' keys.
Batch = list[tuple[str, "Plain | Died"]]


def results(
    work: Work,
    calls: Mapping[str, Mapping[str, Plain]],
    engine: Engine,
    stop: threading.Event | None = None,
) -> Generator[Batch]:
    """Do calls, each `work` with keywords by its key, in any order; hand over what comes of them.

    A call that was at work when a worker died is done again, alone, so that only the guilty one is
    blamed: after as many deaths as the engine allows, what comes of it is `Died`. `stop` is set
    when no more is wanted, for calls in threads that look at it.
    """
    pool: _Pool
    if engine.kind == "dask":
        pool = _Cluster(engine.address)
    else:
        pool = (_Threads if engine.kind == "threads" else _Processes)(engine.workers)
    waiting = deque(calls)
    suspects = deque[str]()
    deaths: Counter[str] = Counter()
    flying: dict[Future[Plain], str] = {}
    try:
        while waiting or suspects or flying:
            alone = bool(suspects)
            source = suspects if alone else waiting
            while source and len(flying) < (1 if alone else pool.ahead()):
                key = source.popleft()
                with without_interrupt(), _engine_errors(pool):
                    flying[pool.submit(work, calls[key])] = key
            only = len(flying) == 1
            done: Batch = []
            wrong: BaseException | None = None
            for future in wait(flying, timeout=_LOOK, return_when=FIRST_COMPLETED).done:
                key = flying.pop(future)
                try:
                    with _engine_errors(pool):
                        done.append((key, future.result()))
                except pool.died:
                    deaths[key] += only
                    if deaths[key] < pool.deaths:
                        suspects.append(key)
                        continue
                    times = f" {pool.deaths} times" if pool.deaths > 1 else ""
                    done.append((key, Died(f"its worker died{times}: out of memory, or killed")))
                except BaseException as error:
                    wrong = error
            if done:
                yield done
            if wrong is not None:  # after what came beside it
                raise wrong
    finally:
        if stop is not None:
            stop.set()
        pool.stop()


@contextmanager
def _engine_errors(pool: "_Pool") -> Iterator[None]:
    """An engine's own errors in words."""
    try:
        yield
    except Exception as error:
        if pool.here or isinstance(error, (SuraeError, *pool.died)):
            raise
        text = one_line(f"{type(error).__name__}: {error}")
        raise ComputationError(f"the workers are lost ({text}); {AGAIN}") from error


class _Pool:
    """What the loop needs of an engine, with the threads that hand out its calls."""

    #: What its futures raise when a worker died.
    died: tuple[type[BaseException], ...] = ()
    #: A call whose worker died this often while it was the only one at work is given up.
    deaths = 1
    #: Whether an error can only be the function's.
    here = False

    def __init__(self, workers: int) -> None:
        self._workers = workers
        self._executor: Any = ThreadPoolExecutor(workers)

    def submit(self, work: Work, keywords: Mapping[str, Plain]) -> Future[Plain]:
        """Hand a call to a worker, a new one where the last ones broke."""
        future: Future[Plain] = self._executor.submit(self._call, work, dict(keywords))
        return future

    def _call(self, work: Work, keywords: Mapping[str, Plain]) -> Plain:
        return (function(work) if isinstance(work, str) else work)(**keywords)

    def ahead(self) -> int:
        """How many calls to hand out at once, so that no worker waits."""
        return 2 * self._workers

    def stop(self) -> None:
        """End it, with the calls at work."""
        self._executor.shutdown(cancel_futures=True)


class _Threads(_Pool):
    """Threads of this process: the kernels run beside each other, Python does not."""

    here = True

    def __init__(self, workers: int) -> None:
        self._limits = _limited.__wrapped__()
        super().__init__(workers)

    def stop(self) -> None:
        super().stop()
        self._limits.restore_original_limits()


class _DeadError(Exception):
    """The process of a call died."""


class _Processes(_Pool):
    """Children, made anew when one dies; a thread waits for each."""

    died = (_DeadError,)
    deaths = 3

    def __init__(self, workers: int) -> None:
        super().__init__(workers)
        self._children = [Child(calls=None) for _ in range(workers)]
        self._free: SimpleQueue[Child] = SimpleQueue()
        for child in self._children:
            self._free.put(child)

    def _call(self, work: Work, keywords: Mapping[str, Plain]) -> Plain:
        assert isinstance(work, str)
        child = self._free.get()
        try:
            end = child.call(work, keywords)
        finally:
            self._free.put(child)
        if end.how == "killed":
            raise _DeadError
        return end.result()

    def stop(self) -> None:
        for child in self._children:
            child.close()
        super().stop()


class _Cluster(_Pool):
    """The workers of a Dask cluster; its scheduler does a call again elsewhere when one dies."""

    def __init__(self, address: str) -> None:
        try:
            import logging

            from distributed import Client
            from distributed.scheduler import KilledWorker
        except ImportError:
            raise InputError(
                "a cluster needs dask: install it with `pip install 'surae[cluster]'`"
            ) from None
        self.died = (KilledWorker,)
        for name in ("distributed", "tornado"):  # our own errors say it in one line
            logging.getLogger(name).setLevel(logging.CRITICAL)
        cannot = f"no cluster at {address}"
        try:
            with without_interrupt():
                client: Any = Client
                self._client = client(address, timeout=_PATIENCE, set_as_default=False)
        except (OSError, ValueError) as error:
            raise InputError(
                f"{cannot}: {one_line(error)}; give the scheduler's, e.g. tcp://host:8786"
            ) from None
        try:
            self._client.wait_for_workers(1, timeout=_PATIENCE)
        except TimeoutError:
            self._client.close()
            raise ComputationError(f"{cannot} has a worker; start some and {AGAIN}") from None
        self._executor = self._client.get_executor(pure=False)
        self._ahead = 0
        self._latest = -_OFTEN

    def submit(self, work: Work, keywords: Mapping[str, Plain]) -> Future[Plain]:
        future: Future[Plain] = self._executor.submit(_in_cluster, work, dict(keywords))
        return future  # the scheduler does a call again after deaths, as often as it allows

    def ahead(self) -> int:
        if time.monotonic() - self._latest > _OFTEN:  # workers come and go
            self._ahead = 3 * sum(self._client.nthreads().values()) + 1
            self._latest = time.monotonic()
        return self._ahead

    def stop(self) -> None:
        self._executor.shutdown(wait=False)
        self._client.close()


def _in_cluster(work: Work, keywords: Mapping[str, Plain]) -> Plain:
    _limited()
    return (function(work) if isinstance(work, str) else work)(**keywords)


@cache
def _limited() -> Any:
    """One thread for each product: the workers share the cores, and the bits stay the same."""
    import numpy as np  # loads the library that is to be limited
    import scipy.linalg  # and its own
    from threadpoolctl import threadpool_limits

    del np, scipy
    return threadpool_limits(limits=1)
