"""What runs tasks: threads and processes of this computer, workers of a Dask cluster."""

import os
import signal
import threading
import time
from collections.abc import Iterator
from concurrent.futures import Executor, Future, ThreadPoolExecutor
from contextlib import contextmanager
from functools import cache
from typing import Any, Protocol

from surae.errors import ComputationError, InputError
from surae.studies.tasks import Outcome, Task, run_task

#: What there is.
KINDS = ("processes", "threads", "dask")
#: What the user does about an engine that failed.
AGAIN = "run the same command again: what is finished is kept"
#: How long to wait for a cluster's scheduler, and for its first worker [s].
_PATIENCE = 10.0
#: How often to ask a cluster for its size [s].
_OFTEN = 5.0
#: What the libraries read their number of threads from when they are loaded.
_THREAD_SETTINGS = (
    "OMP_NUM_THREADS",
    "OPENBLAS_NUM_THREADS",
    "MKL_NUM_THREADS",
    "NUMBA_NUM_THREADS",
)


class Pool(Protocol):
    """What the loop needs of an engine."""

    #: What its futures raise when a worker died.
    died: tuple[type[BaseException], ...]
    #: Whether all tasks at work are lost with one worker, and not only its own.
    together: bool
    #: A task whose worker died this often while it was the only one at work has failed.
    deaths: int

    def submit(self, key: str, task: Task) -> Future[Outcome | None]:
        """Hand a task to a worker, a new one where the last ones broke."""
        ...

    def ahead(self) -> int:
        """How many tasks to hand out at once, so that no worker waits."""
        ...

    def stop(self) -> None:
        """End it, with the tasks at work."""
        ...


def work(key: str, task: Task) -> Outcome | None:
    """Run a task in a worker; None where this is not the program that planned it."""
    if task.key != key:
        return None
    _limited()
    return run_task(task)


@cache
def _limited() -> Any:
    """One thread for each product: the workers share the cores, and the bits stay the same."""
    import numpy as np  # loads the library that is to be limited
    import scipy.linalg  # and its own
    from threadpoolctl import threadpool_limits

    del np, scipy
    return threadpool_limits(limits=1)


@contextmanager
def without_interrupt() -> Iterator[None]:
    """Ctrl-C waits: processes and threads that start here never get it, and need not clean up."""
    if not hasattr(signal, "pthread_sigmask"):
        yield
        return
    before = signal.pthread_sigmask(signal.SIG_BLOCK, [signal.SIGINT])
    try:
        yield
    finally:
        signal.pthread_sigmask(signal.SIG_SETMASK, before)


class _ThreadPool:
    """Threads of this process: the kernels run beside each other, Python does not."""

    died: tuple[type[BaseException], ...] = ()
    together, deaths = False, 1

    def __init__(self, workers: int) -> None:
        self._workers = workers
        self._limits = _limited.__wrapped__()
        self._executor = ThreadPoolExecutor(workers)

    def submit(self, key: str, task: Task) -> Future[Outcome | None]:
        del key
        return self._executor.submit(run_task, task)

    def ahead(self) -> int:
        return 2 * self._workers

    def stop(self) -> None:
        self._executor.shutdown(cancel_futures=True)
        self._limits.restore_original_limits()


class _ProcessPool:
    """Processes of their own, started anew when one dies."""

    together, deaths = True, 3

    def __init__(self, workers: int) -> None:
        from joblib.externals.loky.process_executor import BrokenProcessPool

        self.died: tuple[type[BaseException], ...] = (BrokenProcessPool,)
        self._workers = workers
        self._executor = self._started()

    def _started(self) -> Any:
        from joblib.externals.loky import ProcessPoolExecutor

        if hasattr(signal, "pthread_sigmask"):
            from multiprocessing import resource_tracker

            resource_tracker.ensure_running()  # its start would end `without_interrupt`
        return ProcessPoolExecutor(
            self._workers,
            initializer=_end_with,
            initargs=(os.getpid(),),
            env=dict.fromkeys(_THREAD_SETTINGS, "1"),
        )

    def submit(self, key: str, task: Task) -> Future[Outcome | None]:
        future: Future[Outcome | None]
        try:
            future = self._executor.submit(work, key, task)
        except self.died:
            self._executor = self._started()
            future = self._executor.submit(work, key, task)
        return future

    def ahead(self) -> int:
        return 2 * self._workers

    def stop(self) -> None:
        # Loky's own kill trips over tasks that are not handed out yet; a death it takes calmly.
        for process in list(self._executor._processes.values()):
            process.terminate()
        self._executor.shutdown(wait=True)


def _end_with(parent: int) -> None:
    """Let a worker end when the process that started it is no more, however that ended."""

    def watch() -> None:
        while os.getppid() == parent:
            time.sleep(0.5)
        os._exit(1)

    if hasattr(os, "getppid") and os.getppid() == parent:
        threading.Thread(target=watch, daemon=True).start()


class _DaskPool:
    """The workers of a cluster; its scheduler runs a task again elsewhere when its worker dies."""

    together, deaths = False, 1  # after those that the scheduler allows

    def __init__(self, address: str) -> None:
        try:
            import logging

            from distributed import Client
            from distributed.scheduler import KilledWorker
        except ImportError:
            raise InputError(
                "a cluster needs dask: install it with `pip install 'surae[cluster]'`"
            ) from None
        self.died: tuple[type[BaseException], ...] = (KilledWorker,)
        for name in ("distributed", "tornado"):  # our own errors say it in one line
            logging.getLogger(name).setLevel(logging.CRITICAL)
        cannot = f"no cluster at {address}"
        try:
            with without_interrupt():
                client: Any = Client
                self._client = client(address, timeout=_PATIENCE, set_as_default=False)
        except (OSError, ValueError) as error:
            text = " ".join(str(error).split())
            raise InputError(
                f"{cannot}: {text}; give the scheduler's, e.g. tcp://host:8786"
            ) from None
        try:
            self._client.wait_for_workers(1, timeout=_PATIENCE)
        except TimeoutError:
            self._client.close()
            raise ComputationError(f"{cannot} has a worker; start some and {AGAIN}") from None
        self._executor: Executor = self._client.get_executor(pure=False)
        self._ahead, self._asked = 0, -_OFTEN

    def submit(self, key: str, task: Task) -> Future[Outcome | None]:
        return self._executor.submit(work, key, task)

    def ahead(self) -> int:
        if time.monotonic() - self._asked > _OFTEN:  # workers come and go
            self._ahead = 3 * sum(self._client.nthreads().values()) + 1
            self._asked = time.monotonic()
        return self._ahead

    def stop(self) -> None:
        self._executor.shutdown(wait=False)
        self._client.close()


def started(kind: str, workers: int, address: str) -> Pool:
    """A pool of one of `KINDS`; `address` is that of a cluster's scheduler.

    Raises
    ------
    InputError
        The cluster cannot be reached, or dask is not installed.
    ComputationError
        The cluster has no worker.
    """
    if kind == "dask":
        return _DaskPool(address)
    return _ThreadPool(workers) if kind == "threads" else _ProcessPool(workers)
