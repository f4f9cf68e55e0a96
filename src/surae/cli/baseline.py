"""`surae baseline`."""

from typing import Any

import click

from surae.cli.options import MODEL_NAMES, given, model_options, number, whole_number
from surae.cli.paths import check_outputs
from surae.cli.protocol import DEVICE_NAMES, TASK_NAMES, chirp_rise, chirp_rise_options
from surae.errors import InputError
from surae.files import shown

#: More subjects than this are a slip of the keyboard.
_MOST_SUBJECTS = 10_000


@click.command("baseline")
@click.argument("name", metavar="PROTOCOL")
@click.option("--model", default="muscle", show_default=True, metavar="M", help=f"{MODEL_NAMES}.")
@click.option("--subjects", metavar="N", help="How many virtual subjects.  [default: 10]")
@click.option("--population", default="healthy", show_default=True, metavar="healthy|patient",
              help="Where they come from.")  # fmt: skip
@click.option("--noise", default="0.05", show_default=True, metavar="PART",
              help="Of EMG and torque, part of each signal's mean size.")  # fmt: skip
@click.option("--seed", metavar="N", help="Of the first subject.  [default: 0]")
@click.option("--task", default="part-passive", show_default=True, metavar=TASK_NAMES,
              help="What the subjects are asked to do.")  # fmt: skip
@click.option("--chirp-amplitude", default="0.2", show_default=True, metavar="A",
              help="Of the added chirp, in rad.")  # fmt: skip
@chirp_rise_options
@click.option("--rate", default="125", show_default=True, metavar="HZ", help="Samples per second.")
@click.option("--device", metavar=DEVICE_NAMES, help="Adapt the motion to its limits.")
@click.option("--output", required=True, metavar="B.json", help="Where the baseline goes.")
@model_options
def command(
    name: str,
    model: str,
    subjects: str | None,
    population: str,
    noise: str,
    seed: str | None,
    task: str,
    chirp_amplitude: str,
    chirp_rate: str | None,
    chirp_factor: str | None,
    rate: str,
    device: str | None,
    output: str,
    **options: Any,
) -> None:
    """Simulate the standard errors with which `surae fit --baseline` compares those of a fit.

    Virtual subjects do a PROTOCOL of `surae protocol`; B.json holds the mean standard error of
    every parameter. The snSEM of a fit is its own over these.
    """
    count = whole_number("--subjects", subjects, least=1, most=_MOST_SUBJECTS) or 10
    first = whole_number("--seed", seed, least=0) or 0
    part = number("--noise", noise)
    if not 0 < part < 1:
        raise InputError(f"--noise {noise}: give a part above 0 and below 1, e.g. 0.05")
    amplitude = number("--chirp-amplitude", chirp_amplitude)
    rise, rate_hz = chirp_rise(chirp_rate, chirp_factor), number("--rate", rate)
    chosen = given(options)
    check_outputs({"--output": output}, [])

    from surae.model import ModelOptions, get_model
    from surae.protocol import Protocol, named_device

    get_model(model)
    protocol = Protocol(
        profile=name,
        task=task,
        chirp_amplitude=amplitude,
        chirp_rate=rise,
        rate_hz=rate_hz,
        device=None if device is None else named_device(device),
    )

    from surae.assessment.saved.baseline_json import save_baseline
    from surae.cli.progress import compilation_notice, work
    from surae.cli.screen import show_line
    from surae.report.digits import standard_error
    from surae.studies.baseline import make_baseline

    with work() as progress, compilation_notice():
        baseline = make_baseline(
            protocol,
            model,
            count,
            first,
            population=population,
            noise=part,
            options=ModelOptions.of(**chosen),
            progress=progress.fits,
        )
    save_baseline(output, baseline)
    units = {p.name: p.unit for p in get_model(model).parameters}
    show_line(f"Mean SEM of {baseline.about}:")
    for parameter, sem in baseline.sem.items():
        unit = "" if units[parameter] == "-" else f" {units[parameter]}"
        show_line(f"  {parameter}: {standard_error(sem)}{unit}")
    show_line(f"baseline: {shown(output)}")
