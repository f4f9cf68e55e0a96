"""`surae expect`."""

from typing import Any

import click

from surae import api
from surae.cli.options import Number, Whole, model_options
from surae.cli.paths import check_outputs
from surae.cli.progress import compilation_notice
from surae.cli.screen import show_files, show_line, show_verdicts
from surae.files import write_json
from surae.names import AUTO, FITTED, NUISANCES, POPULATIONS


@click.command("expect")
@click.argument("protocol", metavar="P.csv|NAME")
@click.option("--model", type=click.Choice(FITTED), default=AUTO, metavar="M",
              help="What would be fitted.  [default: auto]")  # fmt: skip
@click.option("--population", type=click.Choice(POPULATIONS), metavar="P",
              help="healthy or patient legs.  [default: as many of each]")  # fmt: skip
@click.option("--fit", "fitted", metavar="FIT.json",
              help="Of one leg instead, as far as this fit knows it; model and noise are "
              "its.")  # fmt: skip
@click.option("--noise", type=Number(above=0.0), metavar="NM",
              help="Standard deviation of the torque's white noise, sample by sample at the "
              "protocol's rate.  [default: 0.5, or the fit's]")  # fmt: skip
@click.option("--nuisances", type=click.Choice(NUISANCES),
              help="What of the laboratory's imperfections is in.  "
              "[default: all for auto]")  # fmt: skip
@click.option("--legs", type=Whole(1, 10_000), default=20, show_default=True, metavar="N",
              help="How many legs are drawn.")  # fmt: skip
@model_options
@click.option("--output", metavar="E.json", help="Write what is expected.")
def command(
    protocol: str,
    fitted: str | None,
    output: str | None,
    options: dict[str, Any],
    **settings: Any,
) -> None:
    """Tell what a protocol will tell of each parameter, before anybody is measured.

    Standard errors come from the information of the torque at virtual legs; what no model can
    describe is not in them.
    """
    check_outputs({"--output": output}, [fitted] if fitted is not None else [])

    fit = None if fitted is None else api.load(fitted)
    with compilation_notice():
        expectation = api.expect(protocol, fit=fit, **settings, **options)
    if output is not None:
        write_json(output, expectation.to_json())

    show_expectation(expectation)
    show_files({"expectation": output})


def show_expectation(expectation: "api.Expectation") -> None:
    """A table of what is expected of each parameter, and of all."""
    rows = []
    for p in expectation.parameters.values():
        source = max(p.budget, key=lambda name: p.budget[name], default="—")
        rows.append(
            (
                p.name,
                part(p.relative_sem),
                part(p.half_width),
                f"{100 * p.identified_share:.0f} %",
                source,
                str(p.verdict),
            )
        )
    show_line(f"{expectation.protocol}: {expectation.seconds:g} s, {expectation.legs}, "
              f"{expectation.model}, noise {expectation.noise:.2g} Nm at "
              f"{expectation.rate_hz:g} Hz")  # fmt: skip
    show_verdicts(
        ("parameter", "standard error", "95 % within", "identified in", "most of it", "verdict"),
        rows,
    )
    low, high = expectation.torque
    show_line(
        f"largest standard error: {part(expectation.worst)} ({expectation.weakest}); "
        f"geometric mean: {part(expectation.geometric_mean)}; identified: "
        f"{expectation.identified} of {len(rows)}"
    )
    show_line(f"torque on the device: {low:.3g} to {high:.3g} Nm over these legs")


def part(value: float | None) -> str:
    """A part in percent, to two digits."""
    return "—" if value is None else f"{100 * value:.2g} %" if value < 1 else f"{100 * value:.0f} %"
