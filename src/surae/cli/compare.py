"""`surae compare`."""

from typing import Any

import click

from surae import api, names
from surae.cli.fit import read_all
from surae.cli.options import MODEL_NAMES, request, request_options
from surae.cli.paths import check_outputs, check_recordings
from surae.cli.progress import StoppedError, compilation_notice, work
from surae.cli.screen import show_comparison, show_files
from surae.errors import ComputationError, InputError

#: Starts of every model unless told otherwise.
_FEW_STARTS = 3


@click.command("compare")
@click.argument("recordings", metavar="REC…", nargs=-1, required=True)
@click.option("--models", metavar="M,M…",
              help=f"Which, with commas, of {MODEL_NAMES}.  "
              "[default: all but muscle-2010]")  # fmt: skip
@request_options("model")
@click.option("--output", metavar="C.json", help="Write the comparison.")
def command(
    recordings: tuple[str, ...],
    models: str | None,
    options: dict[str, Any],
    mvc: tuple[str, ...],
    output: str | None,
) -> None:
    """Tell whether recordings ask for compliant tendons, and what those change.

    Every model is fitted to all data, from three starts unless told otherwise, and then predicts
    what it was not fitted to: each of several recordings in turn, or each quarter of a single one.
    Options go to every model that has the parameter. Ctrl-C keeps the fits that are complete.
    """
    everything = [name for name in names.MODELS if name != "muscle-2010"]
    chosen = everything if models is None else [name.strip() for name in models.split(",")]
    if not all(chosen):
        raise InputError(f"--models {models}: write names with commas, e.g. muscle,muscle-tendon")
    settings = request({"starts": _FEW_STARTS} | options)
    check_recordings(recordings)

    with work() as progress:
        measured, contractions = read_all(recordings, progress), read_all(mvc, progress)
        check_outputs(
            {"--output": output},
            (file.path for recording in (*measured, *contractions) for file in recording.files),
        )
        with compilation_notice():
            comparison = api.compare(
                measured, chosen, settings, mvc=contractions,
                progress=lambda what, done, total: progress.describe(
                    f"fit {done + 1} of {total}: {what}"
                ),
            )  # fmt: skip

    if output is not None:
        comparison.save(output)
    show_comparison(comparison)
    show_files({"comparison": output})
    if comparison.missing:
        written = " and written" if output is not None else ""
        raise StoppedError(f"stopped by the user; what is complete is shown{written}")
    if comparison.finding is None:
        raise ComputationError(comparison.conclusion)
