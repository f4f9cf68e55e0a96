"""Where a run is, and about how long it still takes."""

from collections.abc import Callable, Mapping, Sequence
from dataclasses import dataclass


@dataclass(frozen=True, slots=True)
class Step:
    """Where a run is."""

    what: str  #: What is being done, or was.
    #: `done`, `total`: steps that are complete, and all.
    done: int
    total: int
    left_s: float | None = None  #: About how many seconds it still takes; None while nobody knows.
    outcome: str = ""  #: What came of it, in a few words; empty before the step.


StepProgress = Callable[[Step], None]


class Progress:
    """Steps that are done, and what those cost that are not."""

    def __init__(self, names: Sequence[str], listener: StepProgress) -> None:
        self._listener = listener
        self._total = len(names)
        self._done = 0
        #: Of fits that are to be made, by step.
        self._cost: dict[str, float] = {}
        #: Seconds and cost of the fits that were made now.
        self._spent = 0.0
        self._paid = 0.0

    def expect(self, costs: Mapping[str, float]) -> None:
        """What fits will cost, by step, in samples."""
        self._cost.update(costs)

    def made(self, name: str, seconds: float) -> None:
        """Learn from a fit that took so long."""
        self._spent += seconds
        self._paid += self._cost[name]

    def tell(self, step: str) -> None:
        """Say what is begun."""
        self._listener(Step(step, self._done, self._total, self._remaining_seconds()))

    def step(self, name: str, outcome: str) -> None:
        """Say that a step is complete, and what came of it."""
        self._done += 1
        self._cost.pop(name, None)
        self._listener(Step(name, self._done, self._total, self._remaining_seconds(), outcome))

    def _remaining_seconds(self) -> float | None:
        """About how long the rest takes, by how long a sample has taken."""
        if self._paid <= 0.0:
            return None
        return self._spent * sum(self._cost.values()) / self._paid
