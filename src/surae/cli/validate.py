"""`surae validate`."""

from collections.abc import Sequence
from typing import TYPE_CHECKING, Any

import click

from surae.cli.fitting import fit_options, taken
from surae.cli.options import (
    MODEL_NAMES,
    assignments,
    given,
    model_options,
    pairs,
    whole_number,
)
from surae.cli.paths import check_outputs, refuse_repeated
from surae.errors import InputError
from surae.files import shown, write_json

if TYPE_CHECKING:
    from surae.assessment import Pooled, Prediction

#: More starts than this are a slip of the keyboard.
_MOST_STARTS = 10_000


@click.command("validate")
@click.argument("fitted", metavar="FIT.json")
@click.argument("recordings", metavar="REC…", nargs=-1, required=True)
@click.option("--leave-one-out", is_flag=True,
              help="Take recordings only; predict each with a fit of the others.")  # fmt: skip
@click.option("--prepared/--unprepared", default=None,
              help="Signals as they are, or filtered; by default as in the fit.")  # fmt: skip
@click.option("--output", metavar="V.json", help="Write the figures.")
@click.option("--report", metavar="V.html", help="Write the fit's report with the predictions.")
@click.option("--model", metavar="M", help=f"Leave one out: {MODEL_NAMES}.  [default: muscle]")
@click.option("--fixed", multiple=True, metavar="NAME=VALUE",
              help="Leave one out: do not estimate a parameter.")  # fmt: skip
@click.option("--prior", multiple=True, metavar="NAME=MEDIAN:SPREAD",
              help="Leave one out: known beforehand.")  # fmt: skip
@click.option("--starts", metavar="N", help="Leave one out: starts of each fit.  [default: 8]")
@click.option("--seed", metavar="N", help="Leave one out: of the random starts.  [default: 0]")
@fit_options
@model_options
def command(
    fitted: str,
    recordings: tuple[str, ...],
    leave_one_out: bool,
    prepared: bool | None,
    output: str | None,
    report: str | None,
    **options: Any,
) -> None:
    """Predict the torque of other recordings with the parameters of a fit.

    With --leave-one-out there is no FIT.json: REC REC [REC…] are recordings of one leg, and each is
    predicted with the parameters of a fit of all the others. All options of the fit go with it;
    --exclude goes with both.
    """
    if leave_one_out:
        if report is not None:
            raise InputError("--report shows one fit, and --leave-one-out makes several; give one")
        _leave_one_out((fitted, *recordings), bool(prepared), output, options)
        return
    excluded = options["exclude"]
    for name, value in options.items():
        if value not in (None, (), False) and name != "exclude":
            option = "priors" if name == "population" else name.replace("_", "-")
            raise InputError(f"--{option} has no effect without --leave-one-out")
    weighting = taken(options | {"exclude": excluded}).weighting

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
        _write(output, {"recordings": _table(recordings, predictions)})
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
    paths: tuple[str, ...], prepared: bool, output: str | None, options: dict[str, Any]
) -> None:
    """Predict each recording with a fit of the others."""
    held = assignments("--fixed", options.pop("fixed"))
    known = pairs("--prior", options.pop("prior"), form="median:spread", example="tau_rel=3:0.3")
    count = whole_number("--starts", options.pop("starts"), least=1, most=_MOST_STARTS)
    number = whole_number("--seed", options.pop("seed"), least=0) or 0
    model = options.pop("model") or "muscle"
    settings = taken(options, tuple(held))
    chosen = given(options)
    refuse_repeated(paths)

    from surae.cli.progress import compilation_notice, work
    from surae.recording import read
    from surae.signals import prepare

    inputs = [prepare(read(path), prepared=prepared) for path in paths]
    check_outputs({"--output": output}, [f.path for one in inputs for f in one.files])

    from surae.api import leave_one_out  # numba: only when the input is in order
    from surae.cli.screen import show_line, show_predictions
    from surae.estimation import STARTS

    with work() as progress, compilation_notice():
        found = leave_one_out(
            settings.prescribed(inputs, prepared),
            model,
            fixed=held,
            priors=settings.priors(known),
            weights=settings.weighting,
            loss=settings.loss,
            starts=count or STARTS,
            seed=number,
            progress=lambda name, done, total: progress.describe(
                f"fitting without {name} ({done + 1} of {total})"
            ),
            **chosen,
        )
    if output is not None:
        rows = _table(paths, found.predictions)
        for row, one in zip(rows, found.recordings, strict=True):
            row |= {"status": one.fit.status, "parameters": dict(one.fit.values)}
        _write(output, {"model": model, "recordings": rows, "pooled": _figures(found.pooled)})
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


def _write(path: str, content: dict[str, Any]) -> None:
    write_json(path, content)
