"""`surae validate`."""

from collections.abc import Sequence
from typing import TYPE_CHECKING, Any

import click

from surae import names
from surae.cli.fit import read_all
from surae.cli.options import MODEL_NAMES, request, request_options
from surae.cli.paths import check_outputs, check_recordings
from surae.errors import InputError
from surae.files import shown, write_json

if TYPE_CHECKING:
    from surae.assessment import Pooled, Prediction
    from surae.settings import FitSettings


@click.command("validate")
@click.argument("fitted", metavar="FIT.json")
@click.argument("recordings", metavar="REC…", nargs=-1, required=True)
@click.option("--leave-one-out", is_flag=True,
              help="Take recordings only; predict each with a fit of the others.")  # fmt: skip
@click.option("--prepared/--unprepared", default=None,
              help="Signals as they are, or filtered; by default as in the fit.")  # fmt: skip
@click.option("--output", metavar="V.json", help="Write the figures.")
@click.option("--report", metavar="V.html", help="Write the fit's report with the predictions.")
@click.option("--model", type=click.Choice(names.MODELS), metavar="M",
              help=f"Leave one out: {MODEL_NAMES}.  [default: muscle]")  # fmt: skip
@request_options
def command(
    fitted: str,
    recordings: tuple[str, ...],
    leave_one_out: bool,
    prepared: bool | None,
    output: str | None,
    report: str | None,
    model: str | None,
    asked: dict[str, Any],
    mvc: tuple[str, ...],
) -> None:
    """Predict the torque of other recordings with the parameters of a fit.

    With --leave-one-out there is no FIT.json: REC REC [REC…] are recordings of one leg, and each is
    predicted with the parameters of a fit of all the others. All options of the fit go with it;
    --exclude goes with both.
    """
    if leave_one_out:
        if report is not None:
            raise InputError("--report shows one fit, and --leave-one-out makes several; give one")
        settings = request(model or "muscle", asked | {"prepared": bool(prepared)})
        _leave_one_out((fitted, *recordings), settings, mvc, output)
        return
    for name, value in {**asked, "model": model, "mvc": mvc}.items():
        if value and name != "exclude":
            raise InputError(f"--{name.replace('_', '-')} has no effect without --leave-one-out")
    weighting = request("muscle", asked).weights

    from surae.recording import read
    from surae.report import check_report

    check_report(report)
    measured = [read(path) for path in recordings]
    check_outputs(
        {"--output": output, "--report": report},
        [fitted, *(f.path for one in measured for f in one.files)],
    )

    from surae.api import load, validate  # numba: only when the input is in order
    from surae.cli.progress import compilation_notice
    from surae.cli.screen import show_line, show_predictions

    fit = load(fitted)
    with compilation_notice():
        predictions = validate(fit, measured, prepared=prepared, weights=weighting)
    if output is not None:
        write_json(output, {"recordings": _table(recordings, predictions)})
    show_predictions(predictions, recordings)
    used = {file.sha256 for one in fit.result.problem.inputs for file in one.files}
    for path, one in zip(recordings, measured, strict=True):
        if any(file.sha256 in used for file in one.files):
            show_line(f"{shown(path)} was used in the fit: following it proves nothing")
    if output is not None:
        show_line(f"validation: {shown(output)}")
    if report is not None:
        fit.report(report, validation=predictions)
        show_line(f"report: {shown(report)}")


def _leave_one_out(
    paths: tuple[str, ...], settings: "FitSettings", mvc: tuple[str, ...], output: str | None
) -> None:
    """Predict each recording with a fit of the others."""
    check_recordings(paths)

    from surae.cli.progress import compilation_notice, work

    with work() as progress:
        measured, contractions = read_all(paths, progress), read_all(mvc, progress)
        check_outputs(
            {"--output": output},
            [file.path for one in (*measured, *contractions) for file in one.files],
        )
        from surae.api import leave_one_out  # numba: only when the input is in order
        from surae.cli.screen import show_line, show_predictions

        with compilation_notice():
            found = leave_one_out(
                measured,
                settings,
                mvc=contractions,
                progress=lambda name, done, total: progress.describe(
                    f"fitting without {name} ({done + 1} of {total})"
                ),
            )
    if output is not None:
        rows = _table(paths, found.predictions)
        for row, one in zip(rows, found.recordings, strict=True):
            row |= {"status": one.fit.status, "parameters": dict(one.fit.values)}
        write_json(
            output, {"model": settings.model, "recordings": rows, "pooled": _figures(found.pooled)}
        )
    show_predictions(found.predictions, paths, found.pooled)
    for path, one in zip(paths, found.recordings, strict=True):
        if one.fit.status != "converged":
            show_line(f"without {shown(path)}: {one.fit.status}, {one.fit.message}")
    if output is not None:
        show_line(f"validation: {shown(output)}")


def _table(paths: Sequence[str], predictions: Sequence["Prediction"]) -> list[dict[str, Any]]:
    return [{"path": path, **_figures(one)} for path, one in zip(paths, predictions, strict=True)]


def _figures(one: "Prediction | Pooled") -> dict[str, Any]:
    return {"vaf": one.vaf, "rmse_Nm": one.rmse, "bias_Nm": one.bias}
