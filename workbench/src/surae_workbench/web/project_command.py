"""`surae project`."""

from functools import partial

import click

from surae.base.errors import ComputationError
from surae.cli.progress import work

_FOLDER = click.argument("folder", metavar="DIR")


@click.group("project")
def command() -> None:
    """Look after a project of the workbench: copy it, check it."""


@command.command("backup")
@_FOLDER
@click.argument("to", metavar="COPY")
def backup(folder: str, to: str) -> None:
    """Copy the project in DIR to the new folder COPY, also while `surae serve` uses it.

    The copy is of one instant, checked file by file, and a project like any other: open it with
    `surae serve COPY`.
    """
    from surae_workbench.web import upkeep

    with work() as progress:
        progress.describe(f"copying {folder}")
        seen = upkeep.backup(folder, to, partial(progress.parts, "entries checked"))
    click.echo(f"{to}: {seen.entries} entries and {seen.files} files, all as they were kept")


@command.command("check")
@_FOLDER
def check(folder: str) -> None:
    """Check the project in DIR: its database, and every file against its checksum.

    Nothing is changed, and `surae serve` may use it meanwhile. The exit code is 1 where something
    is wrong.
    """
    from surae_workbench.web import upkeep

    with work() as progress:
        seen = upkeep.check(folder, partial(progress.parts, "entries"))
    for line in seen.problems:
        click.echo(f"wrong: {line}")
    for name in seen.orphans:
        click.echo(f"belongs to nothing: {name}")
    for name in seen.unsealed:
        click.echo(f"no checksum was kept of: {name}")
    click.echo(f"{seen.entries} entries, {seen.files} files as they were kept")
    if seen.problems:
        count = len(seen.problems)
        raise ComputationError(
            f"{count} {'entry is' if count == 1 else 'entries are'} wrong; all others are usable; "
            "a backup may have them whole"
        )
