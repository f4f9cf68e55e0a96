"""`surae validate`."""

from collections.abc import Sequence
from typing import Any

import click

from surae import api, names
from surae.cli.fit import read_all
from surae.cli.options import MODEL_NAMES, figure_options, flag, request, request_options
from surae.cli.paths import check_outputs, check_recordings
from surae.cli.progress import compilation_notice, work
from surae.cli.screen import show_files, show_line, show_predictions
from surae.errors import InputError
from surae.files import shown, write_json


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
@request_options("model", "prepared")
@figure_options
def command(
    fitted: str,
    recordings: tuple[str, ...],
    leave_one_out: bool,
    prepared: bool | None,
    output: str | None,
    report: str | None,
    model: str | None,
    options: dict[str, Any],
    mvc: tuple[str, ...],
    figure: str | None,
    width: float,
) -> None:
    """Predict the torque of other recordings with the parameters of a fit.

    With --leave-one-out there is no FIT.json: REC REC [REC…] are recordings of one leg, and each is
    predicted with the parameters of a fit of all the others. All options of the fit go with it;
    --exclude goes with both.
    """
    if leave_one_out:
        if report is not None:
            raise InputError("--report shows one fit, and --leave-one-out makes several; give one")
        settings = request(options | {"model": model or "muscle", "prepared": bool(prepared)})
        _leave_one_out((fitted, *recordings), settings, mvc, output, figure, width)
        return
    for name, value in {**options, "model": model, "mvc": mvc}.items():
        if value and name != "exclude":
            raise InputError(f"{flag(name)} has no effect without --leave-one-out")
    weighting = request(options).weights

    api.check_report(report)
    measured = [api.read(path) for path in recordings]
    check_outputs(
        {"--output": output, "--report": report, "--figure": figure},
        [fitted, *(f.path for recording in measured for f in recording.files)],
    )

    fit = api.load(fitted)
    with compilation_notice():
        predictions = api.validate(fit, measured, prepared=prepared, weights=weighting)
    if output is not None:
        write_json(output, {"recordings": _table(recordings, predictions)})
    show_predictions(predictions, recordings)
    used = {file.sha256 for recording in fit.result.problem.inputs for file in recording.files}
    for path, recording in zip(recordings, measured, strict=True):
        if any(file.sha256 in used for file in recording.files):
            show_line(f"{shown(path)} was used in the fit: following it proves nothing")
    if report is not None:
        fit.report(report, validation=predictions)
    if figure is not None:
        fit.figure(figure, validation=predictions, width=width)
    show_files({"validation": output, "report": report, "figure": figure})


def _leave_one_out(
    paths: tuple[str, ...],
    settings: "api.FitSettings",
    mvc: tuple[str, ...],
    output: str | None,
    figure: str | None,
    width: float,
) -> None:
    """Predict each recording with a fit of the others."""
    check_recordings(paths)

    with work() as progress:
        measured, contractions = read_all(paths, progress), read_all(mvc, progress)
        check_outputs(
            {"--output": output, "--figure": figure},
            [file.path for recording in (*measured, *contractions) for file in recording.files],
        )

        with compilation_notice():
            left_out = api.leave_one_out(
                measured,
                settings,
                mvc=contractions,
                progress=lambda name, done, total: progress.describe(
                    f"fitting without {name} ({done + 1} of {total})"
                ),
            )
    if output is not None:
        rows = _table(paths, left_out.predictions)
        for row, recording in zip(rows, left_out.recordings, strict=True):
            row |= {"status": recording.fit.status, "parameters": dict(recording.fit.values)}
        write_json(
            output,
            {"model": settings.model, "recordings": rows, "pooled": _figures(left_out.pooled)},
        )
    show_predictions(left_out.predictions, paths, left_out.pooled)
    for path, recording in zip(paths, left_out.recordings, strict=True):
        if recording.fit.status != "converged":
            show_line(f"without {shown(path)}: {recording.fit.status}, {recording.fit.message}")
    if figure is not None:
        drawn = api.predictions_figure(left_out.predictions, width=width / 25.4)
        api.write_figure(figure, drawn)
    show_files({"validation": output, "figure": figure})


def _table(paths: Sequence[str], predictions: Sequence["api.Prediction"]) -> list[dict[str, Any]]:
    return [
        {"path": path, **_figures(prediction), **_judged(prediction), **_filmed(prediction)}
        for path, prediction in zip(paths, predictions, strict=True)
    ]


def _filmed(prediction: "api.Prediction") -> dict[str, Any]:
    from surae.records import to_plain  # numpy, only when it is used

    each = [to_plain(film.quality) for film in prediction.fascicles]
    return {"fascicles": each} if each else {}


def _judged(prediction: "api.Prediction") -> dict[str, Any]:
    judged = prediction.adequacy
    if judged is None:
        return {}
    return {"r2": judged.r2, "grade": str(judged.grade), "reasons": list(judged.reasons)}


def _figures(prediction: "api.Prediction | api.PooledPrediction") -> dict[str, Any]:
    return {"vaf": prediction.vaf, "rmse_Nm": prediction.rmse, "bias_Nm": prediction.bias}
