"""What each estimator is asked beside what every fit is: a record each, chosen by the model."""

from collections.abc import Mapping
from dataclasses import dataclass, fields

from surae.base import names
from surae.base.setting import Request, documented, setting
from surae.base.words import N_

#: Starts of a fit unless it says otherwise: the default start and seven random ones.
STARTS = 8
#: More starts than these are slips of the keyboard.
_MOST_STARTS = 10_000


@documented
@dataclass(frozen=True, slots=True)
class LeastSquaresOptions(Request):
    """What the least squares of a named model are asked.

    Attributes
    ----------
    {settings}
    """

    loss: str | None = setting(
        None,
        "Of a named model: let outliers count less than their square; see "
        "`surae.inference.fit_robust`.",
        choices=names.LOSSES,
        needs=f"model!={names.AUTO}",
        help="How outliers count, of a named model.  [default: squares]",
        label=N_("Outliers"),
        words={"": N_("count fully"), "huber": "Huber", "soft-l1": N_("soft L1"), "tukey": "Tukey"},
        first=True,
    )
    starts: int = setting(
        STARTS,
        "Of a named model: number of starts; the first from the default, the others random within "
        "the bounds.",
        least=1,
        most=_MOST_STARTS,
        needs=f"model!={names.AUTO}",
        help="Number of starts, of a named model.",
        label=N_("Starts"),
    )


@documented
@dataclass(frozen=True, slots=True)
class PosteriorOptions(Request):
    """What the posterior of ``model="auto"`` is asked.

    Attributes
    ----------
    {settings}
    """

    nuisances: str | Mapping[str, tuple[float, float]] = setting(
        names.NUISANCES[0],
        'What the laboratory cannot rule out, for ``model="auto"``; a mapping '
        "gives other priors, mean and standard deviation, of groups or parameters, e.g. "
        '``{"zero": (0.0, 1.0)}``.',
        type='{"all", "none"} or mapping of str to (mean, sd)',
        choices=names.NUISANCES,
        needs=f"model={names.AUTO}",
        first=True,
        help="Imperfections of the laboratory that auto takes in.",
        label=N_("Account for the laboratory’s imperfections"),
        words={"all": N_("yes"), "none": N_("no")},
    )
    geometry_of: str = setting(
        names.GEOMETRY_OF[0],
        "Whose the table of `geometry` is: with the person's own, `auto` "
        "holds moment arms and muscle lengths closer to it.",
        choices=names.GEOMETRY_OF,
        needs=f"model={names.AUTO}",
        help="Whose geometry the file has; auto departs less from the person's own.",
        label=N_("The geometry’s file is"),
        words={"generic": N_("of a generic model"), "person": N_("of this person")},
    )


#: What an estimator is asked.
EstimatorOptions = LeastSquaresOptions | PosteriorOptions


def options_of(model: str) -> type[LeastSquaresOptions] | type[PosteriorOptions]:
    """The record of the estimator that fits a model: a named one, or the family."""
    return PosteriorOptions if model == names.AUTO else LeastSquaresOptions


def names_of(*kinds: type[EstimatorOptions]) -> tuple[str, ...]:
    """What estimators are asked, by name; of all of them where none is given."""
    kinds = kinds or (LeastSquaresOptions, PosteriorOptions)
    return tuple(each.name for kind in kinds for each in fields(kind))
