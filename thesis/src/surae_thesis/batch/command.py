"""`surae batch`."""

import json
import time
from dataclasses import dataclass
from functools import partial
from pathlib import Path
from typing import TYPE_CHECKING, Any

import click

from surae import api
from surae.base.errors import ComputationError, InputError
from surae.base.files import shown
from surae.cli.option_records import as_record
from surae.cli.options import DASK, MAPPING, corrections, settings_options, workers_option
from surae.cli.paths import check_outputs
from surae.cli.progress import StoppedError, compilation_notice, work
from surae.cli.screen import show_line, show_table

if TYPE_CHECKING:
    from surae_thesis.batch import table

#: The models of the thesis.
_MODELS = "1.0,2.0,2.1,2.2"


@dataclass(frozen=True, slots=True)
class Fits:
    """What is fitted."""

    models: str
    fixed_set: tuple[str, ...]
    only: str | None
    sessions: bool

    def __post_init__(self) -> None:
        if self.only and self.sessions:
            raise InputError(f"--only {self.only} is of single recordings; leave out --sessions")


@dataclass(frozen=True, slots=True)
class Places:
    """Where what comes of it goes."""

    store: str
    output: str
    keep: str | None

    @property
    def fits(self) -> str:
        """Where every FIT.json goes."""
        return self.keep or str(Path(self.output, "fits"))


@dataclass(frozen=True, slots=True)
class Cores:
    """What the fits run on."""

    workers: int | None
    dask: str | None  #: A scheduler's address.


@click.command("batch")
@click.argument("recordings", metavar="FILES|DIR…", nargs=-1, required=True)
@MAPPING
@corrections
@as_record(
    "fits",
    Fits,
    click.option(
        "--models",
        default=_MODELS,
        show_default=True,
        metavar="LIST",
        help="By the thesis's number or by name, auto too.",
    ),
    click.option(
        "--fixed-set",
        multiple=True,
        metavar="NAME=VALUE,…",
        help="Fit again with these fixed, as beta=1,m=2; may be repeated.",
    ),
    click.option(
        "--only",
        type=click.Choice(["spectra", "snsem"]),
        help="Spectra of repetitions, without a fit; or fits and snSEM, without predictions.",
    ),
    click.option(
        "--sessions",
        is_flag=True,
        help="Fit all recordings of a subject as one session: each, and all together.",
    ),
)
@click.option(
    "--name",
    metavar="PATTERN",
    default="",
    help="How paths are named, as {subject}/{protocol}-{repetition}.  "
    "[default: subject first, repetition last, between / or _]",
)
@settings_options(*api.FIT_RECORDS[:-1])
@as_record(
    "places",
    Places,
    click.option("--store", required=True, metavar="B.db", help="Keeps every finished fit."),
    click.option("--output", required=True, metavar="OUT/", help="Folder of tables and page."),
    click.option(
        "--keep",
        metavar="FITS/|URL",
        help="Where every FIT.json goes, as s3://bucket/fits too.  [default: OUT/fits]",
    ),
)
@as_record("cores", Cores, workers_option("Fits", many="one for each core"), DASK)
def command(
    recordings: tuple[str, ...],
    mapping: str | None,
    fits: Fits,
    name: str,
    places: Places,
    cores: Cores,
    options: dict[str, Any],
    corrections: dict[str, Any],
) -> None:
    """Fit every recording of a cohort by several models, and let each predict its subject's others.

    A file's name says whose it is, which protocol and which repetition, as S01_holds_2.mat or
    S01/holds_2.mat. The run may be stopped in any way and at any time: run it again and it goes on.
    OUT/ then holds table.csv with a row for each fit, its parameters and measures, relaxed.csv with
    the relaxed curve of each recording, both as Parquet too where pyarrow is there, every FIT.json,
    a summary by model and protocol, and a page with the thesis's figures of this cohort.
    """
    from surae_thesis.batch import files, plan, table
    from surae_thesis.batch.places import check_place
    from surae_thesis.section import make_folder

    if "model" in options:
        raise InputError("--model names one; give --models, as --models 1.0,2.1,auto")
    chosen = [model.strip() for model in fits.models.split(",") if model.strip()]
    settings = table.settings_of(chosen, fits.fixed_set, options)
    engine = api.engine_of(cores.dask, cores.workers)
    make_folder(Path(places.output))
    check_outputs({"--store": places.store}, [])
    trials = files.find_trials(recordings, mapping, name)
    read = {"mapping": mapping, "corrections": json.dumps(corrections, sort_keys=True)}
    place = check_place(places.fits)
    only, sessions = fits.only or "", fits.sessions
    wanted = {} if only == "spectra" else settings
    batch = plan.Batch(trials, wanted, read, place=place, sessions=sessions, only=only)
    subjects, protocols = ({getattr(t, of) for t in trials} for of in ("subject", "protocol"))
    count = len(subjects if sessions else trials) * len(batch.settings)
    show_line(
        f"{len(trials)} recordings of {len(subjects)} subjects, protocols: "
        f"{', '.join(sorted(protocols))}; {count} {'sessions' if sessions else 'fits'}"
    )
    begin = time.perf_counter()
    with table.BatchStore(places.store, write=True) as opened:
        try:
            with work() as progress, compilation_notice():
                now = table.run_batch(batch, opened, engine, partial(progress.parts, "fits"))
        except KeyboardInterrupt:
            status = opened.status()
            raise StoppedError(
                f"stopped by the user; {status.done:,} of {status.calls:,} are kept: run the same "
                "command to go on"
            ) from None
        show_line(f"all there; {now:,} computed now in {time.perf_counter() - begin:.0f} s")
        worked = _written(opened, Path(places.output), sessions=sessions, only=only)
    if not worked:
        raise ComputationError("every fit failed, so the batch says nothing; the tables say why")


def _written(opened: "table.BatchStore", output: Path, *, sessions: bool, only: str) -> bool:
    """Write all tables and the page; whether any fit did not fail."""
    from surae_thesis.batch import pieces, table
    from surae_thesis.batch.answers import answers
    from surae_thesis.writers import write_result

    columns = table.fit_columns(opened.outcomes())
    pieces.write_pieces(
        output, "table", columns, lambda: table.fit_rows(opened.outcomes(), columns)
    )
    worked = only == "spectra"
    if not worked:
        failed = columns.index("status")
        worked = any(row[failed] != "failed" for row in table.fit_rows(opened.outcomes(), columns))
    if not sessions:
        pieces.write_pieces(
            output, "relaxed", table.RELAXED, lambda: table.relaxed_rows(opened.outcomes())
        )
        result = answers(list(opened.outcomes()))
        summary = result.tables[0]
        if only == "spectra":
            summary = next(t for t in result.tables if t.name == "batch-repetitions")
        show_table(summary.columns[:7], [tuple(map(_cell, row[:7])) for row in summary.rows])
        page = write_result(output, "batch", "A cohort, fitted", result)
        show_line(f"page: {shown(page)}")
    show_line(f"table: {shown(output / 'table.csv')}")
    return worked


def _cell(value: object) -> str:
    """A number of the summary, in a few digits."""
    if value is None:
        return "–"
    return f"{value:.1f}" if isinstance(value, float) else str(value)
