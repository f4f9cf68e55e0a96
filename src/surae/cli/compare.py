"""`surae compare`."""

from typing import Any

import click

from surae.cli.options import MODEL_NAMES, assignments, given, model_options, whole_number
from surae.cli.paths import check_outputs, refuse_repeated
from surae.errors import InputError
from surae.files import shown

#: More starts than this are a slip of the keyboard.
_MOST_STARTS = 10_000


@click.command("compare")
@click.argument("recordings", metavar="REC…", nargs=-1, required=True)
@click.option("--models", metavar="M,M…",
              help=f"Which, with commas, of {MODEL_NAMES}.  "
              "[default: all but muscle-2010]")  # fmt: skip
@click.option("--prepared", is_flag=True, help="Use the signals as they are, without filters.")
@click.option("--fixed", multiple=True, metavar="NAME=VALUE", help="Do not estimate a parameter.")
@click.option("--starts", metavar="N", help="Number of starts of each model.  [default: 3]")
@click.option("--seed", metavar="N", help="Of the random starts.  [default: 0]")
@click.option("--output", metavar="C.json", help="Write the comparison.")
@model_options
def command(
    recordings: tuple[str, ...],
    models: str | None,
    prepared: bool,
    fixed: tuple[str, ...],
    starts: str | None,
    seed: str | None,
    output: str | None,
    **options: Any,
) -> int:
    """Tell whether recordings ask for compliant tendons, and what those change.

    Every model is fitted to all data and then predicts what it was not fitted to: each of several
    recordings in turn, or each quarter of a single one. Ctrl-C keeps the fits that are complete.
    """
    held, chosen = assignments("--fixed", fixed), given(options)
    names = None if models is None else [name.strip() for name in models.split(",")]
    if names is not None and not all(names):
        raise InputError(f"--models {models}: write names with commas, e.g. muscle,muscle-tendon")
    count = whole_number("--starts", starts, least=1, most=_MOST_STARTS)
    number = whole_number("--seed", seed, least=0) or 0
    refuse_repeated(recordings)

    from surae.cli.progress import compilation_notice, work
    from surae.recording import read
    from surae.signals import prepare

    with work() as progress:
        inputs = []
        for path in recordings:
            progress.describe(f"reading {path}")
            inputs.append(prepare(read(path), prepared=prepared))
        check_outputs({"--output": output}, (file.path for one in inputs for file in one.files))
        from surae.api import compare  # numba: only when the input is in order
        from surae.assessment.comparison.compare import COMPARED, FEW_STARTS

        def told(what: str, done: int, total: int) -> None:
            progress.describe(f"fit {done + 1} of {total}: {what}")

        with compilation_notice():
            comparison = compare(
                inputs,
                names or COMPARED,
                fixed=held,
                starts=count or FEW_STARTS,
                seed=number,
                progress=told,
                **chosen,
            )

    from surae.cli.screen import show_comparison, show_line

    if output is not None:
        comparison.save(output)
    show_comparison(comparison)
    if output is not None:
        show_line(f"comparison: {shown(output)}")
    if comparison.missing:
        click.echo(
            "surae: stopped by the user; what is complete is shown"
            + (" and written" if output is not None else ""),
            err=True,
        )
        return 130
    if comparison.finding is None:
        click.echo(f"surae: {comparison.conclusion}", err=True)
        return 1
    return 0
