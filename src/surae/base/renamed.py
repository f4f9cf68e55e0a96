"""Words that were others before: they are still taken, with a warning."""

import warnings
from collections.abc import Callable
from functools import wraps
from typing import Any, TypeVar

W = TypeVar("W", bound=Callable[..., Any])


def renamed(**words: str) -> Callable[[W], W]:
    """Have a function, or a record, take keywords by the names that they had, until surae 0.4."""

    def decorate(what: W) -> W:
        called: Callable[..., Any] = vars(what)["__init__"] if isinstance(what, type) else what

        @wraps(called)
        def either(*args: Any, **keywords: Any) -> Any:
            for old in words.keys() & keywords.keys():
                now = words[old]
                warnings.warn(f"{old} is called {now} now", DeprecationWarning, stacklevel=2)
                keywords[now] = keywords.pop(old)
            return called(*args, **keywords)

        if not isinstance(what, type):
            return either  # type: ignore[return-value]
        type.__setattr__(what, "__init__", either)
        return what

    return decorate
