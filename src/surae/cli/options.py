"""Options that several commands share, and the texts they take."""

from collections.abc import Callable, Sequence
from typing import Any, TypeVar

import click

from surae.errors import InputError

F = TypeVar("F", bound=Callable[..., Any])

_MODEL_OPTIONS = (
    click.option("--geometry", metavar="thesis|virtual-work", help="How muscle length is read."),
    click.option("--tendon-strain", metavar="thesis|slack-length", help="How ε0 is read."),
    click.option("--integrator", metavar="implicit|explicit-euler", help="Muscle-tendon models."),
    click.option("--theta-foot", metavar="RAD", help="Foot to horizontal at 0 rad."),
    click.option("--vmax-factor", metavar="F", help="vmax in optimal lengths/s."),
    click.option("--x-ref-tri", metavar="M", help="Virtual work: triceps at 0 rad."),
    click.option("--x-ref-tib", metavar="M", help="Virtual work: tibialis at 0 rad."),
)
#: Every model by name; written out, since help must not import what knows them.
MODEL_NAMES = "muscle, muscle-tendon, muscle-tendon-strain, muscle-tendon-toe or muscle-2010"
_NUMBERS = ("theta_foot", "vmax_factor", "x_ref_tri", "x_ref_tib")


def model_options(function: F) -> F:
    """Add the model options; those given arrive as keyword arguments, the others as None."""
    for option in reversed(_MODEL_OPTIONS):
        function = option(function)
    return function


def given(options: dict[str, Any]) -> dict[str, Any]:
    """The model options that were given, numbers as numbers.

    Raises
    ------
    InputError
        One that should be a number is none.
    """
    return {
        name: number(f"--{name.replace('_', '-')} {value}", value) if name in _NUMBERS else value
        for name, value in options.items()
        if value is not None
    }


def assignments(option: str, texts: Sequence[str]) -> dict[str, float]:
    """Values by name from ``name=value`` texts.

    Raises
    ------
    InputError
        A text has another form, or a name comes twice.
    """
    values: dict[str, float] = {}
    for text in texts:
        name, equals, value = (part.strip() for part in text.partition("="))
        if not (name and equals and value):
            raise InputError(f"{option} {text}: write name=value, e.g. {option} beta=1")
        _refuse_second(option, name, values)
        values[name] = number(f"{option} {text}", value)
    return values


def pairs(
    option: str, texts: Sequence[str], *, form: str, example: str
) -> dict[str, tuple[float, float]]:
    """Two numbers by name from ``name=first:second`` texts.

    Parameters
    ----------
    option : str
        Its name, for messages.
    texts : sequence of str
        What was given.
    form, example : str
        How it is to be written, e.g. ``"lower:upper"`` and ``"m=1:4"``.

    Raises
    ------
    InputError
        A text has another form, or a name comes twice.
    """
    found: dict[str, tuple[float, float]] = {}
    for text in texts:
        name, _, numbers = (part.strip() for part in text.partition("="))
        first, colon, second = (part.strip() for part in numbers.partition(":"))
        if not (name and first and colon and second):
            raise InputError(f"{option} {text}: write name={form}, e.g. {option} {example}")
        _refuse_second(option, name, found)
        found[name] = (number(f"{option} {text}", first), number(f"{option} {text}", second))
    return found


def names(option: str, texts: Sequence[str]) -> tuple[str, ...]:
    """Names from texts that must be nothing but a name.

    Raises
    ------
    InputError
        A text has a value too.
    """
    for text in texts:
        if "=" in text or not text.strip():
            raise InputError(f"{option} {text}: write a name without a value, e.g. {option} beta")
    return tuple(text.strip() for text in texts)


def refuse_fixed(option: str, given: Sequence[str], fixed: Sequence[str]) -> None:
    """Refuse to start or bound what is not estimated: one of the two is a mistake."""
    for name in given:
        if name in fixed:
            raise InputError(f"{option} {name} has no effect beside --fixed {name}; give one")


def whole_number(
    option: str, text: str | None, *, least: int, most: int | None = None
) -> int | None:
    """A whole number within limits; None where the option is not given.

    Raises
    ------
    InputError
        It is none, or outside the limits.
    """
    if text is None:
        return None
    upper = "or more" if most is None else f"to {most}"
    rule = f"give a whole number, {least} {upper}"
    try:
        value = int(text)
    except ValueError:
        raise InputError(f"{option} {text}: {rule}") from None
    if "_" in text or value < least or (most is not None and value > most):
        raise InputError(f"{option} {text}: {rule}")
    return value


def number(where: str, text: str) -> float:
    """A number from a text.

    Raises
    ------
    InputError
        It is none; the message begins with `where`.
    """
    try:
        value = float(text)
    except ValueError:
        value = None
    if value is None or "_" in text:  # Python's 1_000 is no number of anybody else's
        hint = f"; write {text.replace(',', '.')}" if _decimal_comma(text) else ""
        raise InputError(f"{where}: {text!r} is not a number{hint}")
    return value


def factor(option: str, text: str | None) -> float | None:
    """A number above zero from an option; None where it is not given.

    Raises
    ------
    InputError
        It is no such number.
    """
    if text is None:
        return None
    value = number(f"{option} {text}", text)
    if not 0 < value < float("inf"):
        raise InputError(f"{option} {text}: give a number above zero")
    return value


def _decimal_comma(text: str) -> bool:
    whole, comma, rest = text.partition(",")
    return bool(comma) and rest.isdecimal() and whole.lstrip("-+").isdecimal()


def _refuse_second(option: str, name: str, values: dict[str, Any]) -> None:
    if name in values:
        raise InputError(f"{option} {name} is given twice; give it once")
