"""Types of options, and the options that several commands share."""

import math
from collections.abc import Callable, Mapping
from pathlib import Path
from typing import TYPE_CHECKING, Any, TypeVar

import click

from surae import api
from surae.base import names
from surae.base.docstrings import docstring
from surae.base.errors import InputError
from surae.base.files import shown
from surae.base.formatting import nearest
from surae.base.setting import Setting, default_of, kind_of, settings_of

if TYPE_CHECKING:
    from dataclasses import Field

#: What commands of other distributions are made of.
__all__ = ["DASK", "MAPPING", "RANGE", "corrections", "settings_options", "workers_option"]

F = TypeVar("F", bound=Callable[..., Any])

#: More threads than these are slips of the keyboard.
_MOST_WORKERS = 1000


class Typed(click.ParamType):  # type: ignore[type-arg]
    """A type of option that a function reads; its errors are one line, which `where` begins."""

    name = "value"

    def __init__(self, read: Callable[..., Any], *how: Any) -> None:
        self._read = read
        self._how = how

    def convert(self, value: Any, param: click.Parameter | None, ctx: click.Context | None) -> Any:
        """What the text stands for; a default is that already."""
        del ctx
        if not isinstance(value, str):
            return value
        option = param.opts[-1] if param is not None else ""
        return self._read(f"{option} {value}", value, *self._how)


def number(where: str, text: str) -> float:
    """A number."""
    try:
        value = float(text)
    except ValueError:
        value = None
    if value is None or "_" in text:  # Python's 1_000 is no number of anybody else's
        whole, comma, rest = text.partition(",")
        decimal = bool(comma) and rest.isdecimal() and whole.lstrip("-+").isdecimal()
        hint = f"; write {text.replace(',', '.')}" if decimal else ""
        raise InputError(f"{where}: {text!r} is not a number{hint}")
    return value


def entry(where: str, text: str, form: str, example: str) -> tuple[str, Any]:
    """A name and a number, or a pair of them: NAME=VALUE, NAME=FIRST:SECOND."""
    count = form.count(":") + 1
    name, equals, rest = (part.strip() for part in text.partition("="))
    parts = [part.strip() for part in rest.split(":", count - 1)]
    if not (name and equals and all(parts) and len(parts) == count):
        raise InputError(f"{where}: write name={form}, e.g. {where.split(maxsplit=1)[0]} {example}")
    values = tuple(number(where, part) for part in parts)
    return name, values[0] if count == 1 else values


def preparation(where: str, text: str) -> tuple[str, Any]:
    """A name and a number, or false."""
    name, value = entry(where, text.replace("=false", "=nan"), "value", "bessel_hz=10")
    if math.isnan(value):
        return name, False
    return name, int(value) if name.endswith("_order") and value.is_integer() else value


def bare_name(where: str, text: str) -> str:
    """A name and nothing else."""
    if "=" in text or not text.strip():
        name = text.partition("=")[0].strip() or "beta"
        raise InputError(f"{where}: write a name without a value, as {name}")
    return text.strip()


def choice_or_file(where: str, text: str, choices: tuple[str, ...]) -> str:
    """One of several words, or the path of a file that exists."""
    if text not in choices and not Path(text).is_file():
        words = " or ".join(choices)
        option = where.partition(" ")[0]
        raise InputError(f"{option}: {text!r} is no file; give one, or {words}")
    return text


def span(where: str, text: str) -> tuple[float, float, float]:
    """A stretch of time [s], START:END, either of which may be left open; it counts 0."""
    first, colon, last = (part.strip() for part in text.partition(":"))
    if not colon or ":" in last or not (first or last):
        raise InputError(f"{where}: write start:end in s, e.g. --exclude 3:4.5")
    return (
        number(where, first) if first else -math.inf,
        number(where, last) if last else math.inf,
        0.0,
    )


def weighted_span(where: str, text: str) -> tuple[float, float, float]:
    """A stretch of time with what it counts, START:END:W."""
    stretch, colon, weight = text.rpartition(":")
    if not (colon and ":" in stretch):
        raise InputError(f"{where}: write start:end:weight, e.g. --weight 3:4.5:2")
    return (*span(where, stretch)[:2], number(where, weight.strip()))


def angle(where: str, text: str) -> float:
    """An angle in rad, or in degrees where it ends in ``deg`` or ``°``; as rad."""
    bare = text.strip().removesuffix("°").removesuffix("deg").rstrip()
    value = number(where, bare)
    return value if bare == text.strip() else math.radians(value)


def motion(where: str, text: str) -> tuple[float, float]:
    """A subject's full plantarflexion and dorsiflexion, LOW:HIGH, in rad or degrees; as rad."""
    low, colon, high = (part.strip() for part in text.partition(":"))
    if not (low and colon and high):
        raise InputError(f"{where}: write LOW:HIGH, e.g. --range -0.9:0.6 or --range -52:34deg")
    unit = "deg" if high.endswith(("deg", "°")) and not low.endswith(("deg", "°")) else ""
    ends = angle(where, low + unit), angle(where, high)
    if max(map(abs, ends)) > math.pi:
        raise InputError(f"{where}: no ankle turns so far in rad; in degrees write {text}deg")
    return ends


def picture(where: str, text: str) -> str:
    """The file of a figure."""
    if not text.lower().endswith((".png", ".svg", ".pdf")):
        raise InputError(f"{shown(where)} must end in .svg, .pdf or .png")
    return text


NUMBER, ANGLE, RANGE, PICTURE = map(Typed, (number, angle, motion, picture))


class OneOf(click.Choice):  # type: ignore[type-arg]  # generic since click 8.2 alone
    """One of several names, those of plugins too; help lists only what it is known to be."""

    def __init__(self, known: tuple[str, ...]) -> None:
        super().__init__(known)
        self.known = known

    def convert(self, value: Any, param: click.Parameter | None, ctx: click.Context | None) -> Any:
        """Give the name."""
        if value in self.known:
            return value
        try:
            return super().convert(value, param, ctx)
        except click.BadParameter as error:
            text = f"{error.message.rstrip('.')}{nearest(str(value), self.known)}."
            raise click.BadParameter(text, ctx, param) from None


def completing(*words: str) -> Callable[..., list[str]]:
    """Has the shell complete an argument by these words; files are still taken."""
    return lambda _context, _parameter, begun: [word for word in words if word.startswith(begun)]


def table(_: click.Context, param: click.Parameter, entries: Any) -> dict[str, Any]:
    """Entries as a mapping; a name that comes twice is a slip."""
    values: dict[str, Any] = {}
    for name, value in entries:
        if name in values:
            raise InputError(f"{param.opts[-1]} {name} is given twice; give it once")
        values[name] = value
    return values


EXCLUDE = click.option(
    "--exclude",
    type=Typed(span),
    multiple=True,
    metavar="START:END",
    help="Seconds to leave out; either end may be left open.",
)
#: What `weights` is made of.
_WEIGHTS = (
    EXCLUDE,
    click.option(
        "--weight",
        type=Typed(weighted_span),
        multiple=True,
        metavar="START:END:W",
        help="Seconds whose samples count W times.",
    ),
    click.option(
        "--weight-peaks",
        type=NUMBER,
        metavar="P",
        help="A sample at a peak counts 1 + P times as much as one at rest.",
    ),
    click.option(
        "--peaks-of", type=click.Choice(names.ACTIVITIES), help="Peaks of what.  [default: torque]"
    ),
)


def options_of(request: Any, *without: str) -> list[Callable[[Any], Any]]:
    """Options of all settings of a request that have a help, under the names of their fields."""
    made: list[Callable[[Any], Any]] = []
    for each, record in settings_of(request):
        if each.name == "weights":
            made += _WEIGHTS
        if (record.help or record.label) and each.name not in without:
            name = flag_of(each, record)
            made.append(click.option(f"--{name}", each.name, **_option(each, record)))
    return made


def flag_of(each: "Field[Any]", record: Setting) -> str:
    """The option of a setting, without its dashes."""
    return (record.option or each.name).replace("_", "-")


def _option(each: "Field[Any]", record: Setting) -> dict[str, Any]:
    """What click makes an option of."""
    kind = kind_of(each)
    metavar = record.metavar or ("N" if kind == "whole" else None)
    how: dict[str, Any] = {"help": record.help or record.meaning, "metavar": metavar}
    if record.file:
        how["type"] = Typed(choice_or_file, record.choices)
        how["metavar"] = "|".join((*record.choices, "FILE"))
    elif record.choices:
        how["type"] = OneOf(record.choices)
    elif kind == "flag":
        return how | {"is_flag": True, "flag_value": not default_of(each), "default": None}
    elif kind == "numbers":
        return how | {"type": NUMBER, "multiple": True}
    elif kind == "range":
        return how | {"type": RANGE}
    elif kind == "text":
        pass
    elif kind == "names":
        return how | {"type": Typed(bare_name), "multiple": True}
    elif kind == "mapping":
        kind_of_entry = Typed(entry, record.metavar.lower(), record.example)
        how["type"] = kind_of_entry if record.example else Typed(preparation)
        return how | {"multiple": True, "callback": table, "metavar": f"NAME={record.metavar}"}
    elif kind == "whole":
        how["type"] = click.INT  # the request knows its limits
    else:
        how["type"] = ANGLE if "[rad]" in record.label else NUMBER
    default = default_of(each)
    if default not in (None, ""):
        how["help"] += f"  [default: {f'{default:g}' if kind == 'number' else default}]"
    return how


LANGUAGE = click.option(
    "--language",
    type=click.Choice(names.LANGUAGES),
    default="en",
    help="Of the leg's page.  [default: en]",
)
MAPPING = click.option(
    "--mapping", metavar="MAP.toml", help="Read the files as this mapping says, of all of them."
)


def muscles(where: str, text: str) -> tuple[str, str]:
    """Two muscles: A:B."""
    first, colon, second = (part.strip() for part in text.partition(":"))
    if not (first and colon and second):
        raise InputError(f"{where}: write two muscles, e.g. --swap ta:sol")
    return first, second


def _gathered(options: list[Callable[[Any], Any]], keyword: str) -> Callable[[F], F]:
    """Add options; those that are used arrive as one keyword."""

    def decorate(function: F) -> F:
        def command(**values: Any) -> Any:
            values_of = {param.name: values.pop(param.name) for param in added}
            used = {n: v for n, v in values_of.items() if v not in (None, (), {})}
            return function(**values, **{keyword: used})

        command.__doc__ = docstring(function)
        known = list(getattr(function, "__click_params__", []))
        for option in reversed(options):
            option(command)
        added: list[click.Parameter] = vars(command)["__click_params__"]
        vars(command)["__click_params__"] = [*known, *added]
        return command  # type: ignore[return-value]

    return decorate


def _correction(name: str, example: str, help: str) -> Callable[[Any], Any]:
    """An option that puts signals right by one number each."""
    kind = Typed(entry, "value", example)
    return click.option(
        f"--{name}", type=kind, multiple=True, callback=table, metavar="SIGNAL=VALUE", help=help
    )


#: The options that put signals right, in the order in which they are done.
corrections = _gathered(
    [
        _correction(
            "wrap", "angle=360", "By how much a signal jumps at the end of its range, in its unit."
        ),
        _correction(
            "scale",
            "torque=72",
            "What a signal is multiplied by, as by the body mass [kg] for Nm/kg.",
        ),
        _correction("offset", "angle=-90", "What is added then, in the file's unit."),
        _correction("sign", "angle=-1", "-1 turns a signal round, last of all."),
        click.option(
            "--swap",
            type=Typed(muscles),
            multiple=True,
            metavar="A:B",
            help="Muscles whose electrodes were exchanged, as ta:sol.",
        ),
    ],
    "corrections",
)


def workers_option(what: str, *, many: str = "all processors") -> Callable[[F], F]:
    """How many of something are made at a time; by default as `many` says."""
    help = f"{what} at a time.  [default: {many}]"
    return click.option("--workers", type=click.IntRange(1, _MOST_WORKERS), metavar="N", help=help)


def settings_options(*requests: Any) -> Callable[[F], F]:
    """Add options of all settings of requests; those that are used arrive as `options`."""
    options = list[Callable[[Any], Any]]()
    seen = list[str]()
    for request in requests:
        options += options_of(request, *seen)
        seen += [each.name for each, _ in settings_of(request)]
    return _gathered(options, "options")


def request(options: Mapping[str, Any]) -> "api.FitSettings":
    """The settings of a fit, as `surae.fit` takes them, from the `options` of a command."""
    keywords = dict(options)
    windows = (*keywords.pop("exclude", ()), *keywords.pop("weight", ()))
    peaks = keywords.pop("weight_peaks", None)
    kind = keywords.pop("peaks_of", None)
    if kind is not None and peaks is None:
        raise InputError("--peaks-of has no effect without --weight-peaks; give one")
    if windows or peaks is not None:
        keywords["weights"] = api.Weighting(windows, peaks or 0.0, kind or "torque")
    return api.FitSettings.of(keywords.pop("model", names.AUTO), **keywords)


DASK = click.option(
    "--dask", metavar="ADDRESS", help="Scheduler of a Dask cluster to run on instead."
)
