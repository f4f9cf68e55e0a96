"""`surae emg-bias`."""

from functools import partial
from typing import Any

import click

from surae import api
from surae.cli.options import settings_options
from surae.cli.paths import check_outputs
from surae.cli.progress import StoppedError, compilation_notice, work
from surae.cli.screen import Columns, show_files, show_line, show_table
from surae.requests import EmgBiasSettings


@click.command("emg-bias")
@click.argument("fitted", metavar="FIT.json")
@settings_options(EmgBiasSettings)
@click.option("--output", metavar="BIAS.json", help="Write the biases.")
def command(fitted: str, output: str | None, options: dict[str, Any]) -> None:
    """Find how far noise of the EMG has shifted each parameter, which no interval shows.

    Ever more noise is added to the EMG, and what that does to the estimates is followed back to an
    EMG without noise (simulation and extrapolation). Ctrl-C keeps the pairs that are complete.
    """
    check_outputs({"--output": output}, [fitted])

    fit = api.load(fitted)
    with work() as progress, compilation_notice():
        bias = api.emg_bias(fit, **options, progress=partial(progress.parts, "pairs of EMG noise"))

    if output is not None:
        bias.save(output)
    show_table(*_table(fit, bias))
    show_line(f"EMG noise: {bias.source}; {bias.pairs - bias.missing} pairs, "
              f"{bias.seconds:.1f} s")  # fmt: skip
    show_files({"EMG bias": output})
    if bias.missing:
        raise StoppedError(f"stopped by the user, {bias.missing} pairs missing")


def _table(fit: "api.Fit", bias: "api.EmgBias") -> Columns:
    rows: list[tuple[str, ...]] = []
    estimates = {**fit.parameters, **fit.nuisances}
    for p in bias.parameters.values():
        sem = estimates[p.name].trusted_sem
        rows.append(
            (
                p.name,
                api.significant(p.value, 4),
                api.NO_NUMBER if p.bias is None else api.significant(p.bias, 2),
                api.NO_NUMBER if p.error is None else api.significant(p.error, 2),
                api.NO_NUMBER if p.bias is None or not sem else f"{100 * p.bias / sem:+.0f} %",
                p.unit,
            )
        )
    return ("parameter", "value", "bias", "±", "of the SEM", "unit"), rows
