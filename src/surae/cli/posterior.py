"""`surae posterior`."""

from collections.abc import Sequence
from pathlib import Path
from typing import TYPE_CHECKING

import click

from surae.cli.options import factor, pairs, whole_number
from surae.cli.paths import check_outputs
from surae.errors import InputError
from surae.files import shown, write_atomic

if TYPE_CHECKING:
    from surae.assessment.posterior.agreement import Agreement
    from surae.assessment.posterior.sample import Posterior

#: More of anything than this is a slip of the keyboard.
_MOST_DRAWS, _MOST_CHAINS, _MOST_CORES = 1_000_000, 100, 1000
_FEWEST_DRAWS = 10
#: Variance inflations that differ by less than this part are the same.
_SAME = 0.05


@click.command("posterior")
@click.argument("fitted", metavar="FIT.json")
@click.option("--draws", metavar="N", help="Draws of each chain.  [default: 1000]")
@click.option("--tune", metavar="N", help="Draws that tune the sampler first.  [default: 300]")
@click.option("--chains", metavar="N", help="Number of chains.  [default: 4]")
@click.option("--seed", metavar="N", help="Of the draws.  [default: 0]")
@click.option("--cores", metavar="N", help="Chains at a time.  [default: all processors]")
@click.option("--prior", multiple=True, metavar="NAME=MEDIAN:SPREAD",
              help="Known beforehand, instead of the defaults.")  # fmt: skip
@click.option("--variance-inflation", metavar="F",
              help="Factor on the variance of the noise.  [default: what the residual's "
              "correlation asks for]")  # fmt: skip
@click.option("--profile", "profiled", metavar="PROFILE.json", help="Show its intervals beside.")
@click.option("--output", metavar="POSTERIOR.json", help="Write the posterior with its draws.")
@click.option("--figure", metavar="POSTERIOR.png|svg", help="Draw it.")
def command(
    fitted: str,
    draws: str | None,
    tune: str | None,
    chains: str | None,
    seed: str | None,
    cores: str | None,
    prior: tuple[str, ...],
    variance_inflation: str | None,
    profiled: str | None,
    output: str | None,
    figure: str | None,
) -> int:
    """Draw from the posterior of a fit: its recordings and prior knowledge together.

    Priors take the place of the fit's bounds; POSTERIOR.json says which. Needs the extra bayes:
    pip install "surae[bayes]". Ctrl-C keeps what is drawn.
    """
    known = pairs("--prior", prior, form="median:spread", example="tau_rel=3:0.3")
    numbers = {
        "draws": whole_number("--draws", draws, least=_FEWEST_DRAWS, most=_MOST_DRAWS),
        "tune": whole_number("--tune", tune, least=_FEWEST_DRAWS, most=_MOST_DRAWS),
        "chains": whole_number("--chains", chains, least=2, most=_MOST_CHAINS),
        "seed": whole_number("--seed", seed, least=0, most=2**63),
        "cores": whole_number("--cores", cores, least=1, most=_MOST_CORES),
    }
    given = {name: value for name, value in numbers.items() if value is not None}
    inflation = factor("--variance-inflation", variance_inflation)
    kind = "" if figure is None else Path(figure).suffix.lower()
    if figure is not None and kind not in (".png", ".svg"):
        raise InputError(f"--figure: {shown(figure)} must end in .png or .svg")
    read = [fitted] if profiled is None else [fitted, profiled]
    check_outputs({"--output": output, "--figure": figure}, read)

    from surae.api import load, posterior  # numba: only when the command is in order
    from surae.assessment.posterior.agreement import agreements, read_profile_intervals
    from surae.cli.progress import compilation_notice, work

    fit = load(fitted)
    intervals = None
    if profiled is not None:
        intervals = read_profile_intervals(profiled, fit.values, fit.result.problem.spec.name)
    with work() as progress, compilation_notice():

        def told(done: int, total: int) -> None:
            progress.describe(f"posterior: {100 * done / total:.0f} % drawn")

        told(0, 1)
        found = posterior(fit, priors=known, variance_inflation=inflation, progress=told, **given)

    from surae.cli.screen import show_line

    compared = agreements(found, intervals)
    if output is not None:
        found.save(output)
    if figure is not None:
        from surae.report.figures import png, svg
        from surae.report.figures.posterior import posterior_figure

        picture = posterior_figure(found, {n: one.ends for n, one in (intervals or {}).items()})
        write_atomic(figure, svg(picture) if kind == ".svg" else png(picture))
    for line in [*_table(found, compared), "", *_notes(found, compared)]:
        show_line(line)
    if output is not None:
        show_line(f"posterior: {shown(output)}")
    if figure is not None:
        show_line(f"figure: {shown(figure)}")
    if not found.whole:
        click.echo("surae: stopped by the user; what was drawn is shown", err=True)
        return 130
    if found.status != "converged":
        click.echo(f"surae: not converged: {found.message}", err=True)
        return 1
    return 0


def _table(found: "Posterior", compared: "dict[str, Agreement]") -> list[str]:
    """The intervals of posterior, covariance and profile beside each other, and diagnostics."""
    from surae.report.digits import NONE, significant

    def interval(ends: Sequence[float | None] | None) -> str:
        if ends is None:
            return NONE
        return " … ".join("open" if end is None else significant(end, 4) for end in ends)

    with_profile = any(one.profile is not None for one in compared.values())
    heads = ["parameter", "median", "95 % credible", "95 % covariance", "95 % profile", "unit",
             "R-hat", "draws"]  # fmt: skip
    rows = [heads]
    for name, one in found.marginals.items():
        seen, beside = one.convergence, compared[name].profile
        rows.append(
            [
                name,
                significant(one.median, 4),
                interval(one.ci95),
                interval(one.from_covariance),
                interval(None if beside is None else beside.ends),
                one.unit,
                NONE if seen.rhat is None else f"{seen.rhat:.3f}",
                f"{min(seen.ess_bulk or 0.0, seen.ess_tail or 0.0):.0f}",
            ]
        )
    left = ("parameter", "unit")
    columns = [
        column for column in zip(*rows, strict=True) if with_profile or column[0] != heads[4]
    ]
    widths = [max(map(len, column)) for column in columns]
    return [
        "  ".join(
            cell.ljust(width) if column[0] in left else cell.rjust(width)
            for cell, column, width in zip(row, columns, widths, strict=True)
        ).rstrip()
        for row in zip(*columns, strict=True)
    ]


def _notes(found: "Posterior", compared: "dict[str, Agreement]") -> list[str]:
    """Where intervals part, what rests on priors, and whether the draws can be believed."""
    from surae.assessment.posterior.agreement import AGREES

    lines = []
    for what, off in (
        ("covariance", {name: one.off_covariance for name, one in compared.items()}),
        ("profile", {name: one.off_profile for name, one in compared.items()}),
    ):
        known = {name: value for name, value in off.items() if value is not None}
        apart = {name: value for name, value in known.items() if value > AGREES}
        if apart:
            named = ", ".join(f"{name} by {100 * value:.0f} %" for name, value in apart.items())
            lines.append(
                f"other than the {what} (an end differs, in half-widths of the credible interval): "
                f"{named}"
            )
        elif known:
            lines.append(f"as the {what}: all ends within {100 * AGREES:.0f} % of a half-width")
    other = [
        name
        for name, one in compared.items()
        if one.profile is not None
        and abs(one.profile.variance_inflation / found.variance_inflation - 1) > _SAME
    ]
    if other:
        lines.append(
            "the profiles count the noise more or less than the posterior does (the same "
            f"--variance-inflation makes them alike) for: {', '.join(other)}"
        )
    prior = [name for name, one in found.marginals.items() if one.of_prior]
    if prior:
        lines.append(f"mostly from the prior, the recordings add little: {', '.join(prior)}")
    lines.append(found.noise)
    lines.append(f"{found.status}: {found.message} ({found.seconds:.1f} s)")
    return lines
