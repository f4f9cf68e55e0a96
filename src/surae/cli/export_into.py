"""`surae export --to osim --into MODEL.osim`: a leg's muscles in a model of the user's."""

from dataclasses import dataclass
from typing import Any

import click

from surae import api
from surae.base.errors import InputError
from surae.cli.option_records import as_record
from surae.cli.paths import check_outputs
from surae.cli.progress import compilation_notice
from surae.cli.screen import show_answer, show_files, show_line


@dataclass(frozen=True, slots=True)
class IntoOptions:
    """What only a model of the user's is told."""

    into: str | None  #: Its file.
    side: str | None  #: The leg of that model.
    poses: tuple[str, ...]  #: Where other joints of it were held.
    strength: str | None  #: Whose largest forces it gets.

    def refuse_for(self, to: str) -> None:
        """Refuse them where they have no effect."""
        if self.into is not None and to not in ("osim", "mjcf"):
            raise InputError(f"--into has no effect on --to {to}; leave it out")
        given = {"--side": self.side, "--pose": self.poses, "--strength": self.strength}
        for option, value in given.items():
            if value and self.into is None:
                raise InputError(f"{option} is of the model that --into names; give it too")


#: The options of a model of the user's, as one argument `into`.
into_options = as_record(
    "into",
    IntoOptions,
    click.option(
        "--into",
        metavar="MODEL.osim",
        help="OpenSim: model in which the leg’s muscles are written; it stays as it is.",
    ),
    click.option(
        "--side",
        type=click.Choice(["right", "left"]),
        help="OpenSim: leg of that model.  [default: right]",
    ),
    click.option(
        "--pose",
        "poses",
        metavar="COORDINATE=DEG",
        multiple=True,
        help="OpenSim: where another joint of that model was held, such as "
        "knee_angle_r=20; may be repeated.",
    ),
    click.option(
        "--strength",
        type=click.Choice(["model", "measured"]),
        help="OpenSim: whose largest forces that model gets.  [default: model]",
    ),
)


def write_into(fitted: str, to: str, path: str, options: IntoOptions) -> None:
    """Write the model with the leg's muscles, the lines that change, and a table of bounds."""
    assert options.into is not None
    outputs = {
        "--output" if kind == "model" else f"{kind} beside --output": file
        for kind, file in api.files_beside(path).items()
    }
    check_outputs(outputs, [fitted, options.into], spare_fits=True)
    given: dict[str, Any] = {
        "side": options.side,
        "strength": options.strength,
        "pose": pose_of(options.poses),
    }
    with compilation_notice():
        model = api.export(
            fitted, to=to, into=options.into, **{name: v for name, v in given.items() if v}
        )
    assert isinstance(model, api.ExportedIntoModel)
    files = model.save(path)
    show_answer(model.as_table())
    show_line(model.agreement)
    show_files(files)


def pose_of(poses: tuple[str, ...]) -> dict[str, float]:
    """Coordinates with their angles [deg]."""
    angles = {}
    for text in poses:
        name, _, value = text.partition("=")
        try:
            angles[name.strip()] = float(value)
        except ValueError:
            raise InputError(
                f"--pose {text!r}: write a coordinate and its angle [deg], such as knee_angle_r=20"
            ) from None
    return angles
