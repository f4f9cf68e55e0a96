"""`surae stretches`."""

from typing import Any

import click

from surae import api
from surae.cli.options import LANGUAGE, MAPPING, corrections
from surae.cli.paths import check_outputs, in_folders
from surae.cli.progress import work
from surae.cli.screen import show_answer, show_files


@click.command("stretches")
@click.argument("recordings", metavar="REC…|DIR", nargs=-1, required=True)
@MAPPING
@corrections
@click.option("--output", metavar="R.json", help="Write what was found.")
@click.option("--report", metavar="R.html", help="Write a page with figures: HTML or PDF.")
@LANGUAGE
def command(
    recordings: tuple[str, ...],
    mapping: str | None,
    output: str | None,
    report: str | None,
    language: str,
    corrections: dict[str, Any],
) -> None:
    """Take slow and fast stretches of a relaxed ankle apart: tissue, inertia and nerve.

    The stretches are found in the recordings, of one leg. With EMG each muscle's threshold is
    given, the angle at which it would answer an endlessly slow stretch; repeats of one speed give
    the smallest change that can be detected on this leg.
    """
    recordings = in_folders(recordings, mapping)
    check_outputs({"--output": output, "--report": report}, recordings)

    api.check_report(report)
    with work() as progress:
        progress.describe("taking stretches apart")
        answer = api.stretches(recordings, mapping=mapping, **corrections)
    if output is not None:
        answer.save(output)
    show_answer(answer.as_table())
    if report is not None:
        api.perturbation_page(answer, language).write(report)
    show_files({"stretches": output, "report": report})
