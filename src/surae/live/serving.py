"""`surae live` with its pages: a server until Ctrl-C."""

import secrets

import click
from starlette.types import ASGIApp

from surae.files import PathLike
from surae.live.pages import Served, create_app
from surae.web.security import Policy
from surae.web.server import run, token_for


def serve(
    folder: PathLike,
    *,
    mapping: PathLike | None,
    network: bool,
    watch: PathLike | None,
    leg: int | None,
    device: str,
    span: tuple[float, float] | None,
    host: str,
    port: int,
    token: str | None,
    open_browser: bool,
) -> None:
    """Record, show and judge until the user stops it.

    `host`, `port`, `token` and `open_browser` are as of `surae.web.server.run`, all else as of
    `surae.live.room.Room`.
    """
    token = token_for(host, token)
    subject = None if token is None else secrets.token_urlsafe(12)

    def made() -> tuple[Served, ASGIApp]:
        served = Served(
            folder, mapping=mapping, network=network, watch=watch, leg=leg, device=device, span=span
        )
        for said in served.room.trials.broken:
            click.echo(f"surae: {said}", err=True)
        return served, create_app(served, Policy.of(host, token), subject)

    def more(root: str) -> None:
        mark = "" if subject is None else f"?token={subject}"
        click.echo(f"the subject's page: {root}subject{mark}")

    run(made, "live", host=host, port=port, token=token, open_browser=open_browser, more=more)
