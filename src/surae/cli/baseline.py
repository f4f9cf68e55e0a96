"""`surae baseline`."""

from dataclasses import asdict
from functools import partial
from typing import Any

import click

from surae import api, names
from surae.cli.options import MODEL_NAMES, SEED, Number, Whole, settings_options
from surae.cli.paths import check_outputs
from surae.cli.progress import compilation_notice, work
from surae.cli.protocol import CHIRP_FACTOR, chirp_rise
from surae.cli.screen import show_files, show_line
from surae.requests import BaselineMotion
from surae.setting import settings_of

#: More subjects than this are a slip of the keyboard.
_MOST_SUBJECTS = 10_000


@click.command("baseline")
@click.argument("name", metavar="PROTOCOL")
@click.option("--model", type=click.Choice(names.MODELS), default="muscle", show_default=True,
              metavar="M", help=f"{MODEL_NAMES}.")  # fmt: skip
@click.option("--subjects", "n", type=Whole(1, _MOST_SUBJECTS), default=10, show_default=True,
              metavar="N", help="How many virtual subjects.")  # fmt: skip
@click.option("--population", type=click.Choice(names.POPULATIONS), default="healthy",
              show_default=True, help="Where they come from.")  # fmt: skip
@click.option("--noise", type=Number(0.0, 1.0), default=0.05, show_default=True, metavar="PART",
              help="Of EMG and torque, part of each signal's mean size.")  # fmt: skip
@SEED
@settings_options(
    BaselineMotion, api.ModelOptions, without=("range_of_motion", "duration", "adapt")
)
@CHIRP_FACTOR
@click.option("--device", metavar="|".join(names.DEVICES), help="Adapt the motion to its limits.")
@click.option("--output", required=True, metavar="B.json", help="Where the baseline goes.")
def command(
    name: str,
    model: str,
    chirp_factor: float | None,
    device: str | None,
    output: str,
    options: dict[str, Any],
    **settings: Any,
) -> None:
    """Simulate the standard errors with which `surae fit --baseline` compares those of a fit.

    Virtual subjects do a PROTOCOL of `surae protocol`; B.json holds the mean standard error of
    every parameter. The snSEM of a fit is its own over these.
    """
    check_outputs({"--output": output}, [])

    api.get_model(model)
    motion = {each.name for each, _ in settings_of(BaselineMotion)} & options.keys()
    given: dict[str, Any] = {name: options.pop(name) for name in motion}
    given["chirp_rate"] = chirp_rise(given.get("chirp_rate"), chirp_factor)
    protocol = api.Protocol(
        profile=name,
        device=None if device is None else api.named_device(device),
        **asdict(BaselineMotion(**given)),
    )

    with work() as progress, compilation_notice():
        baseline = api.make_baseline(
            protocol, model, **settings, options=api.ModelOptions.of(**options),
            progress=partial(progress.parts, "fits"),
        )  # fmt: skip
    api.save_baseline(output, baseline)
    units = {p.name: p.unit for p in api.get_model(model).parameters}
    show_line(f"Mean SEM of {baseline.about}:")
    for parameter, sem in baseline.sem.items():
        unit = "" if units[parameter] == "-" else f" {units[parameter]}"
        show_line(f"  {parameter}: {api.standard_error(sem)}{unit}")
    show_files({"baseline": output})
