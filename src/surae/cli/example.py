"""`surae example`."""

import click

from surae import api
from surae.base.errors import InputError
from surae.base.files import make_folder


@click.command("example")
@click.argument("file", metavar="[FILE.csv]", required=False)
@click.option("--folder", metavar="DIR", help="Write the trials of a whole leg here instead.")
def command(file: str | None, folder: str | None) -> None:
    """Write a trial of a virtual leg, or a folder of them, to try surae with.

    What is in them looks as a laboratory measures it: raw EMG, noise, crosstalk.
    """
    if (file is None) == (folder is None):
        raise InputError("give a FILE.csv to write, or --folder DIR")
    if file is not None:
        api.example(file)
        click.echo(f"{file}: one trial; `surae fit {file}` fits it")
        return
    assert folder is not None  # else there is a file
    files = api.example_leg(make_folder(folder))
    click.echo(f"{folder}: {len(files)} trials of one leg; `surae session {folder}` analyses them")
