"""`surae reassess`."""

import warnings

import click

from surae import api
from surae.cli.paths import check_outputs
from surae.cli.progress import compilation_notice
from surae.cli.screen import show_answer, show_files


@click.command("reassess")
@click.argument("fitted", metavar="FIT.json|DIR")
@click.option("--output", metavar="FIT.json", help="Write the fit with the new verdicts.")
def command(fitted: str, output: str | None) -> None:
    """Judge a saved fit as this version of surae does; its values stay.

    A fit that is read keeps the verdicts it was given. This gives it new ones.
    """
    check_outputs({"--output": output}, [fitted])
    with compilation_notice(), warnings.catch_warnings():
        warnings.simplefilter("ignore")  # what differs is renewed
        fit = api.fit_of(fitted).reassess()
    if output is not None:
        fit.save(output)
    show_answer(fit.as_table())
    show_files({"fit": output})
