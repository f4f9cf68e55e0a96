"""`surae expect`."""

from typing import Any

import click

from surae import api
from surae.base.files import write_json
from surae.base.names import DESIGNED, PROFILES
from surae.base.requests import ExpectSettings
from surae.cli.options import completing, settings_options
from surae.cli.paths import check_outputs
from surae.cli.progress import compilation_notice
from surae.cli.screen import show_answer, show_files


@click.command("expect")
@click.argument("protocol", metavar="P.csv|NAME",
                shell_complete=completing(*PROFILES, *DESIGNED))  # fmt: skip
@click.option("--fit", "fitted", metavar="FIT.json",
              help="Of one leg instead, as far as this fit knows it; model and noise are "
              "its.")  # fmt: skip
@settings_options(ExpectSettings, api.ModelOptions)
@click.option("--output", metavar="E.json", help="Write what is expected.")
def command(protocol: str, fitted: str | None, output: str | None, options: dict[str, Any]) -> None:
    """Predict how well a protocol determines each parameter, before anybody is measured.

    Standard errors come from the information of the torque at virtual legs; what no model can
    describe is not in them.
    """
    check_outputs({"--output": output}, [fitted] if fitted is not None else [])

    fit = None if fitted is None else api.load(fitted)
    with compilation_notice():
        expectation = api.expect(protocol, fit=fit, **options)
    if output is not None:
        write_json(output, expectation.to_json())

    show_answer(expectation.as_table())
    show_files({"expectation": output})
