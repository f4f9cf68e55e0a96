"""`surae expect`."""

from functools import partial
from pathlib import Path
from typing import Any

import click

from surae import api
from surae.base.files import write_json
from surae.base.names import DESIGNED, PROFILES, TELLING
from surae.base.requests import ExpectSettings
from surae.cli.options import completing, settings_options
from surae.cli.paths import check_outputs
from surae.cli.progress import compilation_notice, work
from surae.cli.screen import show_answer, show_files


@click.command("expect")
@click.argument(
    "protocol", metavar="P.csv|NAME", shell_complete=completing(*PROFILES, *DESIGNED, *TELLING)
)
@click.option(
    "--fit",
    "fitted",
    metavar="FIT.json|DIR",
    help="Of one leg instead, as far as this fit knows it; model and noise are "
    "its. Of perturbations, the I.json of surae impedance.",
)
@settings_options(ExpectSettings, api.ModelOptions)
@click.option("--output", metavar="E.json", help="Write what is expected.")
def command(protocol: str, fitted: str | None, output: str | None, options: dict[str, Any]) -> None:
    """Predict how well a protocol determines each parameter, before anybody is measured.

    Standard errors come from the information of the torque at virtual legs; what no model can
    describe is not in them. Of perturbations and stretches it tells what surae impedance and surae
    stretches will find.
    """
    check_outputs({"--output": output}, [fitted] if fitted is not None else [])

    with compilation_notice(), work() as progress:
        tell = partial(progress.describe, "estimating what to expect")
        tell()
        of = api.fit_of(fitted) if fitted is not None and Path(fitted).is_dir() else fitted
        expectation = api.expect(protocol, fit=of, progress=tell, **options)
    if output is not None:
        write_json(output, expectation.to_json())
    show_answer(expectation.as_table())
    show_files({"expectation": output})
