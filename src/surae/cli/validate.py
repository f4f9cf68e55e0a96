"""`surae validate`."""

import json

import click

from surae.cli.paths import check_outputs
from surae.files import shown, write_atomic


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
    from surae.recording import read

    measured = [read(path) for path in recordings]
    check_outputs({"--output": output}, [fitted, *(f.path for one in measured for f in one.files)])

    from surae.api import load, validate  # numba: only when the input is in order
    from surae.cli.progress import compilation_notice
    from surae.cli.screen import show_line, show_predictions

    fit = load(fitted)
    with compilation_notice():
        predictions = validate(fit, measured, prepared=prepared)
    if output is not None:
        table = [
            {"path": path, "vaf": one.vaf, "rmse_Nm": one.rmse, "bias_Nm": one.bias}
            for path, one in zip(recordings, predictions, strict=True)
        ]
        text = json.dumps({"recordings": table}, indent=1, allow_nan=False)
        write_atomic(output, text + "\n")
    show_predictions(predictions, recordings)
    used = {file.sha256 for one in fit.result.problem.inputs for file in one.files}
    for path, one in zip(recordings, measured, strict=True):
        if any(file.sha256 in used for file in one.files):
            show_line(f"{shown(path)} was used in the fit: following it proves nothing")
    if output is not None:
        show_line(f"validation: {shown(output)}")
