"""`surae profile`."""

from typing import Any

import click

from surae import api
from surae.cli.options import settings_options
from surae.cli.paths import check_outputs
from surae.cli.progress import StoppedError, compilation_notice, work
from surae.cli.screen import show_answer, show_files


@click.command("profile")
@click.argument("fitted", metavar="FIT.json|DIR")
@click.argument("names", metavar="[NAME…]", nargs=-1)
@settings_options(api.ProfileSettings)
@click.option("--output", metavar="PROFILE.json", help="Write the profiles.")
def command(
    fitted: str, names: tuple[str, ...], output: str | None, options: dict[str, Any]
) -> None:
    """Find how far each parameter can move before the fit gets worse.

    The profile holds a parameter at value after value and fits all others again: its 95 % interval
    need not be symmetric, and may be open where the recordings set no limit. Without names, every
    parameter that was estimated. Ctrl-C keeps the profiles that are complete.
    """
    check_outputs({"--output": output}, [fitted])

    fit = api.fit_of(fitted)
    with work() as progress, compilation_notice():
        progress.describe("profiles")
        profiles = api.profile(
            fit,
            names or None,
            **options,
            progress=lambda name, done, total: progress.describe(
                f"profiles: {done} of {total} done, {name} last"
            ),
        )

    if output is not None:
        profiles.save(output)
    show_answer(profiles.as_table())
    show_files({"profiles": output})
    if profiles.missing:
        done = "complete profiles are shown" + (" and written" if output is not None else "")
        left = ", ".join(profiles.missing)
        raise StoppedError(f"stopped by the user; {done}; not done: {left}")
