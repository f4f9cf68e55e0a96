"""`surae simulate`."""

from typing import Any

import click

from surae.api import simulate_parts
from surae.assessment.fit_json import read_parameters
from surae.cli.options import given, model_options
from surae.cli.screen import notice_compilation
from surae.recording import columns, read, write_csv


@click.command("simulate")
@click.argument("recording", metavar="IN.csv")
@click.option("--model", default="muscle", show_default=True, metavar="M",
              help="muscle, or another model of `surae fit`.")  # fmt: skip
@click.option("--parameters", required=True, metavar="P.json",
              help='{"parameters": {"m": 2.0, …}} or a FIT.json.')  # fmt: skip
@click.option("--output", required=True, metavar="OUT.csv", help="Where the torque goes.")
@model_options
def command(recording: str, model: str, parameters: str, output: str, **options: Any) -> None:
    """Compute the torque that a model gives for the angle and EMG of a recording.

    The signals are used as they are. OUT.csv holds them with torque_Nm, the modelled torque, and
    its parts.
    """
    values = read_parameters(parameters)
    measured = read(recording)
    notice_compilation()
    parts = simulate_parts(model, values, measured, **given(options))
    table = columns(measured) | {"torque_Nm": parts.total} | dict(parts.columns())
    # The model takes the EMG as an envelope, whatever the file said of it.
    write_csv(output, table, ["emg: envelope", f"torque simulated with model {model}"])
    click.echo(f"simulated: {output}")
