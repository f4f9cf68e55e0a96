"""Options of commands that make many calls: where they are made."""

import click

from surae.base.errors import InputError
from surae.base.threads import cores
from surae_cohort.runner import Engine

DASK = click.option("--dask", metavar="ADDRESS",
                    help="Scheduler of a Dask cluster to run on instead.")  # fmt: skip


def engine_of(dask: str | None, workers: int | None) -> Engine:
    """Where the work is done: a Dask cluster, or so many processes."""
    if dask is None:
        count = workers or cores()
        return Engine("processes" if count > 1 else "threads", count)
    if workers is not None:
        raise InputError("--dask brings workers of its own; give it without --workers")
    return Engine("dask", address=dask)
