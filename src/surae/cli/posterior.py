"""`surae posterior`."""

from typing import Any

import click

from surae import api
from surae.cli.options import Picture, settings_options
from surae.cli.paths import check_outputs
from surae.cli.progress import StoppedError, compilation_notice, work
from surae.cli.screen import Columns, ends_text, show_files, show_line, show_table
from surae.errors import ComputationError
from surae.requests import PosteriorSettings

#: Variance inflations that differ by less than this part are the same.
_SAME = 0.05


@click.command("posterior")
@click.argument("fitted", metavar="FIT.json")
@settings_options(PosteriorSettings)
@click.option("--profile", "profiled", metavar="PROFILE.json", help="Show its intervals beside.")
@click.option("--output", metavar="POSTERIOR.json", help="Write the posterior with its draws.")
@click.option("--figure", type=Picture(), metavar="POSTERIOR.svg|pdf|png", help="Draw it.")
def command(
    fitted: str,
    profiled: str | None,
    output: str | None,
    figure: str | None,
    options: dict[str, Any],
) -> None:
    """Draw from the posterior of a fit: its recordings and prior knowledge together.

    Priors take the place of the fit's bounds; POSTERIOR.json says which. Needs the extra bayes:
    pip install "surae[bayes]". Ctrl-C keeps what is drawn.
    """
    read = [fitted] if profiled is None else [fitted, profiled]
    check_outputs({"--output": output, "--figure": figure}, read)

    fit = api.load(fitted)
    intervals = None
    if profiled is not None:
        intervals = api.read_profile_intervals(profiled, fit.values, fit.result.problem.spec.name)
    with work() as progress, compilation_notice():

        def tell(done: int, total: int) -> None:
            progress.describe(f"posterior: {100 * done / total:.0f} % drawn")

        tell(0, 1)
        drawn = api.posterior(fit, progress=tell, **options)

    compared = api.agreements(drawn, intervals)
    if output is not None:
        drawn.save(output)
    if figure is not None:
        ends = {name: interval.ends for name, interval in (intervals or {}).items()}
        api.write_figure(figure, api.posterior_figure(drawn, ends))
    show_table(*_table(drawn, compared))
    for line in _notes(drawn, compared):
        show_line(line)
    show_files({"posterior": output, "figure": figure})
    if not drawn.whole:
        raise StoppedError("stopped by the user; what was drawn is shown")
    if drawn.status != "converged":
        raise ComputationError(f"not converged: {drawn.message}")


def _table(drawn: "api.Posterior", compared: "dict[str, api.Agreement]") -> Columns:
    """The intervals of posterior, covariance and profile beside each other, and diagnostics."""
    profiled = any(agreement.profile is not None for agreement in compared.values())
    heads = ("parameter", "median", "95 % credible", "95 % covariance",
             *(["95 % profile"] if profiled else []), "R-hat", "draws", "unit")  # fmt: skip
    rows = []
    for name, marginal in drawn.marginals.items():
        seen, beside = marginal.convergence, compared[name].profile
        rows.append((
            name, api.significant(marginal.median, 4),
            ends_text(marginal.ci95), ends_text(marginal.from_covariance),
            *([ends_text(None if beside is None else beside.ends)] if profiled else []),
            api.NO_NUMBER if seen.rhat is None else f"{seen.rhat:.3f}",
            f"{min(seen.ess_bulk or 0.0, seen.ess_tail or 0.0):.0f}", marginal.unit,
        ))  # fmt: skip
    return heads, rows


def _notes(drawn: "api.Posterior", compared: "dict[str, api.Agreement]") -> list[str]:
    """Say where intervals part, what rests on priors, and whether the draws can be believed."""
    lines = []
    for what, off in (
        ("covariance", {n: agreement.off_covariance for n, agreement in compared.items()}),
        ("profile", {n: agreement.off_profile for n, agreement in compared.items()}),
    ):
        known = {name: value for name, value in off.items() if value is not None}
        apart = {name: value for name, value in known.items() if value > api.AGREEMENT_TOLERANCE}
        if apart:
            named = ", ".join(f"{name} by {100 * value:.0f} %" for name, value in apart.items())
            lines.append(
                f"other than the {what} (an end differs, in half-widths of the credible interval): "
                f"{named}"
            )
        elif known:
            within = f"{100 * api.AGREEMENT_TOLERANCE:.0f} % of a half-width"
            lines.append(f"as the {what}: all ends within {within}")
    other = [
        name
        for name, agreement in compared.items()
        if agreement.profile is not None
        and abs(agreement.profile.variance_inflation / drawn.variance_inflation - 1) > _SAME
    ]
    if other:
        lines.append(
            "the profiles count the noise more or less than the posterior does (the same "
            f"--variance-inflation makes them alike) for: {', '.join(other)}"
        )
    prior = [name for name, marginal in drawn.marginals.items() if marginal.of_prior]
    if prior:
        lines.append(f"mostly from the prior, the recordings add little: {', '.join(prior)}")
    lines.append(drawn.noise)
    lines.append(f"{drawn.status}: {drawn.message} ({drawn.seconds:.1f} s)")
    return lines
