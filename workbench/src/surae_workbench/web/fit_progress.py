"""A fit as it goes on: the parameters at every better point, not too often."""

import time
from typing import Any

from surae import api
from surae.base.units import FloatArray
from surae.processes import tell
from surae_workbench.web.curves import plain

#: News of a fit come at most this often [s].
_EVERY = 0.1


class FitProgress:
    """Tells how a fit goes on; made for `follow` and `progress` of `surae.fit`."""

    def __init__(self, starts: int) -> None:
        self._news: dict[str, Any] = {"done": 0, "total": starts, "iteration": 0}
        self._last = 0.0

    def start(self, done: int, starts: int, best: float) -> None:
        """A start is done."""
        del best
        self._news |= {"done": done, "total": starts}
        tell(self._news)

    def point(self, spec: api.ModelSpec, values: FloatArray, sse: float) -> None:
        """A better point is found."""
        del sse
        self._news["iteration"] += 1
        if time.monotonic() - self._last < _EVERY:
            return
        at = dict(zip(spec.names, plain(values), strict=True))
        self._news |= {"model": spec.name, "values": at}
        tell(self._news)
        self._last = time.monotonic()
