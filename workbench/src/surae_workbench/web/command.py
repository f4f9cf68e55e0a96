"""`surae serve`."""

import os

import click

from surae.base.errors import InputError
from surae.base.files import read_bytes
from surae_workbench.options import Listening, server_options

_MIB = 2**20


@click.command("serve")
@click.argument("project", metavar="[PROJECT]", default="surae-project")
@server_options(8765)
@click.option("--token-file", metavar="FILE", help="A file that holds the token.")
@click.option(
    "--workers",
    type=click.IntRange(1, 256),
    metavar="N",
    help="Fits at a time.  [default: one for each core but one]",
)
@click.option(
    "--max-upload",
    type=click.IntRange(1, 4096),
    default=512,
    show_default=True,
    metavar="MIB",
    help="Largest file that is taken.",
)
def command(
    project: str,
    listening: Listening,
    token_file: str | None,
    workers: int | None,
    max_upload: int,
) -> None:
    """Open the workbench: a web page on this computer, over the project in a folder.

    PROJECT is a folder, made where it is missing; it can be copied and opened elsewhere. Nothing
    is sent to the network. Ctrl-C ends it; what is complete is kept.
    """
    os.environ.pop("SURAE_TOKEN", None)  # no worker needs it
    token = listening.token
    if token_file is not None:
        token = read_bytes(token_file, 4096).decode("utf-8", "replace").strip()
    if token is not None and len(token) < 8:
        raise InputError("the token is too short; give at least 8 characters, or leave it away")
    if not project:
        raise InputError("the project's folder has no name; give one")
    from surae_workbench.web.server import Address, serve

    serve(
        project,
        Address(listening.host, listening.port, token, listening.open_browser),
        workers=workers or max(1, (os.cpu_count() or 2) - 1),
        upload_bytes=max_upload * _MIB,
    )
