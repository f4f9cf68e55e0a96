"""`surae posterior`."""

from typing import Any

import click

from surae import api
from surae.base.errors import ComputationError
from surae.cli.options import settings_options
from surae.cli.paths import check_outputs
from surae.cli.progress import StoppedError, compilation_notice, work
from surae.cli.screen import show_answer, show_files


@click.command("posterior")
@click.argument("fitted", metavar="FIT.json|DIR")
@settings_options(api.PosteriorSettings)
@click.option("--output", metavar="POSTERIOR.json", help="Write the posterior with its draws.")
def command(fitted: str, output: str | None, options: dict[str, Any]) -> None:
    """Draw from the posterior of a named model's fit: recordings and prior knowledge.

    A fit of auto is a posterior already. Priors take the place of bounds; POSTERIOR.json says
    which. Ctrl-C keeps what is drawn.
    """
    check_outputs({"--output": output}, [fitted])

    fit = api.fit_of(fitted)
    with work() as progress, compilation_notice():

        def tell(done: int, total: int) -> None:
            progress.describe(f"posterior: {100 * done / total:.0f} % drawn")

        tell(0, 1)
        drawn = api.posterior(fit, progress=tell, **options)

    if output is not None:
        drawn.save(output)
    show_answer(drawn.as_table())
    show_files({"posterior": output})
    if not drawn.whole:
        raise StoppedError("stopped by the user; what was drawn is shown")
    if drawn.status != "reliable":
        raise ComputationError(f"not reliable: {drawn.message}")
