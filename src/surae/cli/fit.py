"""`surae fit`."""

from collections.abc import Mapping, Sequence
from dataclasses import dataclass
from typing import Any

import click

from surae import api
from surae.base.errors import ComputationError, InputError
from surae.base.files import shown
from surae.cli.check import show_short
from surae.cli.grouped import Grouped
from surae.cli.option_records import as_record
from surae.cli.options import MAPPING, PICTURE, corrections, request, settings_options
from surae.cli.paths import check_outputs, in_folders
from surae.cli.progress import StoppedError, Work, compilation_notice, work
from surae.cli.screen import show_files, show_fit


@dataclass(frozen=True, slots=True)
class FitOutputs:
    """Files that a fit is written to."""

    output: str | None  #: The fit itself.
    report: str | None
    figure: str | None = None
    width: float = 170.0  #: Of the figure [mm].


@click.command("fit", cls=Grouped)
@click.argument("recordings", metavar="REC…|DIR", nargs=-1, required=True)
@MAPPING
@corrections
@settings_options(*api.FIT_RECORDS)
@click.option(
    "--mvc",
    multiple=True,
    metavar="FILE",
    help="A maximum voluntary contraction; may be given several times.",
)
@click.option(
    "--strict", is_flag=True, help="Refuse recordings in which `surae check` finds errors."
)
@as_record(
    "outputs",
    FitOutputs,
    click.option("--output", metavar="FIT.json", help="Write the fit."),
    click.option("--report", metavar="REPORT.html", help="Write the report; .pdf makes a PDF."),
    click.option("--figure", type=PICTURE, metavar="F.svg|pdf|png", help="Draw it for a paper."),
    click.option(
        "--width",
        type=click.FloatRange(40.0, 500.0),
        default=170.0,
        metavar="MM",
        help="Width of the figure.  [default: 170]",
    ),
)
def command(
    recordings: tuple[str, ...],
    mapping: str | None,
    options: dict[str, Any],
    mvc: tuple[str, ...],
    strict: bool,
    outputs: FitOutputs,
    corrections: dict[str, Any],
) -> None:
    """Estimate a model's parameters from one recording, or jointly from several.

    REC is a CSV with named channels, a TOML that maps the channels of other files, or with
    --mapping one of the files that this TOML describes.
    Ctrl-C stops the search: the best fit so far is shown and written.
    """
    settings = request(options)
    recordings = in_folders(recordings, mapping)

    api.check_report(outputs.report)
    with work() as progress:
        measured = read_all(recordings, progress, mapping, corrections)

        progress.describe("checking the recordings")
        quality = api.checks_for(settings, measured)
        for one, each in zip(measured if strict else (), quality, strict=False):
            refuse_errors(one.where, each)
        contractions = [
            api.read_contraction(path, mapping=mapping, **(corrections or {})) for path in mvc
        ]
        check_outputs(
            {"--output": outputs.output, "--report": outputs.report, "--figure": outputs.figure},
            [file.path for recording in (*measured, *contractions) for file in recording.files],
        )

        inputs = api.inputs_for(settings, measured, contractions)
        if [each.name for each in inputs] != [each.name for each in measured]:
            windows = "; ".join(each.name for each in inputs)
            click.echo(f"surae: not all of a recording is fitted, but {windows}", err=True)

        with compilation_notice():
            fit = api.fit_inputs(
                inputs, settings, quality, progress=progress.starts, judging=progress.judging
            )
    show_fitted(fit, outputs)
    judge_end(fit, outputs.output)


def read_all(
    paths: Sequence[str],
    progress: Work,
    mapping: str | None = None,
    corrections: Mapping[str, Any] | None = None,
) -> "list[api.Recording]":
    """Recordings, each read once."""
    recordings = []
    for path in paths:
        progress.describe(f"reading {path}")
        recordings += api.read_trials(path, mapping=mapping, **(corrections or {}))
    return recordings


def refuse_errors(path: str, quality: "api.Quality") -> None:
    """Raise InputError where a recording has a finding that is an error."""
    wrong = [finding for finding in quality.findings if finding.severity == "error"]
    if wrong:
        rest = len(wrong) - 1
        more = f" (and {rest} more error{'s' if rest > 1 else ''})" if rest else ""
        raise InputError(
            f"{shown(path)}: {wrong[0].code}: {wrong[0].message} {wrong[0].advice}{more}"
        )


def show_fitted(fit: "api.Fit", outputs: FitOutputs) -> None:
    """Write a fit, then show it: a closed pipe must not cost a result."""
    output, report, figure = outputs.output, outputs.report, outputs.figure
    if output is not None:
        fit.save(output)
    show_fit(fit)
    for quality in fit.quality:
        show_short(quality)
    if report is not None:
        fit.report(report)
    if figure is not None:
        fit.figure(figure, width=outputs.width)
    show_files({"fit": output, "report": report, "figure": figure})


def judge_end(fit: "api.Fit", output: str | None) -> None:
    """Say where a fit was stopped or failed; the exit code says so too."""
    if fit.result.solution.is_interrupted:
        written = " and written" if output is not None else ""
        raise StoppedError(f"stopped by the user; the best fit so far is shown{written}")
    if fit.status == "failed":
        raise ComputationError(f"the fit failed: {fit.message}")
