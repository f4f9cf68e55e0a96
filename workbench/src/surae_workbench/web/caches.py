"""What is kept in memory because it is asked for again soon: least recently used goes first."""

import threading
from collections import OrderedDict
from collections.abc import Callable, Hashable
from typing import Generic, TypeVar

T = TypeVar("T")


class Cache(Generic[T]):
    """Values by key within a budget of `size`s; made once, however many ask at the same time.

    The newest is kept whatever its size.
    """

    def __init__(self, budget: float, size: Callable[[T], float] = lambda _: 1.0) -> None:
        self._budget = budget
        self._size = size
        self._kept: OrderedDict[Hashable, T] = OrderedDict()
        self._making: dict[Hashable, threading.Lock] = {}
        self._lock = threading.Lock()

    def get(self, key: Hashable, make: Callable[[], T]) -> T:
        """The value, made where it is missing."""
        with self._lock:
            if key in self._kept:
                self._kept.move_to_end(key)
                return self._kept[key]
            making = self._making.setdefault(key, threading.Lock())
        with making:
            with self._lock:
                if key in self._kept:
                    return self._kept[key]
            value = make()
            with self._lock:
                self._kept[key] = value
                self._making.pop(key, None)
                while len(self._kept) > 1 and sum(map(self._size, self._kept.values())) > (
                    self._budget
                ):
                    self._kept.popitem(last=False)
            return value
