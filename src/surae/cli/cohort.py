"""`surae cohort`."""

from datetime import datetime
from functools import partial
from typing import Any

import click

from surae import api
from surae.base.threads import cores
from surae.cli.options import DASK, settings_options, workers_option
from surae.cli.paths import check_outputs
from surae.cli.progress import compilation_notice, work
from surae.cli.screen import show_answer, show_files


@click.command("cohort")
@click.argument("table", metavar="COHORT.csv")
@settings_options(api.CohortSettings)
@workers_option("Legs")
@DASK
@click.option("--output", metavar="C.json", help="Write the cohort.")
@click.option("--report", metavar="C.html", help="Write a page with its tables and figures.")
def command(
    table: str,
    workers: int | None,
    dask: str | None,
    output: str | None,
    report: str | None,
    options: dict[str, Any],
) -> None:
    """Compare groups of legs, sessions of each leg, and every leg with its group.

    COHORT.csv has the columns fit (a FIT.json or the folder of a session) and subject, and as far
    as there are side, group and session; other columns are clinical scales. Every leg counts as
    much as its interval allows; legs left out, and why, are listed.
    """
    check_outputs({"--output": output, "--report": report}, [table], spare_fits=True)

    api.check_report(report)
    with work() as progress, compilation_notice():
        cohort = api.cohort(
            table,
            **options,
            dask=dask,
            workers=workers if dask else workers or cores(),
            progress=partial(progress.parts, "legs"),
        )

    if output is not None:
        cohort.save(output)
    show_answer(cohort.as_table())
    if report is not None:
        api.cohort_report(cohort, created=datetime.now().astimezone()).write(report)
    show_files({"cohort": output, "report": report})
