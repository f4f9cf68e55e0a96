"""`surae emg-bias`."""

from typing import TYPE_CHECKING

import click

from surae.cli.options import number, whole_number
from surae.cli.paths import check_outputs
from surae.files import shown

if TYPE_CHECKING:
    from surae.api import Fit
    from surae.assessment.resampling.emg_bias import EmgBias

#: More pairs and threads than these are slips of the keyboard.
_MOST, _MOST_WORKERS = 100_000, 1000


@click.command("emg-bias")
@click.argument("fitted", metavar="FIT.json")
@click.option("--noise", metavar="PART",
              help="Of each EMG's mean, white.  [default: the EMG's quiet part]")  # fmt: skip
@click.option("--pairs", metavar="N", help="Pairs of realisations, 8 fits each.  [default: 10]")
@click.option("--seed", metavar="N", help="Of the random noise.  [default: 0]")
@click.option("--workers", metavar="N", help="Fits at a time.  [default: all processors]")
@click.option("--output", metavar="BIAS.json", help="Write the biases.")
def command(
    fitted: str,
    noise: str | None,
    pairs: str | None,
    seed: str | None,
    workers: str | None,
    output: str | None,
) -> int:
    """Find how far noise of the EMG has shifted each parameter, which no interval shows.

    Ever more noise is added to the EMG, and what that does to the estimates is followed back to an
    EMG without noise (simulation and extrapolation). Ctrl-C keeps the pairs that are complete.
    """
    level = None if noise is None else number(f"--noise {noise}", noise)
    count = whole_number("--pairs", pairs, least=1, most=_MOST)
    begin = whole_number("--seed", seed, least=0) or 0
    threads = whole_number("--workers", workers, least=1, most=_MOST_WORKERS)
    check_outputs({"--output": output}, [fitted])

    from surae.api import emg_bias, load  # numba: only when the command is in order
    from surae.assessment.resampling.emg_bias import PAIRS
    from surae.cli.progress import compilation_notice, work

    fit = load(fitted)
    with work() as progress, compilation_notice():

        def told(done: int, total: int) -> None:
            progress.describe(f"EMG noise: {done} of {total} pairs")

        found = emg_bias(
            fit, level=level, pairs=count or PAIRS, seed=begin, workers=threads, progress=told
        )

    from surae.cli.screen import show_line, show_table

    if output is not None:
        found.save(output)
    show_table(*_table(fit, found))
    show_line(f"EMG noise: {found.source}; {found.pairs - found.missing} pairs, "
              f"{found.seconds:.1f} s")  # fmt: skip
    if output is not None:
        show_line(f"EMG bias: {shown(output)}")
    if found.missing:
        click.echo(f"surae: stopped by the user, {found.missing} pairs missing", err=True)
        return 130
    return 0


def _table(fit: "Fit", found: "EmgBias") -> tuple[tuple[str, ...], list[tuple[str, ...]]]:
    from surae.report.digits import NONE, significant

    rows: list[tuple[str, ...]] = []
    for p in found.parameters.values():
        sem = fit.parameters[p.name].trusted_sem
        rows.append(
            (
                p.name,
                significant(p.value, 4),
                NONE if p.bias is None else significant(p.bias, 2),
                NONE if p.error is None else significant(p.error, 2),
                NONE if p.bias is None or not sem else f"{100 * p.bias / sem:+.0f} %",
                p.unit,
            )
        )
    return ("parameter", "value", "bias", "±", "of the SEM", "unit"), rows
