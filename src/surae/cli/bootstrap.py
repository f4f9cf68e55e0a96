"""`surae bootstrap`."""

from functools import partial
from typing import Any

import click

from surae import api
from surae.cli.options import settings_options
from surae.cli.paths import check_outputs
from surae.cli.progress import StoppedError, compilation_notice, work
from surae.cli.screen import Columns, show_files, show_line, show_table
from surae.files import shown
from surae.requests import BootstrapSettings


@click.command("bootstrap")
@click.argument("fitted", metavar="FIT.json")
@settings_options(BootstrapSettings)
@click.option("--output", metavar="B.json", help="Write the intervals; makes it resumable.")
def command(fitted: str, output: str | None, options: dict[str, Any]) -> None:
    """Find intervals by fitting again and again with blocks of the residual as the noise.

    With --output B.json, every replicate is added to B.json.replicates as it is done: the same
    command goes on where it was stopped, and a larger --replicates adds to what is there.
    """
    store = None if output is None else f"{output}.replicates"
    check_outputs({"--output": output, "replicates": store}, [fitted])

    fit = api.load(fitted)
    with work() as progress, compilation_notice():
        drawn = api.bootstrap(
            fit, **options, store=store, progress=partial(progress.parts, "bootstrap")
        )

    if output is not None:
        drawn.save(output)
    show_table(*_table(drawn))
    blocks = ", ".join(f"{length:.3g}" for length in drawn.block_s)
    again = f", {drawn.resumed} of them made before" if drawn.resumed else ""
    failed = f", {drawn.failed} without a fit" if drawn.failed else ""
    show_line(
        f"{len(drawn.values)} replicates{again}{failed}; blocks of {blocks} s; "
        f"{drawn.seconds:.1f} s"
    )
    show_files({"bootstrap": output})
    if drawn.missing:
        resumes = f"; the same command goes on from {shown(str(store))}" if store else ""
        raise StoppedError(f"stopped, {drawn.missing} replicates missing{resumes}")


def _table(drawn: "api.Bootstrap") -> Columns:
    rows: list[tuple[str, ...]] = []
    for p in drawn.parameters.values():
        text = api.estimate(p.value, p.sem, p.ci95)
        rows.append((p.name, text.value, text.interval, text.sem, p.unit))
    return ("parameter", "value", "95 % interval", "SEM", "unit"), rows
