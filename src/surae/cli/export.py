"""`surae export`."""

from pathlib import Path

import click

from surae import api
from surae.cli.paths import check_outputs
from surae.cli.progress import compilation_notice
from surae.cli.screen import show_files, show_line

#: Formats and how their files end; written out so that help comes at once.
_ENDINGS = {"osim": ".osim", "mjcf": ".xml"}


@click.command("export")
@click.argument("fitted", metavar="FIT.json|DIR")
@click.option(
    "--to",
    type=click.Choice(list(_ENDINGS)),
    required=True,
    help="OpenSim (4.5 or later) or MuJoCo.",
)
@click.option("--output", metavar="FILE", help="Model file to write.  [default: beside the fit]")
def command(fitted: str, to: str, output: str | None) -> None:
    """Write the leg of a fit as a model for another simulator.

    The file says how far its torque is from surae's, and the parameters' intervals.
    """
    path = output or str(Path(fitted).with_suffix(_ENDINGS[to]))
    check_outputs({"--output": path}, [fitted], spare_fits=True)
    with compilation_notice():
        model = api.export(fitted, to=to)
    model.save(path)
    show_line(model.agreement)
    show_files({"model": path})
