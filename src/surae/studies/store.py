"""A study's run, the file that keeps every outcome from when it is there, and its table."""

import hashlib
from collections.abc import Generator, Iterator, Mapping
from dataclasses import asdict, dataclass
from time import perf_counter
from typing import Any

from surae.base.errors import InputError
from surae.base.files import PathLike, csv_row, write_table
from surae.base.progress import Progress
from surae.base.records import from_plain, to_plain
from surae.model import MODELS
from surae.processes import Plain
from surae.processes.ledger import Ledger
from surae.processes.runner import Batch, Died, Engine, results
from surae.studies.study import Study, Value, parse_study
from surae.studies.tasks import FitTask, TaskOutcome, run_task, task_of


class Store(Ledger):
    """A study's file, open; see `surae.processes.ledger.Ledger`."""

    _NOTHING = "no study yet; start it with `surae study run`"

    def plan(self, study: Study) -> dict[str, FitTask]:
        """Begin a run: keep the study's plan; its tasks without outcome, by key, in its order.

        Raises
        ------
        InputError
            The store holds another study.
        """
        keys: dict[FitTask, str] = {}

        def rows() -> Iterator[tuple[str, Plain]]:
            for combination in study.combinations():
                task = task_of(combination)
                if task not in keys:
                    keys[task] = task.key
                yield keys[task], combination

        done = self.begin("study", study.name, study.text, rows())
        return {key: task for task, key in keys.items() if key not in done}

    def forget_failed(self) -> int:
        """Drop the outcomes of tasks that gave no fit, so that they run again; how many."""
        without = "failed IS NOT NULL AND json_extract(value, '$.vaf') IS NULL"
        with self._errors():
            return self._file.execute(f"DELETE FROM result WHERE {without}").rowcount

    def text(self) -> str:
        """The STUDY.toml that the plan was made from.

        Raises
        ------
        InputError
            The store holds nothing yet.
        """
        about = self.about()
        if about is None:
            raise InputError(f"{self._name} holds {self._NOTHING}")
        return about[2]

    def rows(self) -> Iterator[tuple[dict[str, Value], TaskOutcome]]:
        """The rows of the table whose outcome is there, in its order."""
        for combination, outcome in self.results():
            died = isinstance(outcome, Died)
            yield combination, TaskOutcome("failed", outcome.message) if died else outcome

    def _reason(self, value: Any) -> str | None:
        return str(value["message"]) if value["status"] == "failed" else None

    def _read(self, value: Any) -> TaskOutcome:
        return from_plain(TaskOutcome, value)


#: A cell: None where there is no number.
StudyValue = Value | None


def study_columns(study: Study) -> list[str]:
    """Names of the columns: factors, goodness, three of every parameter estimated, seconds."""
    models = [MODELS[str(name)] for name in study.factors["model"]]
    names = dict.fromkeys(p.name for m in MODELS.values() for p in m.parameters)
    estimated = [name for name in names if any(name in m.free for m in models)]
    parameters = [name + end for name in estimated for end in ("", "_sem", "_true")]
    return [*study.factors, "status", "vaf", "ipde", *parameters, "seconds"]


def study_table(store: Store) -> Iterator[dict[str, StudyValue]]:
    """The rows whose fit is there, in the order of the plan, by column."""
    study = parse_study(store.text())
    names = study_columns(study)
    for factors, outcome in store.rows():
        row: dict[str, StudyValue] = dict.fromkeys(names)
        row |= factors | {"status": outcome.status, "vaf": outcome.vaf, "ipde": outcome.ipde}
        for estimate in outcome.estimates:
            name = estimate.name
            row[name], row[f"{name}_sem"] = estimate.value, estimate.sem
            row[f"{name}_true"] = estimate.true
        row["seconds"] = outcome.seconds
        yield row


def export_study(store: Store, path: PathLike) -> tuple[int, str]:
    """Write the table; see `surae.base.files.write_table`.

    Returns
    -------
    tuple of int and str
        The number of rows, and their hash without the seconds: equal results have equal hashes,
        however long they took.

    Raises
    ------
    InputError
        The file cannot be written.
    """
    names = study_columns(parse_study(store.text()))
    rows = list(study_table(store))
    unhurried = [csv_row(names[:-1]), *(csv_row(row[name] for name in names[:-1]) for row in rows)]
    digest = hashlib.sha256("".join(unhurried).encode()).hexdigest()[:16]
    write_table(path, names, rows)
    return len(rows), digest


@dataclass(frozen=True, slots=True)
class Finished:
    """What a run did."""

    #: `rows`, `fits`: rows of the table, and the distinct fits behind them: all of them are kept.
    rows: int
    fits: int
    computed: int  #: Fits that this run computed.
    seconds: float  #: Its wall time.


def run_study(
    study: Study,
    store: Store,
    *,
    engine: Engine | None = None,
    progress: Progress | None = None,
    retry: bool = False,
) -> Finished:
    """Compute what a store lacks of a study.

    Parameters
    ----------
    study : Study
        The study.
    store : Store
        Open to write; keeps every outcome from the moment it is there.
    engine : Engine, optional
        Where the fits run; by default in one process.
    progress : callable, optional
        Called whenever outcomes have been kept.
    retry : bool
        Try tasks again that gave no fit in an earlier run.

    Raises
    ------
    InputError, ComputationError
        The store or the engine cannot be used any longer; what is finished is kept.
    """
    begin = perf_counter()
    if retry:
        store.forget_failed()
    tasks = store.plan(study)
    store.keep(_computed(tasks, engine or Engine()), progress)
    status = store.status()
    return Finished(status.rows, status.calls, len(tasks), perf_counter() - begin)


def _computed(tasks: Mapping[str, FitTask], engine: Engine) -> Generator[Batch]:
    """Outcomes as they come, first one of each model where the compiler has yet to work."""
    from surae.model.kernel_cache import cache_folder

    rest = dict(tasks)
    folder = cache_folder()
    compiled = folder is not None and (folder / "all").exists()
    if engine.kind != "dask" and rest and not compiled:
        models: dict[str, str] = {}
        for key, task in tasks.items():
            models.setdefault(task.model, key)
        for key in models.values():
            yield [(key, to_plain(run_task(rest.pop(key))))]
    if rest:
        calls = {key: {"key": key, "settings": asdict(task)} for key, task in rest.items()}
        yield from results("surae.studies.tasks:outcome_of", calls, engine)
