"""`surae session`."""

from collections.abc import Sequence
from dataclasses import dataclass
from pathlib import Path
from typing import Any

import click

from surae import api
from surae.base.errors import ComputationError, InputError
from surae.base.files import shown
from surae.cli.grouped import Grouped
from surae.cli.option_records import as_record
from surae.cli.options import (
    LANGUAGE,
    MAPPING,
    corrections,
    request,
    settings_options,
    workers_option,
)
from surae.cli.paths import check_outputs
from surae.cli.progress import StoppedError, Work, compilation_notice, work
from surae.cli.screen import show_files, show_line, show_table


@dataclass(frozen=True, slots=True)
class Page:
    """The leg's page: in which language, against which visit, and where else it goes."""

    report: str | None  #: Beside the folder of results.
    language: str
    before: str | None  #: Results of an earlier visit.


@click.command("session", cls=Grouped)
@click.argument("recordings", metavar="FILES|DIR", nargs=-1, required=True)
@MAPPING
@corrections
@settings_options(*api.FIT_RECORDS)
@click.option(
    "--output",
    metavar="OUT/",
    help="Folder of the fits and the report.  [default: DIR-session, beside DIR]",
)
@as_record(
    "page",
    Page,
    click.option("--report", metavar="R.pdf", help="Write the report here too: HTML or PDF."),
    LANGUAGE,
    click.option(
        "--before", metavar="DIR", help="Results of an earlier visit, to show what changed."
    ),
)
@workers_option("Fits")
def command(
    recordings: tuple[str, ...],
    mapping: str | None,
    options: dict[str, Any],
    output: str | None,
    page: Page,
    workers: int | None,
    corrections: dict[str, Any],
) -> None:
    """Fit the trials of one leg: each, all together, and each predicted by the others.

    FILES are data files or a folder of them; --mapping says which column is which signal, for all.
    Trials that hold still or are of maximal effort are used as references. A file that
    cannot be read is reported and the others go on. OUT/ then holds report.html, table.csv,
    fits/TRIAL.json and joint.json; the same command again takes fits that are there already.
    Ctrl-C keeps what is complete.
    """
    settings = request(options)
    output = output or default_folder(recordings)
    report, language = page.report, page.language
    if report is not None and Path(report).resolve().parent != Path(output).resolve():
        check_outputs({"--report": report}, recordings)  # OUT/ is not there yet

    if report is not None:
        api.check_report(report)
    earlier = None if page.before is None else api.load_session(page.before)

    with work() as progress:
        progress.describe("reading and sorting the trials")

        trials = api.session(list(recordings), mapping=mapping, **corrections)
        for toml, names in trials.same_layout.items():
            said = f"read as {shown(toml)} says, whose columns they have; --mapping takes another"
            click.echo(f"surae: {', '.join(names)}: {said}", err=True)
        with compilation_notice():
            result = trials.run(
                output, settings, progress=lambda step: _tell(progress, step), workers=workers
            )
    _show(result, output)
    if result.fits or result.joint or result.nerve:
        show_line("")
        for question, answer in result.answers(before=earlier, language=language).items():
            show_line(f"{question} {answer}")
        show_line("")
    if earlier is not None:
        result.report(Path(output, "report.html"), before=earlier)
    if language != "en":
        result.report(Path(output, f"report.{language}.html"), before=earlier, language=language)
    if report is not None:
        result.report(report, before=earlier, language=language)
    show_files({"report": report})
    if result.interrupted:
        raise StoppedError(
            "stopped by the user; the fits that are complete are written, and the same command "
            "goes on"
        )
    if not (result.fits or result.joint or result.nerve):
        raise ComputationError("no trial could be fitted")


def default_folder(recordings: Sequence[str]) -> str:
    """Where results go that are given no folder: beside that of the trials, never in it."""
    first = Path(recordings[0])
    folder = first if first.is_dir() else first.parent
    whole = folder.resolve()
    if not whole.name:
        raise InputError("give --output: there is no place beside the trials")
    beside = folder.parent if folder.name else Path("..")
    return str(beside / f"{whole.name}-session")


def _tell(progress: Work, step: "api.Step") -> None:
    """A bar while something is done, a line when it is."""
    if not step.outcome:
        progress.parts(step.what, step.done, step.total)
        return
    left = ""
    if step.left_s is not None and step.done < step.total:
        minutes = f"{round(step.left_s / 60)} min"
        left = f"; about {minutes if step.left_s >= 90 else f'{max(round(step.left_s), 1)} s'} left"
    click.echo(f"[{step.done}/{step.total}] {step.what}: {step.outcome}{left}", err=True)


def _show(result: "api.SessionResult", output: str) -> None:
    """What came of it."""
    rows = [
        (row["trial"], row["effort"], row["grade"], api.percentage(row["r2"] or float("nan")), "%")
        for row in result.rows()
    ]
    if rows:
        show_table(("fit of", "effort", "grade", "R²", ""), rows, ("R²",))
    for name, why in result.failed.items():
        show_line(f"{name}: {why}")
    for text in result.common:
        show_line(text)
    show_line(f"report: {shown(output)}/report.html; table: {shown(output)}/table.csv")
    unread = [trial.name for trial in result.session.trials if trial.recording is None]
    if unread:
        click.echo(f"surae: could not be read: {', '.join(unread)}", err=True)
