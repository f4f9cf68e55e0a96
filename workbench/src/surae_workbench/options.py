"""Options that `surae serve` and `surae live` share."""

from collections.abc import Callable
from dataclasses import dataclass
from typing import Any, TypeVar

import click

from surae.cli.option_records import as_record

F = TypeVar("F", bound=Callable[..., Any])


@dataclass(frozen=True, slots=True)
class Listening:
    """Where a server listens and who may ask, as it was given."""

    host: str
    port: int
    token: str | None
    open_browser: bool


def server_options(port: int) -> Callable[[F], F]:
    """Where a server listens and who may ask, as one argument `listening`."""
    return as_record(
        "listening",
        Listening,
        click.option(
            "--host",
            default="127.0.0.1",
            show_default=True,
            metavar="ADDRESS",
            help="Address to listen on; any but this computer's own needs a token.",
        ),
        click.option(
            "--port",
            type=click.IntRange(0, 65535),
            default=port,
            show_default=True,
            metavar="N",
            help="0: any free one.",
        ),
        click.option(
            "--token",
            metavar="T",
            envvar="SURAE_TOKEN",
            help="What a browser must know; in the list of processes others see it, in "
            "the environment, as SURAE_TOKEN, not.  [default: made where needed]",
        ),
        click.option(
            "--open/--no-open", "open_browser", default=True, help="Show it in the browser."
        ),
    )
