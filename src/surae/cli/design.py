"""`surae design`."""

from typing import Any

import click

from surae import api
from surae.base.errors import InputError
from surae.base.requests import DesignSettings
from surae.cli.options import PICTURE, settings_options
from surae.cli.paths import check_outputs
from surae.cli.progress import StoppedError, compilation_notice, work
from surae.cli.protocol import device_of, device_options, file_kind
from surae.cli.screen import show_answer, show_files


@click.command("design")
@click.option("--fit", "fitted", metavar="FIT.json|DIR",
              help="For one leg instead, as far as a fit, or a session, knows it.")  # fmt: skip
@click.option("--after", metavar="FIT.json|DIR",
              help="The same, and what it knows counts: what adds most.")  # fmt: skip
@device_options
@settings_options(DesignSettings, api.ModelOptions)
@click.option("--output", required=True, metavar="P.csv|P.mat", help="Where the protocol goes.")
@click.option("--target", metavar="T.csv", help="Where the target for the subject's screen goes.")
@click.option("--figure", type=PICTURE, metavar="P.svg|pdf|png", help="Draw it.")
def command(
    fitted: str | None, after: str | None, device: str, without_limits: str | None, output: str,
    target: str | None, figure: str | None, options: dict[str, Any],
) -> None:  # fmt: skip
    """Design the most informative protocol within a device's limits: movement and effort.

    The same options find the same protocol. Ctrl-C keeps the best so far.
    """
    file_kind("--output", output, ".csv", ".mat")
    check_outputs(
        {"--output": output, "--target": target, "--figure": figure},
        [path for path in (fitted, after) if path is not None],
    )
    if fitted is not None and after is not None:
        raise InputError("--fit and --after: give one of them; --after counts what it knows, too")
    limiting = device_of(device, without_limits)

    options |= {
        "device": limiting,
        "fit": None if fitted is None else api.fit_of(fitted),
        "after": None if after is None else api.fit_of(after),
    }

    with work() as progress, compilation_notice():
        design = api.design(
            **options, progress=lambda done, total, _: progress.parts("plans judged", done, total)
        )
    design.write(output, without_limits=without_limits)
    if target is not None:
        api.write_protocol_target(design.trajectory, target)
    if figure is not None:
        api.write_figure(figure, api.protocol_figure(design.trajectory))
    show_answer(design.as_table())
    show_files({"protocol": output, "target": target, "figure": figure})
    if design.stopped:
        raise StoppedError("stopped by the user; the best so far is kept")
