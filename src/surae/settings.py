"""Everything that a fit can be asked, as one frozen value: made once, stored, taken whole."""

import math
from collections.abc import Mapping, Sequence
from dataclasses import dataclass, field, fields, replace
from typing import Any

import numpy as np

from surae.errors import InputError
from surae.frozen import FrozenDict
from surae.model import ModelOptions, get_model, with_optional
from surae.model.anthropometry import foot_mass, with_foot_mass
from surae.model.laboratory import ALL, AUTO, laboratory, richest
from surae.model.parameters import OPTIONAL
from surae.names import LOSSES, NORMALISATIONS, POPULATIONS
from surae.recording import Recording
from surae.signals import ModelInputs, Preparation, Weighting, normalise, prepare, weighted

#: Starts of a fit unless told otherwise: the default start and seven random ones.
STARTS = 8

#: Fields that map names of parameters to something.
_NAMED = ("fixed", "start", "bounds", "priors")
_OPTIONS = tuple(option.name for option in fields(ModelOptions))


@dataclass(frozen=True, slots=True)
class FitSettings:
    """What a fit is asked, beside its recordings; `of` makes one from keywords.

    Attributes
    ----------
    model : str
        Name of the model.
    options : ModelOptions
        Its switches.
    fixed : mapping of str to float
        Parameters that are not estimated.
    free : tuple of str
        Parameters to estimate beside those that the model frees by itself; ``"reflex"`` stands for
        all of the reflex.
    start : mapping of str to float
        Where the first start begins, instead of the defaults.
    bounds : mapping of str to (lower, upper)
        Bounds instead of the defaults.
    priors : mapping of str to (median, spread)
        What is known of a parameter beforehand; the spread is that of its logarithm.
    population : str or None
        Whose default priors stand for the parameters that `priors` does not name.
    body_mass : float or None
        Fixes m at the share of the foot in this mass [kg]; see `surae.foot_mass`.
    footplate_mass : float
        What moves with the foot [kg].
    foot_share : str
        Table that the share comes from.
    weights : Weighting, tuple of Weighting, or None
        What samples count, for all recordings or one for each: windows of weight 0 are left out.
    loss : str or None
        How outliers count; None: least squares.
    normalise : {"session", "mvc"} or None
        What EMG is divided by; None: nothing.
    prepared : bool
        Whether the signals are used as they are.
    preparation : mapping of str to object
        Cut-offs, orders and rate of the preparation that differ from those of
        `surae.Preparation`; False switches a filter off. What a recording says itself goes before.
    nuisances : str or mapping of str to (mean, sd)
        What the laboratory cannot rule out, for ``model="auto"``: ``"all"``, ``"none"``, or priors
        of groups or parameters in place of the defaults; see `surae.model.laboratory`.
    starts : int
        Number of starts; the first from the default, the others random within the bounds.
    seed : int
        Seed of the random starts.

    Raises
    ------
    InputError
        Something has another form, is unknown or contradictory. What depends on the model and the
        recordings is checked by `make_problem`.
    """

    model: str = AUTO
    options: ModelOptions = field(default_factory=ModelOptions)
    fixed: Mapping[str, float] = field(default_factory=FrozenDict)
    free: tuple[str, ...] = ()
    start: Mapping[str, float] = field(default_factory=FrozenDict)
    bounds: Mapping[str, tuple[float, float]] = field(default_factory=FrozenDict)
    priors: Mapping[str, tuple[float, float]] = field(default_factory=FrozenDict)
    population: str | None = None
    body_mass: float | None = None
    footplate_mass: float = 0.0
    foot_share: str = "winter"
    weights: Weighting | tuple[Weighting, ...] | None = None
    loss: str | None = None
    normalise: str | None = None
    prepared: bool = False
    preparation: Mapping[str, Any] = field(default_factory=FrozenDict)
    nuisances: str | Mapping[str, tuple[float, float]] = ALL
    starts: int = STARTS
    seed: int = 0

    def __post_init__(self) -> None:
        """Freeze what was given, and refuse what no model could mean."""
        for name in (*_NAMED, "preparation"):
            given = getattr(self, name)
            if not isinstance(given, Mapping):
                raise InputError(f"{name} is {given!r}; give a mapping of names to values")
            object.__setattr__(self, name, FrozenDict((k, _frozen(v)) for k, v in given.items()))
        if isinstance(self.nuisances, Mapping):
            frozen = FrozenDict((k, _frozen(v)) for k, v in self.nuisances.items())
            object.__setattr__(self, "nuisances", frozen)
        laboratory(self.nuisances)
        free: Any = self.free
        object.__setattr__(self, "free", (free,) if isinstance(free, str) else tuple(free))
        if isinstance(self.weights, Sequence):
            object.__setattr__(self, "weights", tuple(self.weights))
        for name, least in (("starts", 1), ("seed", 0)):
            number = getattr(self, name)
            if isinstance(number, bool) or not isinstance(number, int | np.integer):
                raise InputError(f"{name} is {number!r}; give a whole number")
            if number < least:
                raise InputError(f"{name} is {number}; give at least {least}")
            object.__setattr__(self, name, int(number))
        for name, known in (
            ("loss", LOSSES), ("normalise", NORMALISATIONS), ("population", POPULATIONS)
        ):  # fmt: skip
            if getattr(self, name) not in (None, *known):
                rule = f"use one of: {', '.join(known)}"
                raise InputError(f"{name} is {getattr(self, name)!r}; {rule}")
        for name in self.start:
            if name in self.fixed:
                raise InputError(f"start of {name} has no effect, as {name} is fixed; give one")
        Preparation().updated(self.preparation)
        self._check_mass()

    def _check_mass(self) -> None:
        if self.body_mass is not None:
            foot_mass(self.body_mass, self.footplate_mass, table=self.foot_share)
            if "m" in self.fixed:
                raise InputError("body_mass fixes m, and fixed does so too; give one of them")
            return
        default = {f.name: f.default for f in fields(self)}
        for name in ("footplate_mass", "foot_share"):
            if getattr(self, name) != default[name]:
                raise InputError(f"{name} has no effect without body_mass; give both")

    @classmethod
    def of(cls, model: "str | FitSettings" = AUTO, **asked: Any) -> "FitSettings":
        """Settings from the keywords of `surae.fit`.

        Parameters
        ----------
        model : str or FitSettings
            Name of the model, or settings that the keywords are put in place of.
        **asked
            Fields, and switches of the model by their own names. None: not given. `priors` may be
            the name of a population too, or a pair of it and a mapping.

        Returns
        -------
        FitSettings
            What is asked.

        Raises
        ------
        InputError
            A keyword is unknown, or what it says is.
        """
        base = model if isinstance(model, FitSettings) else cls(model)
        given = {name: value for name, value in asked.items() if value is not None}
        options = given.pop("options", base.options)
        switches = {name: given.pop(name) for name in _OPTIONS if name in given}
        if "priors" in given:
            given |= _believed(given["priors"])
        known = [f.name for f in fields(cls)]
        for name in given:
            if name not in known:
                others = ", ".join((*_OPTIONS, *known))
                raise InputError(f"unknown option {name!r}; known options: {others}")
        return replace(base, **given, options=replace(options, **switches))

    @property
    def parameters(self) -> frozenset[str]:
        """Names of all parameters and drives that are given."""
        return frozenset(self.free).union(*(getattr(self, name) for name in _NAMED))

    @property
    def mentioned(self) -> frozenset[str]:
        """These names, a drive's name replaced by those of its parameters."""
        given = self.parameters
        return frozenset(name for drive in given for name in OPTIONAL.get(drive, (drive,)))

    def for_model(self, model: str) -> "FitSettings":
        """These settings for another model, without what it has no parameter for.

        Parameters
        ----------
        model : str
            Its name.

        Returns
        -------
        FitSettings
            What it can be asked.
        """
        names = with_optional(get_model(richest(model)), self.mentioned).names
        changes: dict[str, Any] = {
            field: {name: value for name, value in getattr(self, field).items() if name in names}
            for field in _NAMED
        }
        changes["free"] = tuple(
            name for name in self.free if set(OPTIONAL.get(name, (name,))) <= set(names)
        )
        return replace(self, model=model, **changes)

    def inputs(
        self,
        recordings: Sequence[Recording | ModelInputs],
        mvc: Sequence[Recording | ModelInputs] = (),
    ) -> tuple[ModelInputs, ...]:
        """What the model reads of recordings: prepared, normalised, weighted, the foot weighed.

        Parameters
        ----------
        recordings : sequence of Recording or ModelInputs
            What is to be fitted; model inputs are prepared already.
        mvc : sequence of Recording or ModelInputs
            Maximum voluntary contractions, for ``normalise="mvc"``.

        Returns
        -------
        tuple of ModelInputs
            For `make_problem`.

        Raises
        ------
        InputError
            A recording cannot be prepared so.
        """
        made: tuple[ModelInputs, ...] = tuple(self.prepare(recording) for recording in recordings)
        if self.normalise is not None:
            made = normalise(made, self.normalise, mvc=[self.prepare(each) for each in mvc])
        elif mvc:
            raise InputError("mvc has no effect without normalise='mvc'; give both")
        if self.body_mass is not None:
            made = with_foot_mass(made, self.body_mass, self.footplate_mass, table=self.foot_share)
        return made if self.weights is None else weighted(made, self.weights)

    def prepare(self, recording: Recording | ModelInputs) -> ModelInputs:
        """What the model reads of one recording, before EMG is normalised and samples weighted.

        Parameters
        ----------
        recording : Recording or ModelInputs
            Model inputs are prepared already.

        Returns
        -------
        ModelInputs
            The signals on one time axis.
        """
        if isinstance(recording, ModelInputs):
            return recording
        how = Preparation().updated(self.preparation)
        return prepare(recording, how, prepared=self.prepared)

    def as_dict(self) -> dict[str, Any]:
        """The settings as plain data, as FIT.json holds them."""
        return {f.name: _plain(getattr(self, f.name)) for f in fields(self)}

    @classmethod
    def from_dict(cls, data: Mapping[str, Any]) -> "FitSettings":
        """The settings that `as_dict` made plain.

        Parameters
        ----------
        data : mapping
            What it gave.

        Returns
        -------
        FitSettings
            The same settings.

        Raises
        ------
        KeyError, TypeError, ValueError, InputError
            They are damaged, or ask for something unknown.
        """
        weights = data["weights"]
        if isinstance(weights, Mapping):
            weights = _weighting(weights)
        elif weights is not None:
            weights = tuple(_weighting(each) for each in weights)
        options = ModelOptions.of(**data["options"])
        return cls(**{**data, "options": options, "weights": weights})


def _frozen(value: Any) -> Any:
    """A pair as a tuple; anything else as it is, to be refused where it is used."""
    return tuple(value) if isinstance(value, list | np.ndarray) else value


def _believed(given: Any) -> dict[str, Any]:
    """The fields that the keyword `priors` of `surae.fit` stands for."""
    population, known = given if isinstance(given, tuple) else (None, given)
    if isinstance(known, str):
        population, known = known, {}
    return {"priors": known or {}} | ({} if population is None else {"population": population})


def _plain(value: Any) -> Any:
    """A field as plain JSON data."""
    if isinstance(value, Mapping):
        return {name: _plain(entry) for name, entry in value.items()}
    if isinstance(value, tuple):
        return [_plain(entry) for entry in value]
    if isinstance(value, ModelOptions):
        return value.as_dict()
    if isinstance(value, Weighting):
        windows = [
            [start if math.isfinite(start) else None, end if math.isfinite(end) else None, weight]
            for start, end, weight in value.windows
        ]
        return {"windows": windows, "peaks": value.peaks, "activity": value.activity}
    return value.item() if isinstance(value, np.generic) else value


def _weighting(data: Mapping[str, Any]) -> Weighting:
    windows = tuple(
        (-math.inf if start is None else start, math.inf if end is None else end, weight)
        for start, end, weight in data["windows"]
    )
    return Weighting(windows, data["peaks"], data["activity"])
