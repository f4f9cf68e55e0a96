"""`surae relaxed`."""

from typing import Any

import click

from surae import api
from surae.cli.options import LANGUAGE, MAPPING, NUMBER, corrections
from surae.cli.paths import check_outputs, in_folders
from surae.cli.progress import work
from surae.cli.screen import show_answer, show_files


@click.command("relaxed")
@click.argument("recordings", metavar="REC…|DIR", nargs=-1, required=True)
@MAPPING
@corrections
@click.option(
    "--angle",
    "angles",
    type=NUMBER,
    multiple=True,
    metavar="DEG",
    help="Where torque and stiffness are given; may be repeated.  [default: −10, 0, 10]",
)
@click.option("--output", metavar="R.json", help="Write curve and measures.")
@click.option("--report", metavar="R.html", help="Write a page with a figure: HTML or PDF.")
@LANGUAGE
def command(
    recordings: tuple[str, ...],
    mapping: str | None,
    angles: tuple[float, ...],
    output: str | None,
    report: str | None,
    language: str,
    corrections: dict[str, Any],
) -> None:
    """Measure torque and stiffness of a relaxed ankle, from rest alone and without a model.

    The recordings are of one leg and mounting: passive trials, active ones with pauses, held
    angles. Rest is found by the EMG, near its noise. Intervals hold what foot, plate, sensor, the
    angle's zero and relaxation leave open.
    """
    recordings = in_folders(recordings, mapping)
    check_outputs({"--output": output, "--report": report}, recordings)

    api.check_report(report)
    with work() as progress:
        progress.describe("reading, and finding rest")
        curve = api.relaxed(
            recordings, angles=angles or api.REST_ANGLES, mapping=mapping, **corrections
        )
    if output is not None:
        curve.save(output)
    show_answer(curve.as_table())
    if report is not None:
        curve.report(report, language=language)
    show_files({"relaxed": output, "report": report})
