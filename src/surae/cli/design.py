"""`surae design`."""

from dataclasses import dataclass
from typing import Any

import click

from surae import api
from surae.base.errors import InputError
from surae.base.files import write_json
from surae.base.requests import DesignSettings
from surae.cli.option_records import as_record
from surae.cli.options import NUMBER, PICTURE, settings_options
from surae.cli.paths import check_outputs
from surae.cli.progress import StoppedError, compilation_notice, work
from surae.cli.protocol import device_of, device_options, file_kind
from surae.cli.screen import show_answer, show_files


@dataclass(frozen=True, slots=True)
class OneLeg:
    """The leg for which a trial is designed, where it is no one of a population."""

    fitted: str | None
    after: str | None  #: The same, and what is known of it counts.

    def __post_init__(self) -> None:
        if self.fitted is not None and self.after is not None:
            raise InputError(
                "--fit and --after: give one of them; --after counts what it knows, too"
            )


@dataclass(frozen=True, slots=True)
class DesignOutputs:
    """Files that a design is written to."""

    output: str
    target: str | None  #: For the subject's screen.
    figure: str | None


@click.command("design")
@as_record(
    "leg",
    OneLeg,
    click.option(
        "--fit",
        "fitted",
        metavar="FIT.json|DIR",
        help="For one leg, as far as a fit or a session knows it.",
    ),
    click.option(
        "--after",
        metavar="FIT.json|DIR",
        help="Likewise, and what is known counts: the trial that adds most.",
    ),
)
@device_options
@settings_options(DesignSettings, api.ModelOptions)
@click.option(
    "--session",
    is_flag=True,
    help="Plan a whole session instead: steps of the laboratory, and trials.",
)
@click.option(
    "--minutes", type=NUMBER, metavar="N", help="Of the leg's time, with --session.  [default: 10]"
)
@as_record(
    "outputs",
    DesignOutputs,
    click.option(
        "--output",
        required=True,
        metavar="P.csv|P.mat",
        help="Where the protocol goes; of a session's plan a .json.",
    ),
    click.option(
        "--target", metavar="T.csv", help="Where the target for the subject's screen goes."
    ),
    click.option("--figure", type=PICTURE, metavar="P.svg|pdf|png", help="Draw it."),
)
def command(
    leg: OneLeg,
    device: str,
    without_limits: str | None,
    outputs: DesignOutputs,
    session: bool,
    minutes: float | None,
    options: dict[str, Any],
) -> None:
    """Design the most informative protocol within a device's limits: movement and effort.

    The same options find the same protocol. Ctrl-C keeps the best so far.
    """
    fitted, after = leg.fitted, leg.after
    output, target, figure = outputs.output, outputs.target, outputs.figure
    if session:
        _plan(
            fitted or after or target or figure,
            device_of(device, without_limits),
            minutes,
            output,
            options,
        )
        return
    if minutes is not None:
        raise InputError("--minutes has no effect without --session")
    file_kind("--output", output, ".csv", ".mat")
    check_outputs(
        {"--output": output, "--target": target, "--figure": figure},
        [path for path in (fitted, after) if path is not None],
    )
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


def _plan(
    other: str | None,
    device: str | None,
    minutes: float | None,
    output: str,
    options: dict[str, Any],
) -> None:
    """Plan a session."""
    file_kind("--output", output, ".json")
    taken = {"population", "angle_range", "effort", "noise", "aim"}
    if other is not None or (unused := [name for name in options if name not in taken]):
        name = "--fit, --after, --target and --figure" if other else f"--{unused[0]}"
        raise InputError(f"{name.replace('_', '-')} has no effect with --session; leave it out")
    with work() as progress, compilation_notice():
        progress.describe("judging sets of steps")
        plan = api.plan_session(10.0 if minutes is None else minutes, device=device, **options)
    write_json(output, plan.to_json())
    show_answer(plan.as_table())
    show_files({"plan": output})
