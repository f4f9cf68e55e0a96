"""`surae expect`."""

from typing import Any

import click

from surae import api
from surae.cli.options import FILM, Number, Whole, model_options
from surae.cli.paths import check_outputs
from surae.cli.progress import compilation_notice
from surae.cli.screen import show_answer, show_files
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
@FILM
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

    show_answer(expectation.as_table())
    show_files({"expectation": output})
