"""`surae design`."""

from typing import Any

import click

from surae.cli.options import SEED, Number, Picture, Whole, model_options
from surae.cli.paths import check_outputs
from surae.cli.protocol import device_of, device_options, file_kind, span_of
from surae.errors import InputError
from surae.files import shown
from surae.names import FITTED, NUISANCES, POPULATIONS


@click.command("design")
@click.option("--model", type=click.Choice(FITTED), default="muscle", metavar="M",
              help="Whose parameters are to be known.  [default: muscle]")  # fmt: skip
@click.option("--population", type=click.Choice(POPULATIONS), metavar="P",
              help="healthy or patient legs.  [default: as many of each]")  # fmt: skip
@click.option("--fit", "fitted", metavar="FIT.json",
              help="For one leg instead, as far as this fit knows it.")  # fmt: skip
@click.option("--after", metavar="FIT.json",
              help="The same, and what the fit knows counts: what adds most.")  # fmt: skip
@click.option("--duration", type=Number(above=0.0), default=35.0, show_default=True, metavar="S",
              help="Of the trial, in s.")  # fmt: skip
@device_options
@click.option("--range", "range_", metavar="LOW:HIGH",
              help="Full plantarflexion and dorsiflexion of the subject, in rad; asked for of "
              "patients.  [default: the fit's, or -0.9:0.6 as far as the device]")  # fmt: skip
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
@SEED
@model_options
@click.option("--output", required=True, metavar="P.csv|P.mat", help="Where the protocol goes.")
@click.option("--target", metavar="T.csv", help="Where the target for the subject's screen goes.")
@click.option("--figure", type=Picture(), metavar="P.svg|pdf|png", help="Draw it.")
def command(
    model: str,
    fitted: str | None,
    after: str | None,
    duration: float,
    device: str,
    without_limits: str | None,
    range_: str | None,
    rate: float,
    output: str,
    target: str | None,
    figure: str | None,
    options: dict[str, Any],
    **asked: Any,
) -> int:
    """Find the movement and effort that tell most of a leg, within a device's limits.

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

    from surae.api import design, load, write_protocol_target
    from surae.cli.expect import part, show_expectation
    from surae.cli.progress import compilation_notice, work
    from surae.cli.screen import show_line

    with work() as progress, compilation_notice():

        def counted(done: int, total: int, best: float) -> None:
            del best
            progress.parts("plans judged", done, total)

        made = design(
            duration,
            device=limiting,
            model=model,
            fit=None if fitted is None else load(fitted),
            after=None if after is None else load(after),
            range=None if range_ is None else span_of(range_),
            rate_hz=rate,
            progress=counted,
            **asked,
            **options,
        )
    made.write(output, without_limits=without_limits)
    if target is not None:
        write_protocol_target(made.trajectory, target)
    if figure is not None:
        from surae.api import protocol_figure, write_figure

        write_figure(figure, protocol_figure(made.trajectory))
    show_expectation(made.expectation)
    for note in made.notes:
        show_line(note)
    if made.aimed:
        told = ", ".join(f"{name} {part(sem)}" for name, sem in made.aimed.items())
        show_line(f"standard error of what was aimed at: {told}")
    show_line(f"{made.curve[-1][0]:,} plans to the best; {made.seconds:.0f} s")
    for what, path in (("protocol", output), ("target", target), ("figure", figure)):
        if path is not None:
            show_line(f"{what}: {shown(path)}")
    if made.stopped:
        click.echo("surae: stopped by the user; the best so far is kept", err=True)
        return 130
    return 0
