"""Many legs together: groups, their differences and changes, and each leg among them."""

import math
from dataclasses import replace
from typing import Any

from surae.base.files import PathLike
from surae.base.progress import Progress
from surae.base.setting import takes
from surae.cohorts.members import measured, read_table, refitted
from surae.cohorts.pooled import borrowed, ends_of, pool
from surae.cohorts.result import Cohort
from surae.cohorts.settings import CohortSettings
from surae.processes.runner import engine_of


@takes(CohortSettings)
def cohort(
    table: PathLike,
    *,
    workers: int | None = None,
    dask: str | None = None,
    progress: Progress | None = None,
    **keywords: Any,
) -> Cohort:
    """Groups of legs, their differences and changes, and each leg among them.

    Parameters
    ----------
    table : path
        A CSV with the columns ``fit`` (a FIT.json or the folder of a session, from where the table
        is), ``subject``, and as far as there are ``side``, ``group``, ``session``; every other
        column is a clinical scale.
    workers : int, optional
        Processes at a time, by default one.
    dask : str, optional
        Address of the scheduler of a Dask cluster to run on instead.
    progress : callable, optional
        Called with legs done and all legs.
    {settings}

    Returns
    -------
    Cohort
        A fit that cannot be read leaves its leg out, and its reason is kept.

    Raises
    ------
    InputError
        The table is damaged, has no fit that can be read, or a question names nothing that is
        compared.

    Examples
    --------
    >>> surae.cohort("legs.csv").save("cohort.json")
    """
    settings = CohortSettings(**keywords)
    where = engine_of(dask, workers if dask else workers or 1)
    rows = read_table(table)
    members = measured(rows, settings.angles, where, progress=progress)
    reached = ends_of(members)
    end = math.inf
    if reached is not None:  # legs are compared over what all of them reached
        end = reached[0]
        members = measured(rows, settings.angles, where, progress=progress, end=end)
    pooled = replace(pool(members, settings.question), reached=reached)
    if not settings.refit:
        return pooled
    again, rounds = refitted(rows, members, settings.angles, where, progress, end)
    return borrowed(pooled, again, rounds)
