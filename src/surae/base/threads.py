"""Processors, and one thread for small products: more slow them down, and change the last bits."""

import math
import os
from collections.abc import Iterator
from contextlib import contextmanager, suppress
from functools import cache
from pathlib import Path
from typing import TYPE_CHECKING

if TYPE_CHECKING:
    from threadpoolctl import ThreadpoolController


@contextmanager
def one_blas_thread() -> Iterator[None]:
    """Hold the linear algebra libraries to one thread."""
    with _controller().limit(limits=1, user_api="blas"):
        yield


@cache
def _controller() -> "ThreadpoolController":
    """The libraries of this process; looking for them takes longer than a small fit's step."""
    import scipy.linalg  # noqa: F401  # so that its library is found too
    from threadpoolctl import ThreadpoolController

    return ThreadpoolController()


def cores() -> int:
    """Processors that this program may use."""
    affinity = getattr(os, "sched_getaffinity", None)
    count = os.cpu_count() or 1 if affinity is None else len(affinity(0))
    with suppress(OSError, ValueError):  # a container's share of them
        quota, period = Path("/sys/fs/cgroup/cpu.max").read_text(encoding="ascii").split()
        count = min(count, math.ceil(int(quota) / int(period)))
    return max(count, 1)
