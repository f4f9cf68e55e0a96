"""`surae validate`."""

import json

import click

from surae.api import load, validate
from surae.cli.screen import notice_compilation, show_predictions
from surae.files import write_atomic


@click.command("validate")
@click.argument("fitted", metavar="FIT.json")
@click.argument("recordings", metavar="REC…", nargs=-1, required=True)
@click.option("--prepared/--unprepared", default=None,
              help="Signals as they are, or filtered; by default as in the fit.")  # fmt: skip
@click.option("--output", metavar="V.json", help="Write the figures.")
def command(
    fitted: str, recordings: tuple[str, ...], prepared: bool | None, output: str | None
) -> None:
    """Predict the torque of other recordings with the parameters of a fit."""
    fit = load(fitted)
    notice_compilation()
    predictions = validate(fit, recordings, prepared=prepared)
    show_predictions(predictions)
    if output:
        table = [
            {"path": path, "vaf": one.vaf, "rmse_Nm": one.rmse, "bias_Nm": one.bias}
            for path, one in zip(recordings, predictions, strict=True)
        ]
        write_atomic(output, json.dumps({"recordings": table}, indent=1) + "\n")
        click.echo(f"validation: {output}")
