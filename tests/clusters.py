"""A Dask cluster on this computer: a scheduler and two workers, of which one may be killed."""

import json
import os
import subprocess
import sys
import time
from collections.abc import Iterator, Mapping
from contextlib import ExitStack, contextmanager
from pathlib import Path

#: Seconds that anything may take on a computer that is busy with other things.
PATIENCE = 300.0
#: Address of the scheduler, and the workers' processes.
Cluster = tuple[str, list[subprocess.Popen[bytes]]]


@contextmanager
def started_cluster(folder: Path, more: Mapping[str, str]) -> Iterator[Cluster]:
    """Start it, with more variables of the environment; it ends with the context."""
    where = folder / "scheduler.json"
    path = os.pathsep.join([str(Path(__file__).parent), *filter(None, sys.path)])
    settings = {**os.environ, "PYTHONPATH": path, **more}
    host = ["--host", "127.0.0.1", "--no-dashboard"]
    alone = ["--scheduler-file", where, "--nthreads", "1", "--no-nanny", *host]
    alone += ["--local-directory", folder]
    kinds = [["scheduler", "--port", "0", "--scheduler-file", where, *host]]
    kinds += [["worker", *alone]] * 2
    with ExitStack() as stack:
        started = []
        for kind in kinds:
            process = subprocess.Popen(
                [sys.executable, "-m", "dask", *kind],
                env=settings,
                cwd=folder,
                stdout=subprocess.DEVNULL,
                stderr=subprocess.DEVNULL,
            )
            stack.callback(process.wait)
            stack.callback(process.kill)
            started.append(process)
        end = time.monotonic() + PATIENCE
        while not where.exists() or not where.read_text().strip():
            assert time.monotonic() < end
            time.sleep(0.05)
        yield json.loads(where.read_text())["address"], started[1:]
