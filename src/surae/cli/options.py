"""Options that several commands share."""

from collections.abc import Callable, Sequence
from typing import Any, TypeVar

import click

from surae.errors import InputError

F = TypeVar("F", bound=Callable[..., Any])

_MODEL_OPTIONS = (
    click.option("--geometry", metavar="thesis|virtual-work", help="How muscle length is read."),
    click.option("--tendon-strain", metavar="thesis|slack-length", help="How ε0 is read."),
    click.option("--integrator", metavar="implicit|explicit-euler", help="Muscle-tendon models."),
    click.option("--theta-foot", type=float, metavar="RAD", help="Foot to horizontal at 0 rad."),
    click.option("--vmax-factor", type=float, metavar="F", help="vmax in optimal lengths/s."),
    click.option("--x-ref-tri", type=float, metavar="M", help="Virtual work: triceps at 0 rad."),
    click.option("--x-ref-tib", type=float, metavar="M", help="Virtual work: tibialis at 0 rad."),
)


def model_options(function: F) -> F:
    """Add the model options; those given arrive as keyword arguments, the others as None."""
    for option in reversed(_MODEL_OPTIONS):
        function = option(function)
    return function


def given(options: dict[str, Any]) -> dict[str, Any]:
    """The options that were given."""
    return {name: value for name, value in options.items() if value is not None}


def assignments(option: str, texts: Sequence[str]) -> dict[str, float]:
    """Values by name from ``name=value`` texts.

    Raises
    ------
    InputError
        A text has another form, or a name comes twice.
    """
    values: dict[str, float] = {}
    for text in texts:
        name, equals, value = text.partition("=")
        if not equals or not name.strip():
            raise InputError(f"{option} {text!r}: write name=value, e.g. {option} beta=1")
        if name.strip() in values:
            raise InputError(f"{option} {name.strip()} is given twice; give it once")
        values[name.strip()] = number(option, text, value)
    return values


def ranges(option: str, texts: Sequence[str]) -> dict[str, tuple[float, float]]:
    """Bounds by name from ``name=lower:upper`` texts.

    Raises
    ------
    InputError
        A text has another form.
    """
    bounds = {}
    for text in texts:
        name, _, limits = text.partition("=")
        low, colon, high = limits.partition(":")
        if not colon:
            raise InputError(f"{option} {text!r}: write name=lower:upper, e.g. {option} m=1:4")
        bounds[name.strip()] = (number(option, text, low), number(option, text, high))
    return bounds


def number(option: str, text: str, value: str) -> float:
    """A number from a text."""
    try:
        return float(value)
    except ValueError:
        raise InputError(f"{option} {text!r}: {value!r} is not a number") from None
