"""`surae study`: run, status, export."""

from collections.abc import Mapping
from functools import partial

import click

from surae import api
from surae.base.errors import ComputationError, InputError
from surae.base.files import shown
from surae.cli.options import DASK, workers_option
from surae.cli.paths import check_outputs
from surae.cli.progress import StoppedError, compilation_notice, work
from surae.cli.screen import show_line

#: Reasons of failures that `status` lists.
_REASONS = 5


@click.group("study")
def command() -> None:
    """Fit virtual trials over crossed factors: parameters known, thousands of fits, resumable."""


@command.command("run", short_help="Run a study, or go on with it.")
@click.argument("study", metavar="STUDY.toml")
@click.option("--store", required=True, metavar="S.db", help="Keeps every finished fit.")
@workers_option("Fits", many="one for each core")
@DASK
@click.option("--retry", is_flag=True, help="Try again what gave no fit in an earlier run.")
def run_command(study: str, store: str, workers: int | None, dask: str | None, retry: bool) -> None:
    """Run a study, or go on with it: what the store holds is not computed again.

    STUDY.toml gives factors, each a value or a list of values; all combinations are fitted. The
    run may be stopped in any way and at any time: run it again and it goes on.
    """
    engine = api.engine_of(dask, workers)
    check_outputs({"--store": store}, [study])

    plan = api.read_study(study)

    with api.Store(store, write=True) as opened:
        try:
            with work() as progress, compilation_notice():
                progress.describe(f"planning {plan.size:,} fits")
                done = api.run_study(
                    plan,
                    opened,
                    engine=engine,
                    progress=partial(progress.parts, "fits"),
                    retry=retry,
                )
        except KeyboardInterrupt:
            try:
                now = opened.status()
            except InputError:  # it was still planning
                raise KeyboardInterrupt from None
            raise StoppedError(
                f"stopped by the user; {now.done:,} of {now.calls:,} fits are kept: run the same "
                "command to go on"
            ) from None
        reasons = opened.status().reasons
    rate = f", {done.computed / done.seconds:.1f} a second" if done.computed else ""
    show_line(
        f"{plan.name}: {_counted(done.fits, done.rows)}, all there; "
        f"{done.computed:,} computed now in {done.seconds:.1f} s{rate}"
    )
    _show_reasons(reasons)
    if done.fits and sum(reasons.values()) >= done.fits:
        raise ComputationError("every fit of the study failed, so it says nothing; see the reasons")
    show_line(f"table: surae study export {shown(store)} --output TABLE.csv")


@command.command("status", short_help="Show how far it is, also while it runs.")
@click.argument("store", metavar="S.db")
def status_command(store: str) -> None:
    """Show how far a study is, also while it runs."""
    with api.Store(store) as opened:
        now = opened.status()
    part = f" ({100 * now.done / now.calls:.0f} %)" if now.calls else ""
    show_line(f"{now.name}: {now.done:,} of {_counted(now.calls, now.rows)} done{part}")
    if now.running is not None:
        here = now.running
        rate = here.added / here.seconds if here.seconds > 0 else 0.0
        left = f", about {_span((now.calls - now.done) / rate)} left" if rate else ""
        show_line(
            f"running for {_span(here.seconds)} (process {here.process} on {here.host}): "
            f"{rate:.1f} fits a second{left}"
        )
    elif now.last:
        show_line(f"last run: {now.last}")
    _show_reasons(now.reasons)


@command.command("export", short_help="Write its table.")
@click.argument("store", metavar="S.db")
@click.option("--output", required=True, metavar="TABLE.csv")
def export_command(store: str, output: str) -> None:
    """Write the table of a study: a row for each combination, as far as they are there."""
    check_outputs({"--output": output}, [store, f"{store}-wal", f"{store}-shm", f"{store}.lock"])

    with api.Store(store) as opened:
        rows, hash_ = api.export_study(opened, output)
        all_rows = opened.status().rows
    show_line(f"table: {shown(output)}, {rows:,} rows; without its seconds it has the hash {hash_}")
    if rows < all_rows:
        click.echo(
            f"surae: {all_rows - rows:,} of {all_rows:,} rows are left out: they are not done yet, "
            "or damaged",
            err=True,
        )


def _counted(fits: int, rows: int) -> str:
    """Number of fits, and of the rows where they are more."""
    same = f" (for {rows:,} combinations)" if rows != fits else ""
    return f"{fits:,} fits{same}"


def _show_reasons(reasons: Mapping[str, int]) -> None:
    """The most frequent reasons of failures."""
    if not reasons:
        return
    show_line(f"{sum(reasons.values()):,} failed:")
    for text, number in list(reasons.items())[:_REASONS]:
        show_line(f"  {number:,} × {text}")
    if len(reasons) > _REASONS:
        show_line(f"  … and {len(reasons) - _REASONS:,} other reasons")


def _span(seconds: float) -> str:
    """A time in h:mm:ss."""
    whole = round(seconds)
    return f"{whole // 3600}:{whole % 3600 // 60:02d}:{whole % 60:02d}"
