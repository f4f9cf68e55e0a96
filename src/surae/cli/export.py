"""`surae export`."""

from pathlib import Path
from typing import Any

import click

from surae import api
from surae.base.errors import InputError
from surae.cli.paths import check_outputs
from surae.cli.progress import compilation_notice
from surae.cli.screen import show_answer, show_files, show_line

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
@click.option(
    "--into",
    metavar="MODEL.osim",
    help="OpenSim model in which the leg’s muscles are written; it stays as it is.",
)
@click.option(
    "--side", type=click.Choice(["right", "left"]), help="Leg of that model.  [default: right]"
)
@click.option(
    "--pose",
    "poses",
    metavar="COORDINATE=DEG",
    multiple=True,
    help="Where another joint of that model was held, such as knee_angle_r=20; may be repeated.",
)
@click.option(
    "--strength",
    type=click.Choice(["model", "measured"]),
    help="Whose largest forces that model gets.  [default: model]",
)
def command(
    fitted: str,
    to: str,
    output: str | None,
    into: str | None,
    side: str | None,
    poses: tuple[str, ...],
    strength: str | None,
) -> None:
    """Write the leg of a fit as a model for another simulator.

    The file says how far its torque is from surae's, and the parameters' intervals. With --into,
    the lines that change and a table of bounds are written beside it.
    """
    path = output or str(Path(fitted).with_suffix(_ENDINGS[to]))
    given: dict[str, Any] = {"side": side, "strength": strength, "pose": pose_of(poses)}
    wanted = {name: value for name, value in given.items() if value}
    if into is None:
        for name in wanted:
            raise InputError(f"--{name} is of the model that --into names; give it too")
        check_outputs({"--output": path}, [fitted], spare_fits=True)
    else:
        outputs = {
            "--output" if kind == "model" else f"{kind} beside --output": file
            for kind, file in api.files_beside(path).items()
        }
        check_outputs(outputs, [fitted, into], spare_fits=True)
    with compilation_notice():
        model = api.export(fitted, to=to, into=into, **wanted)
    if isinstance(model, api.ExportedIntoModel):
        files = model.save(path)
        show_answer(model.as_table())
        show_line(model.agreement)
        show_files(files)
        return
    model.save(path)
    show_line(model.agreement)
    show_files({"model": path})


def pose_of(poses: tuple[str, ...]) -> dict[str, float]:
    """Coordinates with their angles."""
    found = {}
    for text in poses:
        name, _, value = text.partition("=")
        try:
            found[name.strip()] = float(value)
        except ValueError:
            raise InputError(
                f"--pose {text!r}: write a coordinate and its angle [deg], such as knee_angle_r=20"
            ) from None
    return found
