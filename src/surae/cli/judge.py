"""`surae judge`."""

import click

from surae import api
from surae.cli.options import LANGUAGE
from surae.cli.paths import check_outputs
from surae.cli.screen import show_answer, show_files


@click.command("judge")
@click.argument("results", metavar="RESULT…", nargs=-1, required=True)
@click.option(
    "--generic", metavar="FILE", help="What the search began from: a model of the same muscles."
)
@click.option(
    "--calibration", metavar="FILE.xml", help="CEINMS’ set-up, with the limits of its search."
)
@click.option("--output", metavar="J.json", help="Write every value with what is said of it.")
@click.option("--report", metavar="J.html", help="Write a page: HTML or PDF.")
@LANGUAGE
def command(
    results: tuple[str, ...],
    generic: str | None,
    calibration: str | None,
    output: str | None,
    report: str | None,
    language: str,
) -> None:
    """Give a second opinion on muscle parameters of other programs.

    Results are OpenSim models, NMSM's .osimx or muscleModelParameters.sto, CEINMS' subjects,
    MuscleRedundancySolver's .mat, or folders of them. Values at limits, generic ones, plain parts
    of these and those of no human are named.
    """
    beside = [each for each in (generic, calibration) if each is not None]
    check_outputs({"--output": output, "--report": report}, [*results, *beside])
    api.check_report(report)
    opinion = api.judge(results, generic=generic, calibration=calibration)
    if output is not None:
        opinion.save(output)
    show_answer(opinion.as_table())
    if report is not None:
        opinion.report(report, language=language)
    show_files({"opinion": output, "report": report})
