"""Options of commands that make many calls: where they are made."""

import click

DASK = click.option(
    "--dask", metavar="ADDRESS", help="Scheduler of a Dask cluster to run on instead."
)
