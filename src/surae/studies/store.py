"""The file that keeps a study: its plan, and every outcome from the moment it is there."""

from collections.abc import Iterable, Iterator
from typing import Any

from surae.database import told
from surae.errors import InputError
from surae.processes import Plain
from surae.runner import Died, Ledger
from surae.studies.study import Study, Value
from surae.studies.tasks import Task, TaskOutcome, planned


class Store(Ledger):
    """A study's file, open; see `surae.runner.Ledger`."""

    _NOTHING = "no study yet; start it with `surae study run`"

    def plan(self, study: Study) -> dict[str, Task]:
        """Begin a run: keep the study's plan; its tasks without outcome, by key, in its order.

        Raises
        ------
        InputError
            The store holds another study.
        """
        tasks: dict[str, Task] = {}
        keys: dict[Task, str] = {}

        def rows() -> Iterator[tuple[str, Plain]]:
            for combination, task in planned(study):
                if task not in keys:
                    keys[task] = task.key
                    tasks[keys[task]] = task
                yield keys[task], combination

        for key in self.begin("study", study.name, study.text, rows()):
            tasks.pop(key, None)
        return tasks

    def forget_failed(self) -> int:
        """Drop the outcomes of tasks that gave no fit, so that they run again; how many."""
        without = "failed IS NOT NULL AND json_extract(value, '$.vaf') IS NULL"
        with told(self._name):
            return self._file.execute(f"DELETE FROM result WHERE {without}").rowcount

    def keep_outcomes(self, outcomes: Iterable[tuple[str, TaskOutcome]]) -> None:
        """Put outcomes on disk, all of them or none, by their tasks' keys."""
        self.add([(key, outcome.plain()) for key, outcome in outcomes])

    def text(self) -> str:
        """The STUDY.toml that the plan was made from.

        Raises
        ------
        InputError
            The store holds nothing yet.
        """
        held = self.about()
        if held is None:
            raise InputError(f"{self._name} holds {self._NOTHING}")
        return held[2]

    def rows(self) -> Iterator[tuple[dict[str, Value], TaskOutcome]]:
        """The rows of the table whose outcome is there, in its order."""
        for combination, outcome in self.results():
            died = isinstance(outcome, Died)
            yield combination, TaskOutcome("failed", outcome.message) if died else outcome

    def _reason(self, value: Any) -> str | None:
        return str(value["message"]) if value["status"] == "failed" else None

    def _read(self, value: Any) -> TaskOutcome:
        return TaskOutcome.of(value)
