"""All settings of a fit as one frozen value: made once, stored, taken whole."""

import math
from collections.abc import Mapping, Sequence
from dataclasses import dataclass, fields, replace
from typing import TYPE_CHECKING, Any

from surae.base import names
from surae.base.errors import InputError
from surae.base.file_form import filed
from surae.base.formatting import check_known, listed
from surae.base.frozen import FrozenDict
from surae.base.setting import Request, documented, setting
from surae.base.words import N_
from surae.effects import check_estimator, check_switches, differing
from surae.estimators import (
    EstimatorOptions,
    LeastSquaresOptions,
    PosteriorOptions,
    names_of,
    options_of,
)
from surae.model.knowledge import Knowledge
from surae.model.knowledge_priors import groups_of, priors_of
from surae.model.options import ModelOptions, with_files
from surae.prepared import PreparesInputs
from surae.shorthands import priors_of_keyword, with_geometry

if TYPE_CHECKING:  # what computes comes when it is needed: help reads the fields alone
    from surae.signals import Weighting

#: Standard deviation of an angle's zero [deg]: foot plates, malleoli and shoes are 3 to 5° off.
_ZERO = 2.5
#: Fields that map names of parameters to something.
_NAMED = ("fixed", "start", "bounds", "priors")
_OPTIONS = tuple(option.name for option in fields(ModelOptions))


@filed(types="surae.signals", merged="estimator")
@documented
@dataclass(frozen=True, slots=True)
class FitSettings(PreparesInputs, Request):
    """The settings of a fit; `of` makes them from keywords.

    What every fit is asked; `estimator` has what only that of its model is.

    Attributes
    ----------
    {settings}
    estimator : LeastSquaresOptions or PosteriorOptions
        Of a named model, or of ``"auto"``.

    Raises
    ------
    InputError
        Something has another form, is unknown or contradictory. What depends on the model and the
        recordings is checked by `make_problem`.
    """

    model: str = setting(
        names.AUTO,
        '``"auto"``: muscles on compliant tendons with the imperfections of a '
        "laboratory, and the departures of real legs that the data ask for. Or the name of one "
        "model; `surae.model.MODELS` lists them.",
        type="str",
        choices=names.FITTED,
        metavar="M",
        help=f"auto: what the data support; or {listed(names.FITTED[1:], 'or')}.",
        label=N_("Model"),
        first=True,
    )
    options: ModelOptions = setting(
        ModelOptions, "Switches of the model, all at once; each is a keyword of its own too."
    )
    fixed: Mapping[str, float] = setting(
        FrozenDict,
        'Parameters that are not estimated, e.g. ``{"beta": 1.0}``.',
        metavar="VALUE",
        example="beta=1",
        help="Do not estimate a parameter.",
    )
    free: tuple[str, ...] = setting(
        (),
        'Parameters to estimate beside those that the model frees by itself; ``"reflex"`` '
        "stands for all of the reflex.",
        type="sequence of str",
        metavar="NAME",
        help="Estimate one that is fixed; "
        f"{'; '.join(f'{drive}: {words}' for drive, words in names.DRIVES.items())}.",
    )
    start: Mapping[str, float] = setting(
        FrozenDict,
        "Where the first start begins, instead of the defaults.",
        metavar="VALUE",
        example="beta=1",
        help="Start the search of a parameter elsewhere.",
    )
    bounds: Mapping[str, tuple[float, float]] = setting(
        FrozenDict,
        "Bounds instead of the defaults.",
        type="mapping of str to (lower, upper)",
        option="bound",
        metavar="LOWER:UPPER",
        example="m=1:4",
        help="Search a parameter within other bounds.",
    )
    priors: Mapping[str, tuple[float, float]] = setting(
        FrozenDict,
        "The prior of a parameter: its median, and the standard deviation "
        'of its logarithm (about its relative standard deviation), e.g. ``{"dlt_tib": (0.04, '
        '0.2)}``. As a keyword also the name of a population, or both as a pair: ``("healthy", '
        '{"tau_rel": (2.0, 0.5)})``.',
        type="mapping of str to (median, spread)",
        above=0.0,
        option="prior",
        metavar="MEDIAN:SPREAD",
        example="tau_rel=3:0.3",
        help="Prior of a parameter; SPREAD is its relative standard deviation.",
    )
    population: str | None = setting(
        None,
        "Whose default priors stand for the parameters that `priors` does not name.",
        choices=names.POPULATIONS,
        option="priors",
        help="Priors of a population; --prior takes precedence.",
        label=N_("Priors"),
        words={
            "": N_("none"),
            "healthy": N_("healthy population"),
            "patient": N_("patient population"),
        },
        first=True,
    )
    weights: "Weighting | tuple[Weighting, ...] | None" = setting(
        None,
        "What samples count, for all recordings or one for each, e.g. "
        "``Weighting(peaks=9)``; windows of weight 0 are left out.",
        type="Weighting, sequence of Weighting, or None",
    )
    normalise: str | None = setting(
        None,
        "Divide EMG by one number for each muscle, so that weights g come out in N: by the "
        "largest envelope of all recordings, or of `mvc`. `validate` and `Fit.predict` use it "
        "again.",
        choices=names.NORMALISATIONS,
        label=N_("Divide EMG by"),
        help="Divide EMG by the largest of all recordings, or of --mvc; g come out in N.",
        words={
            "": N_("nothing"),
            "session": N_("the session's largest"),
            "mvc": N_("the contractions' largest"),
        },
    )
    prepared: bool = setting(
        False,
        "Whether the signals are used as they are: filtered and at the model's rate already.",
        help="Use the signals as they are, without filters.",
        label=N_("Signals"),
        words={"": N_("filter and resample"), "yes": N_("use as they are")},
    )
    preparation: Mapping[str, Any] = setting(
        FrozenDict,
        'Settings that differ from those of `surae.Preparation`, e.g. ``{"bessel_hz": '
        "10.0}``; False switches a filter off. What a recording says itself goes before.",
        option="filter",
        metavar="VALUE",
        help="A setting of the preparation, e.g. bessel_hz=10; false: without it.",
    )
    seed: int = setting(
        0,
        "Seed of the random starts; of auto those of its simplest member, where one start "
        "follows little of the torque.",
        least=0,
        help="Seed of the random starts.",
        label=N_("Seed"),
    )
    angle_zero_sd: float | None = setting(
        None,
        "How far the angle's zero may be from the ankle's [deg], foot perpendicular to "
        "shank, one standard deviation: every measure at a stated angle has it in its interval. By "
        "default 2.5, or 0 where `angle_zero` is given.",
        least=0.0,
        most=20.0,
        metavar="DEG",
        help="How far the angle's zero may be off, one standard deviation.  [default: 2.5]",
        label=N_("Zero of the angle ± [°]"),
    )

    #: Beside these settings, which are of every fit: by default those of the model's estimator.
    estimator: EstimatorOptions = None  # type: ignore[assignment]
    knowledge: Knowledge | None = setting(
        None,
        "What was measured of leg and device beforehand, which becomes priors, the zero's "
        "standard deviation and a geometry where these are not given: a ``session.toml``. A named "
        "model has no priors of the laboratory, and takes the other parts alone.",
        type="path or Knowledge, or None",
        file=True,
        needs=f"model={names.AUTO}",
        help="Leg and device as measured beforehand: a session.toml, with what its files show.",
    )

    def __post_init__(self) -> None:
        """Freeze what was given, and refuse what no model could mean."""
        from surae.model.laboratory import laboratory
        from surae.signals import Preparation

        Request.__post_init__(self)
        kind = options_of(self.model)
        asked: Any = self.estimator
        if asked is None:
            object.__setattr__(self, "estimator", kind())
        elif not isinstance(asked, kind):
            given = type(asked).__name__
            raise InputError(f"{given} has no effect with model {self.model}; give {kind.__name__}")
        laboratory(self.beliefs)
        if self.geometry_of != names.GEOMETRY_OF[0] and isinstance(self.options.geometry, str):
            raise InputError("geometry_of has no effect without a geometry's file; give one")
        zero, _ = self.stated_zero or (0.0, 0.0)
        if zero:
            at = {"angle_zero": math.radians(zero)}
            object.__setattr__(self, "fixed", FrozenDict({**at, **self.fixed}))
        free: Any = self.free
        object.__setattr__(self, "free", (free,) if isinstance(free, str) else tuple(free))
        if isinstance(self.weights, Sequence):
            object.__setattr__(self, "weights", tuple(self.weights))
        for name in self.start:
            if name in self.fixed:
                raise InputError(f"start of {name} has no effect, as {name} is fixed; give one")
        Preparation().updated(self.preparation)

    @classmethod
    def of(cls, model: "str | FitSettings" = names.AUTO, **keywords: Any) -> "FitSettings":
        """Settings from the keywords of `surae.fit`.

        Parameters
        ----------
        model : str or FitSettings
            Name of the model, or settings that the keywords are put in place of.
        **keywords
            Fields, and switches of the model by their own names. None: not given. `priors` may be
            the name of a population too, or a pair of it and a mapping.

        Returns
        -------
        FitSettings
            The settings.

        Raises
        ------
        InputError
            A keyword is unknown, or what it says is; or it has no effect on the model.
        """
        base = model if isinstance(model, FitSettings) else cls(model)
        given = {name: value for name, value in keywords.items() if value is not None}
        known = (*_OPTIONS, *(f.name for f in fields(cls) if f.name != "estimator"), *names_of())
        for name in given:
            check_known("option", known, name)
        check_estimator(base.model, given)
        options = given.pop("options", base.options)
        switches = with_files({n: given.pop(n) for n in _OPTIONS if n in given})
        asked = {*switches, *(differing(options) if options is not base.options else ())}
        if "priors" in given:
            given |= priors_of_keyword(given["priors"])
        if given.get("knowledge") is not None:
            given = with_geometry(base.model, base.options, given, switches)
        asked_of_it = {name: given.pop(name) for name in names_of() if name in given}
        estimator = replace(base.estimator, **asked_of_it)
        made = replace(base, **given, estimator=estimator, options=replace(options, **switches))
        check_switches(made.model, asked, made.options, made.mentioned)
        return made

    @property
    def starts(self) -> int | None:
        """Starts of least squares; None of a posterior, which has its own."""
        return getattr(self.estimator, "starts", None)

    @property
    def loss(self) -> str | None:
        """How outliers count in least squares; None where each counts its square."""
        return getattr(self.estimator, "loss", None)

    @property
    def nuisances(self) -> str | Mapping[str, tuple[float, float]]:
        """What the laboratory cannot rule out; none where a named model is fitted."""
        options = self.estimator
        return options.nuisances if isinstance(options, PosteriorOptions) else names.NUISANCES[1]

    @property
    def geometry_of(self) -> str:
        """Whose geometry a posterior holds lengths and arms to."""
        options = self.estimator
        return (
            options.geometry_of if isinstance(options, PosteriorOptions) else names.GEOMETRY_OF[0]
        )

    @property
    def zero_sd(self) -> float:
        """How far the angle's zero may be off, one standard deviation [deg]."""
        if self.angle_zero_sd is not None:
            return self.angle_zero_sd
        if self.stated_zero is not None and self.knowledge is not None:
            sd = self.stated_zero[1]
            tilt = self.knowledge.tilt_deg(self.options.anatomy.distance)
            return max(sd, min(math.hypot(sd, tilt), _ZERO))
        return 0.0 if "angle_zero" in self.fixed else _ZERO

    @property
    def stated_zero(self) -> tuple[float, float] | None:
        """The angle's zero as it was stated, and its standard deviation [deg]."""
        made = {} if self.knowledge is None else self.knowledge.statements
        return made["angle_zero"].numbers[""] if "angle_zero" in made else None

    @property
    def is_own(self) -> bool:
        """Whether lengths are the person's own, and two statements of the arms agree."""
        known = self.knowledge if self.geometry_of == names.GEOMETRY_OF[1] else None
        return known is not None and bool(known.agrees("arms"))

    @property
    def beliefs(self) -> str | Mapping[str, tuple[float, float]]:
        """`nuisances` with the priors that knowledge gives to those which they do not name."""
        if self.knowledge is None or self.nuisances == names.NUISANCES[1]:
            return self.nuisances
        given = {} if isinstance(self.nuisances, str) else self.nuisances
        return {**priors_of(self.knowledge), **given}

    @property
    def known(self) -> frozenset[str]:
        """Groups of nuisances of which something is known: their own uncertainty is in every fit.

        A prior that the data cannot see would else count as none at all.
        """
        groups = frozenset[str]() if self.knowledge is None else groups_of(self.knowledge)
        by_geometry = (
            {"arm", "bend", "length"} if self.geometry_of == names.GEOMETRY_OF[1] else set()
        )
        return groups | by_geometry

    @property
    def parameters(self) -> frozenset[str]:
        """Names of all parameters and drives that are given."""
        return frozenset(self.free).union(*(getattr(self, name) for name in _NAMED))

    @property
    def mentioned(self) -> frozenset[str]:
        """These names, a drive's name replaced by those of its parameters."""
        from surae.model.parameters import OPTIONAL

        given = self.parameters
        return frozenset(name for drive in given for name in OPTIONAL.get(drive, (drive,)))

    @classmethod
    def type_of_merged(cls, plain: Mapping[str, Any]) -> type[EstimatorOptions]:
        """Say whose options a file's settings have; what older files say of others is nothing.

        Parameters
        ----------
        plain : mapping
            The settings as the file has them.

        Returns
        -------
        type
            Of `estimator`.
        """
        return options_of(str(plain.get("model", names.AUTO)))

    def as_dict(self) -> dict[str, Any]:
        """The settings as plain data, as FIT.json holds them."""
        from surae.base.records import to_plain

        return dict(to_plain(self))


#: Records of all that a fit may be asked, by the names of their fields.
FIT_RECORDS = (FitSettings, LeastSquaresOptions, PosteriorOptions, ModelOptions)
