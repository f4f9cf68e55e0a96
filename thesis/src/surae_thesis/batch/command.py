"""`surae batch`."""

import json
import time
from functools import partial
from pathlib import Path
from typing import Any

import click

from surae import api
from surae.base.errors import ComputationError, InputError
from surae.base.files import shown, write_table
from surae.cli.options import DASK, MAPPING, corrections, settings_options, workers_option
from surae.cli.paths import check_outputs
from surae.cli.progress import StoppedError, compilation_notice, work
from surae.cli.screen import show_line, show_table

#: The models of the thesis.
_MODELS = "1.0,2.0,2.1,2.2"


@click.command("batch")
@click.argument("recordings", metavar="FILES|DIR…", nargs=-1, required=True)
@MAPPING
@corrections
@click.option(
    "--models",
    default=_MODELS,
    show_default=True,
    metavar="LIST",
    help="By the thesis's number or by name, auto too.",
)
@click.option(
    "--fixed-set",
    multiple=True,
    metavar="NAME=VALUE,…",
    help="Fit again with these fixed, as beta=1,m=2; may be repeated.",
)
@click.option(
    "--name",
    metavar="PATTERN",
    default="",
    help="How paths are named, as {subject}/{protocol}-{repetition}.  "
    "[default: subject first, repetition last, between / or _]",
)
@click.option(
    "--only",
    type=click.Choice(["spectra", "snsem"]),
    help="Spectra of repetitions, without a fit; or fits and snSEM, without predictions.",
)
@settings_options(*api.FIT_RECORDS[:-1])
@click.option("--store", required=True, metavar="B.db", help="Keeps every finished fit.")
@click.option("--output", required=True, metavar="OUT/", help="Folder of tables and page.")
@workers_option("Fits", many="one for each core")
@DASK
def command(
    recordings: tuple[str, ...],
    mapping: str | None,
    models: str,
    fixed_set: tuple[str, ...],
    name: str,
    only: str | None,
    store: str,
    output: str,
    workers: int | None,
    dask: str | None,
    options: dict[str, Any],
    corrections: dict[str, Any],
) -> None:
    """Fit every recording of a cohort by several models, and let each predict its subject's others.

    A file's name says whose it is, which protocol and which repetition, as S01_holds_2.mat or
    S01/holds_2.mat. The run may be stopped in any way and at any time: run it again and it goes on.
    OUT/ then holds table.csv with a row for each fit, a summary by model and protocol, and a page
    with the thesis's figures of this cohort.
    """
    from surae_thesis.batch import files, table
    from surae_thesis.batch.answers import answers
    from surae_thesis.section import make_folder
    from surae_thesis.writers import write_result

    if "model" in options:
        raise InputError("--model names one; give --models, as --models 1.0,2.1,auto")
    chosen = [model.strip() for model in models.split(",") if model.strip()]
    settings = table.settings_of(chosen, fixed_set, options)
    engine = api.engine_of(dask, workers)
    make_folder(Path(output))
    check_outputs({"--store": store}, [])
    found = files.find_trials(recordings, mapping, name)
    read = {"mapping": mapping, "corrections": json.dumps(corrections, sort_keys=True)}
    batch = table.Batch(found, {} if only == "spectra" else settings, read, only or "")
    subjects, protocols = ({getattr(t, of) for t in found} for of in ("subject", "protocol"))
    show_line(
        f"{len(found)} recordings of {len(subjects)} subjects, protocols: "
        f"{', '.join(sorted(protocols))}; {len(found) * len(batch.settings)} fits"
    )
    begin = time.perf_counter()
    with table.BatchStore(store, write=True) as opened:
        try:
            with work() as progress, compilation_notice():
                now = table.run_batch(batch, opened, engine, partial(progress.parts, "fits"))
        except KeyboardInterrupt:
            status = opened.status()
            raise StoppedError(
                f"stopped by the user; {status.done:,} of {status.calls:,} are kept: run the same "
                "command to go on"
            ) from None
        outcomes = opened.outcomes()
    show_line(f"all there; {now:,} computed now in {time.perf_counter() - begin:.0f} s")
    columns, rows = table.table(outcomes)
    every = [dict(zip(columns, row, strict=True)) for row in rows]
    write_table(Path(output) / "table.csv", columns, every)
    result = answers(outcomes)
    summary = result.tables[0]
    show_table(
        summary.columns[:7],
        [
            tuple(
                "–" if c is None else f"{c:.1f}" if isinstance(c, float) else str(c) for c in r[:7]
            )
            for r in summary.rows
        ],
    )
    show_line(f"page: {shown(write_result(Path(output), 'batch', 'A cohort, fitted', result))}")
    show_line(f"table: {shown(Path(output) / 'table.csv')}")
    if only == "spectra":
        repeated = next(each for each in result.tables if each.name == "batch-repetitions")
        show_table(repeated.columns, [tuple(map(str, row)) for row in repeated.rows])
    elif all(fit.get("failed") for label, fit in outcomes if label["kind"] == "fit"):
        raise ComputationError("every fit failed, so the batch says nothing; the page has reasons")
