"""`surae posterior`."""

from typing import Any

import click

from surae import api
from surae.cli.options import settings_options
from surae.cli.paths import check_outputs
from surae.cli.progress import StoppedError, compilation_notice, work
from surae.cli.screen import Columns, ends_text, show_files, show_line, show_table
from surae.errors import ComputationError
from surae.requests import PosteriorSettings

#: Ends of intervals agree when they lie within this part of the credible interval's half-width;
#: with enough draws, chance moves them by less than a third of it.
_AGREE = 0.25


@click.command("posterior")
@click.argument("fitted", metavar="FIT.json")
@settings_options(PosteriorSettings)
@click.option("--output", metavar="POSTERIOR.json", help="Write the posterior with its draws.")
def command(fitted: str, output: str | None, options: dict[str, Any]) -> None:
    """Draw from the posterior of a named model's fit: recordings and prior knowledge.

    A fit of auto is a posterior already. Priors take the place of bounds; POSTERIOR.json says
    which. Ctrl-C keeps what is drawn.
    """
    check_outputs({"--output": output}, [fitted])

    fit = api.load(fitted)
    with work() as progress, compilation_notice():

        def tell(done: int, total: int) -> None:
            progress.describe(f"posterior: {100 * done / total:.0f} % drawn")

        tell(0, 1)
        drawn = api.posterior(fit, progress=tell, **options)

    if output is not None:
        drawn.save(output)
    show_table(*_table(drawn))
    for line in _notes(drawn):
        show_line(line)
    show_files({"posterior": output})
    if not drawn.whole:
        raise StoppedError("stopped by the user; what was drawn is shown")
    if drawn.status != "reliable":
        raise ComputationError(f"not reliable: {drawn.message}")


def _table(drawn: "api.Posterior") -> Columns:
    """The intervals of posterior and covariance beside each other."""
    heads = ("parameter", "median", "95 % credible", "95 % covariance", "unit")
    rows: list[tuple[str, ...]] = []
    for name, marginal in drawn.marginals.items():
        rows.append((
            name, api.NO_NUMBER if marginal.median is None else api.significant(marginal.median, 4),
            ends_text(marginal.ci95), ends_text(marginal.from_covariance), marginal.unit,
        ))  # fmt: skip
    return heads, rows


def _notes(drawn: "api.Posterior") -> list[str]:
    """Say where intervals part, what rests on priors, and whether the draws can be believed."""
    off = {name: marginal.off_covariance for name, marginal in drawn.marginals.items()}
    known = {name: value for name, value in off.items() if value is not None}
    apart = [f"{name} by {100 * value:.0f} %" for name, value in known.items() if value > _AGREE]
    lines = []
    if apart:
        lines.append(
            "other than the covariance (an end differs, in half-widths of the credible interval): "
            + ", ".join(apart)
        )
    elif known:
        lines.append(f"as the covariance: all ends within {100 * _AGREE:.0f} % of a half-width")
    prior = [name for name, marginal in drawn.marginals.items() if marginal.of_prior]
    if prior:
        lines.append(f"mostly from the prior, the recordings add little: {', '.join(prior)}")
    lines.append(drawn.noise)
    lines.append(f"{drawn.status}: {drawn.message} ({drawn.seconds:.1f} s)")
    return lines
