"""`surae design`."""

from pathlib import Path
from typing import Any

import click

from surae import api
from surae.cli.options import Number, Picture, settings_options
from surae.cli.paths import check_outputs
from surae.cli.progress import StoppedError, compilation_notice, work
from surae.cli.protocol import device_of, device_options, file_kind
from surae.cli.screen import show_answer, show_files, show_line
from surae.errors import InputError
from surae.files import shown, write_json
from surae.formatting import part
from surae.requests import DesignSettings, SittingSettings
from surae.setting import default_of, settings_of


@click.command("design")
@click.option("--session", "minutes", type=Number(above=0.0), metavar="MIN",
              help="Instead of a trial: which trials, and how often, in so many "
              "minutes.")  # fmt: skip
@click.option("--fit", "fitted", metavar="FIT.json|DIR",
              help="For one leg instead, as far as a fit, or a session, knows it.")  # fmt: skip
@click.option("--after", metavar="FIT.json|DIR",
              help="The same, and what it knows counts: what adds most.")  # fmt: skip
@device_options
@settings_options(DesignSettings, SittingSettings, api.ModelOptions)
@click.option("--output", required=True, metavar="P.csv|P.mat|FOLDER",
              help="Where the protocol goes, or all of a session's.")  # fmt: skip
@click.option("--target", metavar="T.csv", help="Where the target for the subject's screen goes.")
@click.option("--figure", type=Picture(), metavar="P.svg|pdf|png", help="Draw it.")
def command(
    fitted: str | None,
    after: str | None,
    device: str,
    without_limits: str | None,
    minutes: float | None,
    output: str,
    target: str | None,
    figure: str | None,
    options: dict[str, Any],
) -> None:
    """Design the most informative protocol within a device's limits: movement and effort.

    The same options find the same protocol. Ctrl-C keeps the best so far.
    """
    folder = Path(output)
    if minutes is None:
        file_kind("--output", output, ".csv", ".mat")
        if "pause" in options:
            raise InputError("--pause is between the trials of a session; give --session MIN too")
    elif folder.is_file() or (folder.is_dir() and any(folder.iterdir())):
        raise InputError(f"--output {shown(output)}: name a new or an empty folder")
    check_outputs(
        {"--output": output if minutes is None else None, "--target": target, "--figure": figure},
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
    if minutes is not None:
        refused = [f"--{name}" for name in ("duration", "evaluations", "seed") if name in options]
        refused += ["--target"] * (target is not None) + ["--figure"] * (figure is not None)
        if refused:
            raise InputError(f"{refused[0]} is of a single trial; leave it out, or --session")
        defaults = {each.name: default_of(each) for each, _ in settings_of(DesignSettings)}
        alike = {name: defaults[name] for name in ("model", "rate_hz")}
        _plan(output, without_limits, minutes=minutes, **alike | options)
        return

    with work() as progress, compilation_notice():
        design = api.design(
            **options, progress=lambda done, total, _: progress.parts("plans judged", done, total)
        )
    design.write(output, without_limits=without_limits)
    if target is not None:
        api.write_protocol_target(design.trajectory, target)
    if figure is not None:
        api.write_figure(figure, api.protocol_figure(design.trajectory))
    show_answer(design.expectation.as_table())
    for note in design.notes:
        show_line(note)
    if design.aimed:
        aims = ", ".join(f"{name} {part(sem)}" for name, sem in design.aimed.items())
        show_line(f"standard error of what was aimed at: {aims}")
    show_line(f"{design.curve[-1][0]:,} plans to the best; {design.seconds:.0f} s")
    show_files({"protocol": output, "target": target, "figure": figure})
    if design.stopped:
        raise StoppedError("stopped by the user; the best so far is kept")


def _plan(output: str, without_limits: str | None, **settings: Any) -> None:
    """Plan a session, and write its trials into a folder."""
    with compilation_notice():
        plan = api.design_session(**settings)
    folder = Path(output)
    folder.mkdir(parents=True, exist_ok=True)
    for k, trial in enumerate(plan.trials, 1):
        path = folder / f"{k:02d}-{trial.name}.csv"
        api.write_protocol(trial.trajectory, path, without_limits=without_limits)
        if trial.trajectory.effort.any():
            api.write_protocol_target(trial.trajectory, path.with_name(f"{path.stem}-target.csv"))
    write_json(folder / "plan.json", plan.to_json())
    show_answer(plan.expectation.as_table())
    for line in plan.sentences:
        show_line(line)
    show_files({"session": output})
