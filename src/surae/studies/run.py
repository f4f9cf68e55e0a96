"""Run a study: whatever of its plan has no outcome yet is computed and kept."""

from collections.abc import Generator, Mapping
from dataclasses import asdict, dataclass
from time import perf_counter

from surae.progress import Progress
from surae.runner import Batch, Engine, results
from surae.studies.store import Store
from surae.studies.study import Study
from surae.studies.tasks import FitTask, run_task


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
            yield [(key, run_task(rest.pop(key)).plain())]
    if rest:
        calls = {key: {"key": key, "settings": asdict(task)} for key, task in rest.items()}
        yield from results("surae.studies.tasks:outcome_of", calls, engine)
