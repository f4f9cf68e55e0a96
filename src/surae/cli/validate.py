"""`surae validate`."""

from collections.abc import Sequence
from typing import Any

import click

from surae import api
from surae.base.files import shown, write_json
from surae.cli.options import EXCLUDE, MAPPING, corrections
from surae.cli.paths import check_outputs, in_folders
from surae.cli.progress import compilation_notice
from surae.cli.screen import show_files, show_line, show_predictions


@click.command("validate")
@click.argument("fitted", metavar="FIT.json|DIR")
@click.argument("recordings", metavar="REC…|DIR", nargs=-1, required=True)
@MAPPING
@corrections
@click.option(
    "--prepared/--unprepared",
    default=None,
    help="Signals as they are, or filtered; by default as in the fit.",
)
@EXCLUDE
@click.option("--output", metavar="V.json", help="Write the figures.")
@click.option("--report", metavar="V.html", help="Write the fit's report with the predictions.")
def command(
    fitted: str,
    recordings: tuple[str, ...],
    mapping: str | None,
    prepared: bool | None,
    exclude: tuple[tuple[float, float, float], ...],
    output: str | None,
    report: str | None,
    corrections: dict[str, Any],
) -> None:
    """Predict the torque of other recordings with the parameters of a fit.

    DIR is the folder of a session, whose joint fit is taken. Beside each prediction stands what is
    predicted without a model.
    """
    recordings = in_folders(recordings, mapping)
    api.check_report(report)
    measured = [api.read(path, mapping=mapping, **corrections) for path in recordings]
    check_outputs(
        {"--output": output, "--report": report},
        [fitted, *(f.path for recording in measured for f in recording.files)],
    )

    fit = api.fit_of(fitted)
    weights = api.Weighting(exclude) if exclude else None
    with compilation_notice():
        predictions = api.validate(fit, measured, prepared=prepared, weights=weights)
    if output is not None:
        write_json(output, {"recordings": _table(recordings, predictions)})
    show_predictions(predictions, recordings)
    used = {file.sha256 for recording in fit.result.problem.inputs for file in recording.files}
    for path, recording in zip(recordings, measured, strict=True):
        if any(file.sha256 in used for file in recording.files):
            show_line(f"{shown(path)} was used in the fit, so agreement is no test")
    if report is not None:
        fit.report(report, validation=predictions)
    show_files({"validation": output, "report": report})


def _table(paths: Sequence[str], predictions: Sequence["api.Prediction"]) -> list[dict[str, Any]]:
    from surae.base.records import to_plain  # numpy, only when it is used

    rows = []
    for path, p in zip(paths, predictions, strict=True):
        row = {"path": path, "vaf": p.vaf, "rmse_Nm": p.rmse, "bias_Nm": p.bias}
        if (covers := p.covers) is not None:
            row["torque_ci95_covers"] = covers
        for name in ("template", "ridge"):
            row[f"{name}_vaf"] = getattr(p.baselines, name)
            if reason := getattr(p.baselines, f"{name}_reason"):
                row[f"{name}_reason"] = reason
        if p.simplest_vaf is not None:
            row["simplest_vaf"] = p.simplest_vaf
            row["simplest_share"] = p.simplest
        if (judged := p.adequacy) is not None:
            row |= {"r2": judged.r2, "grade": str(judged.grade), "reasons": list(judged.reasons)}
        if p.fascicles:
            row["fascicles"] = [to_plain(film.quality) for film in p.fascicles]
        rows.append(row)
    return rows
