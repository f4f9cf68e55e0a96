"""`surae fit`."""

from collections.abc import Sequence
from typing import TYPE_CHECKING, Any

import click

from surae import names
from surae.cli.options import MAPPING, MODEL_NAMES, figure_options, request, request_options
from surae.cli.paths import check_outputs, check_recordings
from surae.cli.progress import Work
from surae.errors import InputError
from surae.files import shown

if TYPE_CHECKING:
    from surae.api import Fit, Quality, Recording


@click.command("fit")
@click.argument("recordings", metavar="REC…", nargs=-1, required=True)
@click.option(
    "--model",
    type=click.Choice(names.FITTED),
    default=names.AUTO,
    show_default=True,
    metavar="M",
    help=f"{names.AUTO}: what the data support; or {MODEL_NAMES}.",
)
@MAPPING
@click.option("--prepared", is_flag=True, help="Use the signals as they are, without filters.")
@request_options
@click.option("--baseline", metavar="B.json", help="Compare SEM with simulations (snSEM).")
@click.option(
    "--strict", is_flag=True, help="Refuse recordings in which `surae check` finds errors."
)
@click.option("--output", metavar="FIT.json", help="Write the fit.")
@click.option("--report", metavar="REPORT.html", help="Write the report; .pdf makes a PDF.")
@figure_options
def command(
    recordings: tuple[str, ...],
    model: str,
    mapping: str | None,
    prepared: bool,
    asked: dict[str, Any],
    mvc: tuple[str, ...],
    baseline: str | None,
    strict: bool,
    output: str | None,
    report: str | None,
    figure: str | None,
    width: float,
) -> int:
    """Estimate a model's parameters from one recording, or jointly from several.

    REC is a CSV with named channels, a TOML that maps the channels of other files, or with
    --mapping one of the files that this TOML describes.
    Ctrl-C stops the search: the best fit so far is shown and written.
    """
    settings = request(model, asked | {"prepared": prepared})
    check_recordings(recordings)

    from surae.api import check_report
    from surae.cli.progress import compilation_notice, work

    check_report(report)
    with work() as progress:
        measured = read_all(recordings, progress, mapping)

        from surae.api import check  # numba: only when there is something to check

        quality = []
        for path, recording in zip(recordings, measured, strict=True):
            progress.describe(f"checking {path}")
            quality.append(check(recording, prepared=prepared))
            if strict:
                refuse_errors(path, quality[-1])
        contractions = read_all(mvc, progress, mapping)
        check_outputs(
            {"--output": output, "--report": report, "--figure": figure},
            [*([] if baseline is None else [baseline]),
             *(file.path for recording in (*measured, *contractions) for file in recording.files)],
        )  # fmt: skip
        from surae.api import fit_inputs, inputs_for

        inputs = inputs_for(settings, measured, contractions)

        with compilation_notice():
            fit = fit_inputs(inputs, settings, quality, baseline, progress.starts)
    return finish(fit, output, report, figure, width)


def read_all(paths: Sequence[str], progress: Work, mapping: str | None = None) -> "list[Recording]":
    """Recordings, each read once."""
    from surae.api import read

    recordings = []
    for path in paths:
        progress.describe(f"reading {path}")
        recordings.append(read(path, mapping=mapping))
    return recordings


def refuse_errors(path: str, quality: "Quality") -> None:
    """Raise InputError where a recording has a finding that is an error."""
    wrong = [finding for finding in quality.findings if finding.severity == "error"]
    if wrong:
        rest = len(wrong) - 1
        more = f" (and {rest} more error{'s' if rest > 1 else ''})" if rest else ""
        raise InputError(
            f"{shown(path)}: {wrong[0].code}: {wrong[0].message} {wrong[0].advice}{more}"
        )


def finish(
    fit: "Fit",
    output: str | None,
    report: str | None,
    figure: str | None = None,
    width: float = 0.0,
) -> int:
    """Write a fit, then show it: a closed pipe must not cost a result. Returns the exit code."""
    from surae.cli.check import show_short
    from surae.cli.screen import show_fit, show_line

    if output is not None:
        fit.save(output)
    show_fit(fit)
    for quality in fit.quality:
        show_short(quality)
    if output is not None:
        show_line(f"fit: {shown(output)}")
    if report is not None:
        fit.report(report)
        show_line(f"report: {shown(report)}")
    if figure is not None:
        fit.figure(figure, width=width)
        show_line(f"figure: {shown(figure)}")
    if fit.result.starts[-1].outcome == "interrupted":
        click.echo(
            "surae: stopped by the user; the best fit so far is shown"
            + (" and written" if output is not None else ""),
            err=True,
        )
        return 130
    if fit.status == "failed":
        click.echo(f"surae: the fit failed: {fit.message}", err=True)
        return 1
    return 0
