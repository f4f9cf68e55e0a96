"""`surae design`."""

from pathlib import Path
from typing import Any

import click

from surae import api
from surae.cli.options import FILM, SEED, Number, Picture, Whole, model_options, range_option
from surae.cli.paths import check_outputs
from surae.cli.progress import StoppedError, compilation_notice, work
from surae.cli.protocol import device_of, device_options, file_kind
from surae.cli.screen import show_answer, show_files, show_line
from surae.errors import InputError
from surae.files import shown, write_json
from surae.formatting import part
from surae.names import FITTED, NUISANCES, POPULATIONS


@click.command("design")
@click.option("--model", type=click.Choice(FITTED), default="muscle", metavar="M",
              help="Whose parameters are to be known.  [default: muscle]")  # fmt: skip
@click.option("--population", type=click.Choice(POPULATIONS), metavar="P",
              help="healthy or patient legs.  [default: as many of each]")  # fmt: skip
@click.option("--fit", "fitted", metavar="FIT.json|DIR",
              help="For one leg instead, as far as a fit, or a session, knows it.")  # fmt: skip
@click.option("--after", metavar="FIT.json|DIR",
              help="The same, and what it knows counts: what adds most.")  # fmt: skip
@click.option("--duration", type=Number(above=0.0), metavar="S",
              help="Of the trial, in s.  [default: 35]")  # fmt: skip
@click.option("--session", "minutes", type=Number(above=0.0), metavar="MIN",
              help="Instead of a trial: which trials, and how often, in so many "
              "minutes.")  # fmt: skip
@click.option("--pause", type=Number(), metavar="S",
              help="After each trial of a session, in s.  [default: 30]")  # fmt: skip
@device_options
@range_option("the fit's, or -0.9:0.6 as far as the device", whose="; asked for of patients")
@click.option("--noise", type=Number(above=0.0), metavar="NM",
              help="Of the torque, white.  [default: 0.5, or the fit's]")  # fmt: skip
@click.option("--nuisances", type=click.Choice(NUISANCES), metavar="all|none",
              help="The laboratory's imperfections.  [default: all for auto]")  # fmt: skip
@click.option("--aim", default="worst", show_default=True, metavar="worst|mean|NAME,…",
              help="What is to be known: parameters and measures by name.")  # fmt: skip
@click.option("--effort", type=click.Choice(("levels", "none")), default="levels",
              show_default=True, help="What the subject can do.")  # fmt: skip
@click.option("--rate", type=Number(above=0.0), default=256.0, show_default=True, metavar="HZ",
              help="Samples per second.")  # fmt: skip
@click.option("--evaluations", type=Whole(1, 10_000_000), metavar="N",
              help="Plans that are judged: more is better and slower.")  # fmt: skip
@FILM
@SEED
@model_options
@click.option("--output", required=True, metavar="P.csv|P.mat|FOLDER",
              help="Where the protocol goes, or all of a session's.")  # fmt: skip
@click.option("--target", metavar="T.csv", help="Where the target for the subject's screen goes.")
@click.option("--figure", type=Picture(), metavar="P.svg|pdf|png", help="Draw it.")
def command(
    model: str,
    fitted: str | None,
    after: str | None,
    duration: float | None,
    minutes: float | None,
    pause: float | None,
    device: str,
    without_limits: str | None,
    range: tuple[float, float] | None,
    rate: float,
    output: str,
    target: str | None,
    figure: str | None,
    options: dict[str, Any],
    **settings: Any,
) -> None:
    """Find the movement and effort that tell most of a leg, within a device's limits.

    The same options find the same protocol. Ctrl-C keeps the best so far.
    """
    folder = Path(output)
    if minutes is None:
        file_kind("--output", output, ".csv", ".mat")
        if pause is not None:
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

    who: dict[str, Any] = {
        "device": limiting,
        "model": model,
        "fit": None if fitted is None else api.fit_of(fitted),
        "after": None if after is None else api.fit_of(after),
        "range": range,
        "rate_hz": rate,
    }
    if minutes is not None:
        single = {"--duration": duration, "--target": target, "--figure": figure,
                  "--evaluations": settings.pop("evaluations"),
                  "--film": settings.pop("film") or None}  # fmt: skip
        refused = [option for option, value in single.items() if value is not None]
        if refused:
            raise InputError(f"{refused[0]} is of a single trial; leave it out, or --session")
        settings.pop("seed")
        _plan(minutes, 30.0 if pause is None else pause, output, without_limits,
              **who, **settings, **options)  # fmt: skip
        return

    with work() as progress, compilation_notice():
        design = api.design(
            35.0 if duration is None else duration, **who, **settings, **options,
            progress=lambda done, total, _: progress.parts("plans judged", done, total),
        )  # fmt: skip
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


def _plan(
    minutes: float, pause: float, output: str, without_limits: str | None, **settings: Any
) -> None:
    """Plan a session, and write its trials into a folder."""
    with compilation_notice():
        plan = api.design_session(minutes, pause=pause, **settings)
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
