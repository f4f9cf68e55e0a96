"""Options of commands that fit: what samples count, what is known beforehand, the foot's mass."""

import math
from collections.abc import Callable, Sequence
from dataclasses import dataclass
from typing import TYPE_CHECKING, Any, TypeVar

import click

from surae.cli.options import number
from surae.errors import InputError

if TYPE_CHECKING:
    from surae.signals import ModelInputs, Weighting

F = TypeVar("F", bound=Callable[..., Any])

#: Written out, since help must not import what knows them.
LOSS_NAMES = "huber|soft-l1|tukey"
POPULATION_NAMES = "healthy|patient"
NORMALISE_NAMES = "session|mvc"
TABLE_NAMES = "winter|de-leva-female|de-leva-male"

_OPTIONS = (
    click.option("--exclude", multiple=True, metavar="START:END",
                 help="Seconds to leave out of the fit; either may be left away."),
    click.option("--weight", multiple=True, metavar="START:END:W",
                 help="Seconds whose samples count W times."),
    click.option("--weight-peaks", metavar="P",
                 help="A sample at a peak counts 1 + P times as much as one at rest."),
    click.option("--peaks-of", metavar="torque|emg", help="Peaks of what.  [default: torque]"),
    click.option("--robust", is_flag=True, help="Outliers count less: the same as --loss huber."),
    click.option("--loss", metavar=LOSS_NAMES, help="How outliers count.  [default: squares]"),
    click.option("--priors", "population", metavar=POPULATION_NAMES,
                 help="What is known of a population beforehand; --prior goes before it."),
    click.option("--normalise", metavar=NORMALISE_NAMES,
                 help="Divide EMG by the largest of all recordings, or of --mvc; g come out in N."),
    click.option("--mvc", multiple=True, metavar="FILE",
                 help="A maximum voluntary contraction; may be given several times."),
    click.option("--body-mass", metavar="KG", help="Fix m: the foot is 1.45 % of it (Winter)."),
    click.option("--footplate-mass", metavar="KG", help="To add to the foot's.  [default: 0]"),
    click.option("--foot-share", metavar=TABLE_NAMES,
                 help="Whose share of body mass.  [default: winter]"),
)  # fmt: skip


def fit_options(function: F) -> F:
    """Add the options; `taken` takes them out of what arrives."""
    for option in reversed(_OPTIONS):
        function = option(function)
    return function


@dataclass(frozen=True, slots=True)
class FitSettings:
    """What the options ask for.

    Attributes
    ----------
    weighting : Weighting or None
        What samples count.
    loss, population : str or None
        Names.
    mass : (float, float, str) or None
        Body mass [kg], footplate mass [kg] and the table that says what part is foot.
    normalise : str or None
        What EMG is divided by.
    mvc : tuple of str
        Files of maximum voluntary contractions.
    """

    weighting: "Weighting | None"
    loss: str | None
    population: str | None
    mass: tuple[float, float, str] | None
    normalise: str | None = None
    mvc: tuple[str, ...] = ()

    def prescribed(
        self, inputs: Sequence["ModelInputs"], prepared: bool = False
    ) -> Sequence["ModelInputs"]:
        """The recordings with EMG normalised and the mass of the foot fixed, where asked for."""
        if self.normalise is not None:
            from surae.recording import read
            from surae.signals import normalise, prepare

            contractions = [prepare(read(path), prepared=prepared) for path in self.mvc]
            inputs = normalise(inputs, self.normalise, mvc=contractions)
        if self.mass is None:
            return inputs
        from surae.model.anthropometry import with_foot_mass

        body, plate, table = self.mass
        return with_foot_mass(inputs, body, plate, table=table)

    def priors(self, known: dict[str, tuple[float, float]]) -> Any:
        """The argument `priors` of `surae.fit`."""
        return known if self.population is None else (self.population, known)


def taken(options: dict[str, Any], fixed: Sequence[str] = ()) -> FitSettings:
    """Take the options of `fit_options` out of what a command was given.

    Parameters
    ----------
    options : dict
        Options by name; those taken are removed.
    fixed : sequence of str
        Parameters fixed otherwise.

    Raises
    ------
    InputError
        An option is no number, or contradicts another.
    """
    windows = [(*_span("--exclude", text, text), 0.0) for text in options.pop("exclude")]
    windows += [_window(text) for text in options.pop("weight")]
    peaks, kind = options.pop("weight_peaks"), options.pop("peaks_of")
    robust, loss = options.pop("robust"), options.pop("loss")
    if kind is not None and peaks is None:
        raise InputError("--peaks-of has no effect without --weight-peaks; give one")
    if robust and loss not in (None, "huber"):
        raise InputError(f"--robust means --loss huber, not {loss}; give one of them")
    return FitSettings(
        _weighting(windows, peaks, kind),
        "huber" if robust else loss,
        options.pop("population"),
        _mass(options, fixed),
        *_normalisation(options),
    )


def _weighting(
    windows: list[tuple[float, float, float]], peaks: str | None, kind: str | None
) -> "Weighting | None":
    if not windows and peaks is None:
        return None
    from surae.signals import Weighting

    height = 0.0 if peaks is None else number("--weight-peaks", peaks)
    return Weighting(tuple(windows), height, kind or "torque")


def _mass(options: dict[str, Any], fixed: Sequence[str]) -> tuple[float, float, str] | None:
    body, plate = options.pop("body_mass"), options.pop("footplate_mass")
    table = options.pop("foot_share")
    if body is None:
        for option, value in (("--footplate-mass", plate), ("--foot-share", table)):
            if value is not None:
                raise InputError(f"{option} has no effect without --body-mass; give one")
        return None
    if "m" in fixed:
        raise InputError("--body-mass fixes m, and so does --fixed m; give one")
    kilograms = number("--body-mass", body)
    carried = 0.0 if plate is None else number("--footplate-mass", plate)
    return kilograms, carried, table or "winter"


def _normalisation(options: dict[str, Any]) -> tuple[str | None, tuple[str, ...]]:
    kind, mvc = options.pop("normalise"), options.pop("mvc")
    if mvc and kind != "mvc":
        raise InputError("--mvc has no effect without --normalise mvc; give both")
    if kind not in (None, *NORMALISE_NAMES.split("|")):
        raise InputError(f"--normalise {kind}: use one of: {NORMALISE_NAMES.replace('|', ', ')}")
    if kind == "mvc" and not mvc:
        raise InputError("--normalise mvc needs a maximum contraction: give --mvc FILE")
    return kind, mvc


def _window(text: str) -> tuple[float, float, float]:
    span, colon, weight = text.rpartition(":")
    if not colon or ":" not in span:
        raise InputError(f"--weight {text}: write start:end:weight, e.g. --weight 3:4.5:2")
    return (*_span("--weight", span, text), number(f"--weight {text}", weight.strip()))


def _span(option: str, span: str, text: str) -> tuple[float, float]:
    first, colon, last = (part.strip() for part in span.partition(":"))
    if not colon or ":" in last or not (first or last):
        raise InputError(f"{option} {text}: write start:end in s, e.g. --exclude 3:4.5")
    where = f"{option} {text}"
    return (
        number(where, first) if first else -math.inf,
        number(where, last) if last else math.inf,
    )
