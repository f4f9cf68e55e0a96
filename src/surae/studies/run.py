"""Run a study: whatever of its plan has no outcome yet is computed and kept."""

from collections.abc import Callable, Generator, Mapping
from contextlib import closing
from dataclasses import dataclass
from time import perf_counter

from surae.processes import Plain
from surae.runner import Died, Engine, results
from surae.studies.store import Store
from surae.studies.study import Study
from surae.studies.tasks import Outcome, Task, run_task

#: Called after every fit that is kept: how many of the study are, and how many there are.
Progress = Callable[[int, int], None]


@dataclass(frozen=True, slots=True)
class Finished:
    """What a run did.

    Attributes
    ----------
    rows, fits : int
        Rows of the table, and the distinct fits behind them: all of them are kept.
    computed : int
        Fits that this run computed.
    seconds : float
        Its wall time.
    """

    rows: int
    fits: int
    computed: int
    seconds: float


def run(
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
        What is asked for.
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
    status = store.status()
    store.begin()
    how, done = "stopped by an error", status.done
    try:
        if progress is not None:
            progress(done, status.fits)
        for batch in _computed(tasks, engine or Engine()):
            store.add(batch)
            done += len(batch)
            if progress is not None:
                progress(done, status.fits)
        how = "finished"
    except KeyboardInterrupt:
        how = "stopped by the user"
        raise
    finally:
        store.end(how)
    return Finished(status.rows, status.fits, len(tasks), perf_counter() - begin)


def _computed(tasks: Mapping[str, Task], engine: Engine) -> Generator[list[tuple[str, Outcome]]]:
    """The outcomes of tasks as they come, and first one of each model where none is compiled yet.

    The compiler works once then, and where its notice is seen, not in every worker.
    """
    from surae.model.jit import cache_folder

    rest = dict(tasks)
    if engine.kind != "dask" and rest and not any(cache_folder().rglob("*.nbi")):
        models: dict[str, str] = {}
        for key, task in tasks.items():
            models.setdefault(task.model, key)
        for key in models.values():
            yield [(key, run_task(rest.pop(key)))]
    if not rest:
        return
    calls = {key: task.as_call() for key, task in rest.items()}
    with closing(results("surae.studies.tasks:outcome_of", calls, engine)) as batches:
        for batch in batches:
            yield [(key, _outcome(value)) for key, value in batch]


def _outcome(value: Plain | Died) -> Outcome:
    return Outcome("failed", value.message) if isinstance(value, Died) else Outcome.of(value)
