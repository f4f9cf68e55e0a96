"""One thread for small products: more only slow them down, and change the last bits."""

from collections.abc import Iterator
from contextlib import contextmanager
from functools import cache
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
