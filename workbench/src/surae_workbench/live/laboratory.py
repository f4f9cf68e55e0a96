"""The simulated laboratory as its user holds it: a child process that hears words over LSL."""

import json
import threading
from typing import Any

from surae.base.errors import ComputationError
from surae.processes import Child, End
from surae_workbench.live.lsl import outlet
from surae_workbench.live.rehearsal import CONTROL


class Laboratory:
    """A running `surae_workbench.live.rehearsal` with the leg of a seed."""

    def __init__(self, seed: int) -> None:
        self._words: Any = outlet("surae control", "Control", [], [], 0.0, CONTROL)
        self._child = Child(calls=None)
        self._told = threading.Condition()
        self._hears = False
        #: Words by number that it has not confirmed: what a lost connection takes is said again.
        self._said, self._unheard = 0, dict[int, str]()
        self._wanted: int | None = None
        self._loaded: int | None = None
        self._end: End | None = None
        threading.Thread(target=self._run, args=({"seed": seed},), daemon=True).start()

    @property
    def ready(self) -> bool:
        """Whether it hears, and has what was loaded last."""
        return self._hears and (self._wanted is None or self._loaded == self._wanted)

    def load(self, path: str, trial: int) -> None:
        """Have it go to where a target begins, and compute what the leg will do."""
        with self._told:
            self._wanted = trial
            self._loaded = None
            self._say("load", path=path, trial=trial)

    def wait(self, patience: float) -> None:
        """Wait until it streams, hears, and has what was loaded last."""
        with self._told:
            self._told.wait_for(lambda: self.ready or self._end is not None, patience)
            if not self.ready:
                why = self._end.message if self._end is not None else "it does not answer"
                raise ComputationError(f"the simulated laboratory: {why}; try again")

    def start(self, at: float) -> None:
        """Have the trial begin at a time of LSL's clock [s]."""
        self._say("start", at=at)

    def stop(self) -> None:
        """Have the trial end."""
        self._say("stop")

    def fault(self, **fault: Any) -> None:
        """Have something go wrong, see `rehearsal.FAULTS`; ``kind="none"`` mends all."""
        self._say("fault", **fault)

    def close(self) -> None:
        """End it, and the stream of words."""
        with self._told:
            self._words = None
        self._child.close()

    def _say(self, word: str, **more: Any) -> None:
        with self._told:
            self._said += 1
            self._unheard[self._said] = json.dumps({"do": word, "number": self._said, **more})
            self._push(self._unheard[self._said])

    def _push(self, word: str) -> None:
        if self._words is not None:
            self._words.push_sample([word])

    def _run(self, arguments: dict[str, Any]) -> None:
        end = self._child.call("surae_workbench.live.rehearsal:run", arguments, hear=self._hear)
        with self._told:
            self._end = end
            self._told.notify_all()

    def _hear(self, message: Any) -> None:
        with self._told:
            if "hears" in message:
                self._hears = True
                for word in self._unheard.values():
                    self._push(word)
            self._unheard.pop(message.get("heard", 0), None)
            self._loaded = message.get("loaded", self._loaded)
            self._told.notify_all()
