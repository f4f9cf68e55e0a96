"""`surae emg-bias`."""

from typing import TYPE_CHECKING

import click

from surae.cli.options import SEED, WORKERS, Number, Whole
from surae.cli.paths import check_outputs
from surae.files import shown

if TYPE_CHECKING:
    from surae.api import EmgBias, Fit

#: More pairs than these are a slip of the keyboard.
_MOST = 100_000


@click.command("emg-bias")
@click.argument("fitted", metavar="FIT.json")
@click.option("--noise", type=Number(), metavar="PART",
              help="Of each EMG's mean, white.  [default: the EMG's quiet part]")  # fmt: skip
@click.option("--pairs", type=Whole(1, _MOST), default=10, show_default=True, metavar="N",
              help="Pairs of realisations, 8 fits each.")  # fmt: skip
@SEED
@click.option(
    "--workers", type=WORKERS, metavar="N", help="Fits at a time.  [default: all processors]"
)
@click.option("--output", metavar="BIAS.json", help="Write the biases.")
def command(
    fitted: str,
    noise: float | None,
    pairs: int,
    seed: int,
    workers: int | None,
    output: str | None,
) -> int:
    """Find how far noise of the EMG has shifted each parameter, which no interval shows.

    Ever more noise is added to the EMG, and what that does to the estimates is followed back to an
    EMG without noise (simulation and extrapolation). Ctrl-C keeps the pairs that are complete.
    """
    check_outputs({"--output": output}, [fitted])

    from surae.api import emg_bias, load  # numba: only when the command is in order
    from surae.cli.progress import compilation_notice, work

    fit = load(fitted)
    with work() as progress, compilation_notice():

        def told(done: int, total: int) -> None:
            progress.describe(f"EMG noise: {done} of {total} pairs")

        bias = emg_bias(fit, level=noise, pairs=pairs, seed=seed, workers=workers, progress=told)

    from surae.cli.screen import show_line, show_table

    if output is not None:
        bias.save(output)
    show_table(*_table(fit, bias))
    show_line(f"EMG noise: {bias.source}; {bias.pairs - bias.missing} pairs, "
              f"{bias.seconds:.1f} s")  # fmt: skip
    if output is not None:
        show_line(f"EMG bias: {shown(output)}")
    if bias.missing:
        click.echo(f"surae: stopped by the user, {bias.missing} pairs missing", err=True)
        return 130
    return 0


def _table(fit: "Fit", bias: "EmgBias") -> tuple[tuple[str, ...], list[tuple[str, ...]]]:
    from surae.api import NO_NUMBER, significant

    rows: list[tuple[str, ...]] = []
    estimates = {**fit.parameters, **fit.nuisances}
    for p in bias.parameters.values():
        sem = estimates[p.name].trusted_sem
        rows.append(
            (
                p.name,
                significant(p.value, 4),
                NO_NUMBER if p.bias is None else significant(p.bias, 2),
                NO_NUMBER if p.error is None else significant(p.error, 2),
                NO_NUMBER if p.bias is None or not sem else f"{100 * p.bias / sem:+.0f} %",
                p.unit,
            )
        )
    return ("parameter", "value", "bias", "±", "of the SEM", "unit"), rows
