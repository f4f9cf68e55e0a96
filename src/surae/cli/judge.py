"""`surae judge`."""

from typing import Any

import click

from surae import api
from surae.base.errors import InputError
from surae.cli.export_into import pose_of
from surae.cli.options import LANGUAGE, MAPPING
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
@click.option(
    "--recording", metavar="REC", help="Recording of that leg: what it says of the muscles."
)
@click.option(
    "--model", metavar="MODEL.osim", help="Model with the muscles’ paths, where none is named."
)
@click.option(
    "--side", type=click.Choice(["right", "left"]), default="right", help="Leg that was recorded."
)
@click.option(
    "--pose",
    "poses",
    metavar="COORDINATE=DEG",
    multiple=True,
    help="Where another joint was held, such as knee_angle_r=20; may be repeated.",
)
@MAPPING
@click.option("--output", metavar="J.json", help="Write every value with its judgement.")
@click.option("--report", metavar="J.html", help="Write a page: HTML or PDF.")
@LANGUAGE
def command(
    results: tuple[str, ...],
    output: str | None,
    report: str | None,
    language: str,
    **given: Any,
) -> None:
    """Give a second opinion on muscle parameters of other programs.

    Results are OpenSim models, NMSM's .osimx or muscleModelParameters.sto, CEINMS' subjects,
    MuscleRedundancySolver's .mat, or folders of them. Values at limits, generic ones, plain parts
    of these and those of no human are named. With a recording: how much of its torque such
    muscles can follow, and which of their lengths it tells.
    """
    files = ("generic", "calibration", "recording", "model", "mapping")
    beside = [given[name] for name in files if given[name] is not None]
    check_outputs({"--output": output, "--report": report}, [*results, *beside])
    api.check_report(report)
    poses = pose_of(given.pop("poses"))
    if given["recording"] is None and (given["model"] or poses or given["mapping"]):
        raise InputError("--model, --pose and --mapping are of the recording; give --recording too")
    if given["mapping"] is None:
        del given["mapping"]
    opinion = api.judge(results, pose=poses, **given)
    if output is not None:
        opinion.save(output)
    show_answer(opinion.as_table())
    if report is not None:
        opinion.report(report, language=language)
    show_files({"opinion": output, "report": report})
