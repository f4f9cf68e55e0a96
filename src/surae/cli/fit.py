"""`surae fit`."""

from typing import Any

import click

from surae.api import STARTS, fit
from surae.cli.options import assignments, given, model_options, ranges
from surae.cli.screen import fit_progress, notice_compilation, show_fit


@click.command("fit")
@click.argument("recordings", metavar="REC…", nargs=-1, required=True)
@click.option("--model", default="muscle", show_default=True, metavar="M", help="Which model.")
@click.option("--prepared", is_flag=True, help="Use the signals as they are, without filters.")
@click.option("--fixed", multiple=True, metavar="NAME=VALUE", help="Do not estimate a parameter.")
@click.option("--free", multiple=True, metavar="NAME", help="Estimate one that is fixed.")
@click.option("--start", multiple=True, metavar="NAME=VALUE", help="Start somewhere else.")
@click.option("--bound", multiple=True, metavar="NAME=LOW:HIGH", help="Other bounds.")
@click.option("--starts", default=STARTS, show_default=True, metavar="N", help="Number of starts.")
@click.option("--seed", default=0, show_default=True, metavar="N", help="Of the random starts.")
@click.option("--output", metavar="FIT.json", help="Write the fit.")
@click.option("--report", metavar="REPORT.html", help="Write the report.")
@model_options
def command(
    recordings: tuple[str, ...],
    model: str,
    prepared: bool,
    fixed: tuple[str, ...],
    free: tuple[str, ...],
    start: tuple[str, ...],
    bound: tuple[str, ...],
    starts: int,
    seed: int,
    output: str | None,
    report: str | None,
    **options: Any,
) -> int:
    """Estimate a model's parameters from one recording, or jointly from several.

    REC is a CSV with named channels, or a TOML that maps the channels of other files.
    """
    check_writable(output, report)
    notice_compilation()
    with fit_progress() as progress:
        found = fit(
            list(recordings),
            model,
            fixed=assignments("--fixed", fixed),
            free=free,
            start=assignments("--start", start),
            bounds=ranges("--bound", bound),
            prepared=prepared,
            starts=starts,
            seed=seed,
            progress=progress,
            **given(options),
        )
    show_fit(found)
    if output:
        found.save(output)
        click.echo(f"fit: {output}")
    if report:
        found.report(report)
        click.echo(f"report: {report}")
    if "stopped by the user" in found.message:
        return 130
    return 1 if found.status == "failed" else 0


def check_writable(*paths: str | None) -> None:
    """Refuse an output that cannot be written before the work is done, not after."""
    from surae.files import require_writable

    for path in paths:
        if path is not None:
            require_writable(path)
