"""`surae impedance`."""

from functools import partial
from typing import Any

import click

from surae import api
from surae.cli.options import LANGUAGE, MAPPING, corrections
from surae.cli.paths import check_outputs, in_folders
from surae.cli.progress import work
from surae.cli.screen import show_answer, show_files


@click.command("impedance")
@click.argument("recordings", metavar="REC…|DIR", nargs=-1, required=True)
@MAPPING
@corrections
@click.option(
    "--empty", metavar="REC", help="The same movement without a foot: its inertia is taken off."
)
@click.option("--output", metavar="I.json", help="Write what was found.")
@click.option("--report", metavar="I.html", help="Write a page with figures: HTML or PDF.")
@LANGUAGE
def command(
    recordings: tuple[str, ...],
    mapping: str | None,
    empty: str | None,
    output: str | None,
    report: str | None,
    language: str,
    corrections: dict[str, Any],
) -> None:
    """Tell tissue from reflex by small random perturbations of the ankle.

    Each recording has angle and torque while the device moves the foot by a few degrees at random
    for 60 s. Stiffness, viscosity and inertia, the reflex's gain, delay and share of the torque
    come with intervals; whether a reflex is there is said by what it predicts of torque that was
    not fitted.
    """
    recordings = in_folders(recordings, mapping)
    given = [*recordings, *([empty] if empty is not None else [])]
    check_outputs({"--output": output, "--report": report}, given)

    api.check_report(report)
    with work() as progress:
        impedance = api.impedance(
            recordings,
            empty=empty,
            mapping=mapping,
            progress=partial(progress.parts, "recordings"),
            **corrections,
        )
    if output is not None:
        impedance.save(output)
    show_answer(impedance.as_table())
    if report is not None:
        api.perturbation_page(impedance, language).write(report)
    show_files({"impedance": output, "report": report})
