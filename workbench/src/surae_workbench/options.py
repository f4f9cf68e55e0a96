"""Options that `surae serve` and `surae live` share."""

from collections.abc import Callable
from typing import Any, TypeVar

import click

F = TypeVar("F", bound=Callable[..., Any])


def server_options(port: int) -> Callable[[F], F]:
    """Where a server listens and who may ask: `host`, `port`, `token`, `open_`."""
    options = (
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
        click.option("--open/--no-open", "open_", default=True, help="Show it in the browser."),
    )

    def decorate(function: F) -> F:
        for option in reversed(options):
            function = option(function)
        return function

    return decorate
