"""The question a fit answers: which model and recordings, what is free, within which bounds."""

from collections.abc import Collection, Mapping, Sequence
from dataclasses import dataclass, field, replace
from typing import Any

import numpy as np

from surae.base.errors import InputError, within
from surae.base.file_form import filed
from surae.base.frozen import Comparable, FrozenDict, read_only
from surae.base.units import FloatArray
from surae.inference.population_priors import checked_prior, population_priors
from surae.model import (
    ModelOptions,
    ModelSpec,
    adapted,
    check_names,
    check_value,
    get_model,
    with_optional,
)
from surae.model.laboratory import richest
from surae.model.parameter import Parameter
from surae.model.parameters import OPTIONAL
from surae.model.prior import Prior
from surae.recording import MUSCLES
from surae.settings import FitSettings
from surae.signals import ModelInputs, emg_sizes, noise_alone
from surae.signals.inputs import check_estimable

#: Between these lies the mass of any foot and plate, weighed [kg].
MASSES = (0.0, 25.8)


@filed("spec", "inputs", "lower", "upper")
@dataclass(frozen=True, slots=True, eq=False)
class FitProblem(Comparable):
    """A least-squares problem over the free parameters of one model and one or more recordings."""

    spec: ModelSpec  #: The model.
    options: ModelOptions  #: Its switches.
    inputs: tuple[ModelInputs, ...]  #: The recordings, prepared; all share the parameters.
    free: tuple[str, ...]  #: Names of the parameters to estimate, in the model's order.
    #: All parameters: the fixed values, and the starts of the free ones, shape (P,).
    base: FloatArray
    #: `lower`, `upper`: bounds of the free parameters, shape (p,).
    lower: FloatArray
    upper: FloatArray
    #: What is known of free parameters beforehand.
    priors: Mapping[str, Prior] = field(default_factory=FrozenDict)
    settings: FitSettings = field(default_factory=FitSettings)  #: As requested.

    @property
    def columns(self) -> list[int]:
        """Positions of the free parameters in the parameter vector."""
        return list(map(self.spec.names.index, self.free))

    @property
    def start(self) -> FloatArray:
        """Start of the free parameters, shape (p,)."""
        return self.base[self.columns]

    @property
    def n(self) -> int:
        """Samples that count, of all recordings together."""
        return sum(recording.counted for recording in self.inputs)

    @property
    def has_unheard(self) -> bool:
        """Whether a muscle of the joint has no EMG in one of the recordings."""
        absent = {MUSCLES[channel] for channel in self.options.anatomy.silent}
        return any({*recording.missing_emg} - absent for recording in self.inputs_heard)

    @property
    def inputs_heard(self) -> tuple[ModelInputs, ...]:
        """The recordings without EMG that makes no force: its weight is held at 0, or it is noise.

        Such an electrode tells nothing of another's crosstalk, gain or rest.
        """
        weights = enumerate(self.spec.weights)
        held = {
            i for i, n in weights if n not in self.free and not self.base[self.spec.names.index(n)]
        }
        out = held | noise_alone(self.inputs)
        return tuple(_without(recording, out) for recording in self.inputs)

    @property
    def of_inverse_dynamics(self) -> bool:
        """Whether inertia and weight were taken out of every torque: no device measured it."""
        given = ({**trial.fixed, **self.settings.fixed}.get("m") for trial in self.inputs)
        return all(mass == 0.0 for mass in given)

    def values(self, x: FloatArray) -> FloatArray:
        """All parameters, shape (P,), from the free ones, shape (p,)."""
        values = self.base.copy()
        values[self.columns] = x
        return values

    def by_name(self, x: FloatArray) -> dict[str, float]:
        """All parameters by name, from the free ones, shape (p,)."""
        return dict(zip(self.spec.names, self.values(x).tolist(), strict=True))

    @property
    def limits(self) -> dict[str, tuple[float, float]]:
        """Bounds of the free parameters by name."""
        pairs = zip(self.lower.tolist(), self.upper.tolist(), strict=True)
        return dict(zip(self.free, pairs, strict=True))

    @property
    def table(self) -> dict[str, Parameter]:
        """The model's parameters by name, for these options and EMG of this unit and size."""
        return self.table_of(self.spec, self.options)

    def table_of(self, spec: ModelSpec, options: ModelOptions) -> dict[str, Parameter]:
        """Those of another model or under other options."""
        return adapted(spec.parameters, options, self.inputs[0].emg_unit, emg_sizes(self.inputs))

    def of_model(
        self,
        spec: ModelSpec,
        free: Sequence[str],
        values: Mapping[str, float],
        limits: Mapping[str, tuple[float, float]],
        **changes: Any,
    ) -> "FitProblem":
        """The problem of another model, with its own start and bounds where none are given."""
        options = changes.get("options", self.options)
        table = self.table_of(spec, options)
        bounds = [limits.get(n, (table[n].lower, table[n].upper)) for n in free]
        return replace(
            self,
            spec=spec,
            free=tuple(free),
            base=np.array([values.get(n, p.start) for n, p in table.items()]),
            lower=np.array([low for low, _ in bounds], dtype=float),
            upper=np.array([high for _, high in bounds], dtype=float),
            priors=FrozenDict({n: prior for n, prior in self.priors.items() if n in free}),
            **changes,
        )


def make_problem(
    inputs: Sequence[ModelInputs], model: str | FitSettings = "muscle", **keywords: Any
) -> FitProblem:
    """Check all settings and make a problem of them.

    Parameters
    ----------
    inputs : sequence of ModelInputs
        The recordings, as `FitSettings.inputs` gives them; several are one joint fit with shared
        parameters. What the settings ask of recordings is done already.
    model : str or FitSettings
        Name of the model, or all settings. What is fixed overrides what a recording
        prescribes.
    **keywords
        Other settings by name, see `FitSettings.of`.

    Raises
    ------
    InputError
        A setting is unknown, contradictory or impossible.
    """
    settings = FitSettings.of(model, **keywords)
    options = settings.options
    fixed = settings.fixed
    start = settings.start
    bounds = settings.bounds
    priors = settings.priors
    held = {*fixed, *(name for recording in inputs for name in recording.fixed)}
    free = _spelled_out(settings.free, held)
    model = richest(settings.model)
    spec = with_optional(get_model(model), {*held, *settings.parameters, *free})
    if not inputs:
        raise InputError("nothing to fit: give at least one recording")
    for recording in inputs:
        check_estimable(recording, alone=len(inputs) == 1)
        _check_weight(recording)
        _check_prescribed(recording, spec)
    absent = {spec.weights[channel]: 0.0 for channel in options.anatomy.silent}
    prescribed = {**absent, **_agreed_fixed(inputs, fixed), **fixed}
    for names in (prescribed, start, bounds, tuple(free)):
        check_names(names, spec)
    table = adapted(spec.parameters, options, _agreed_unit(inputs), emg_sizes(inputs))
    if both := [name for name in free if name in prescribed]:
        raise InputError(f"{both[0]} is both free and fixed; choose one")
    for values in (prescribed, start):
        for name, value in values.items():
            check_value(table[name], value, spec)

    base = {**{name: p.start for name, p in table.items()}, **start, **prescribed}
    estimated = {*spec.free, *free} - prescribed.keys()
    names = tuple(name for name in spec.names if name in estimated)
    if not names:
        raise InputError("every parameter is fixed: nothing to estimate; free at least one")
    _check_reflex(names, base)
    limits = {name: (p.lower, p.upper) for name, p in table.items()}
    for name in bounds:
        low, high = limits[name]
        if name in fixed and low <= fixed[name] <= high:
            raise InputError(f"bounds of {name} have no effect, as {name} is fixed; give one")
    limits |= {name: _checked_bounds(name, pair, spec) for name, pair in bounds.items()}
    _check_within("start", start, limits)
    # A mass that was weighed may be any foot's and plate's; the bounds are those of a search.
    _check_within("fixed value", fixed, limits if "m" in bounds else limits | {"m": MASSES})
    _check_emg(inputs, prescribed, spec)
    for name in priors:
        if name in table and table[name].signed:
            raise InputError(f"prior of {name}: it is on a logarithm, and {name} may be negative")
    population = settings.population
    defaults = {} if population is None else population_priors(population, options)
    believed = {name: pair for name, pair in defaults.items() if name in names} | dict(priors)
    known = {name: checked_prior(name, pair, names) for name, pair in believed.items()}
    samples = sum(recording.counted for recording in inputs)
    if samples <= len(names):
        raise InputError(f"{samples} samples cannot determine {len(names)} parameters")
    return FitProblem(
        spec=spec,
        options=options,
        inputs=tuple(inputs),
        free=names,
        base=np.array([np.clip(base[n], *limits[n]) if n in names else base[n] for n in table]),
        lower=np.array([limits[name][0] for name in names], dtype=float),
        upper=np.array([limits[name][1] for name in names], dtype=float),
        priors=FrozenDict(known),
        settings=settings,
    )


def _spelled_out(free: Sequence[str], fixed: Collection[str]) -> tuple[str, ...]:
    """The names to free, a drive's name replaced by its parameters that are not fixed."""
    names: list[str] = []
    for name in free:
        group = () if name in OPTIONAL.get(name, ()) else OPTIONAL.get(name, ())
        names += [member for member in group if member not in fixed] or [name]
    return tuple(names)


def _check_within(
    kind: str, values: Mapping[str, float], limits: Mapping[str, tuple[float, float]]
) -> None:
    """Refuse a value outside its bounds: it is a slip, or the bounds are to be others."""
    for name, value in values.items():
        low, high = limits[name]
        if not low <= value <= high:
            raise InputError(
                f"{kind} of {name} is {value:g}, outside its bounds {low:g} … {high:g}; give one "
                "between them, or other bounds"
            )


def _check_reflex(free: Sequence[str], values: Mapping[str, float]) -> None:
    """A reflex that is off has no delay to estimate."""
    gains = OPTIONAL["reflex"][:2]
    if "reflex_delay" in free and not any(name in free or values[name] for name in gains):
        raise InputError(
            f"reflex_delay is free, but the reflex is off: free {' or '.join(gains)} too, or all "
            "with 'reflex'"
        )


def _check_prescribed(recording: ModelInputs, spec: ModelSpec) -> None:
    """Refuse what a recording's own description fixes wrongly, naming its file."""
    with within(f"{recording.where}: fixed"):
        check_names(recording.fixed, spec)
        for name, value in recording.fixed.items():
            check_value(spec.parameters[spec.names.index(name)], value, spec)


def _agreed_fixed(
    inputs: Sequence[ModelInputs], overridden: Mapping[str, float]
) -> dict[str, float]:
    """What the recordings prescribe together; a contradiction that stays is an error."""
    agreed: dict[str, float] = {}
    for recording in inputs:
        for name, value in recording.fixed.items():
            if agreed.setdefault(name, value) != value and name not in overridden:
                raise InputError(
                    f"{recording.where}: fixes {name} at {value:g}, another recording at "
                    f"{agreed[name]:g}; fit them apart or fix {name} yourself"
                )
    return agreed


def _agreed_unit(inputs: Sequence[ModelInputs]) -> str:
    units = {recording.emg_unit for recording in inputs}
    if len(units) > 1:
        raise InputError(
            "some recordings have EMG in V and some normalised: their weights cannot be shared; "
            "fit them apart"
        )
    for recording in inputs:
        if recording.emg_reference != inputs[0].emg_reference:
            raise InputError(
                f"{recording.where}: its EMG was divided by another reference than that of "
                f"{inputs[0].where}: their weights cannot be shared; normalise all recordings of "
                "a session together, never each by itself"
            )
    return units.pop()


def _checked_bounds(name: str, pair: object, spec: ModelSpec) -> tuple[float, float]:
    if not isinstance(pair, Sequence | np.ndarray) or len(pair) != 2:
        raise InputError(f"bounds of {name} are {pair!r}; give a lower and an upper one")
    low, high = pair
    parameter = spec.parameters[spec.names.index(name)]
    for value in (low, high):
        check_value(parameter, value, spec)
    if not low < high:
        raise InputError(f"bounds of {name} are {low:g} … {high:g}; the lower must be the smaller")
    return float(low), float(high)


def _check_weight(recording: ModelInputs) -> None:
    w = recording.weight
    if w is not None and (w.shape != (recording.n,) or not np.isfinite(w).all() or w.min() < 0):
        raise InputError(
            f"{recording.name}: weight must hold {recording.n} finite numbers of zero or more, "
            "one a sample"
        )
    if recording.counted == 0:
        raise InputError(
            f"{recording.name}: every sample has weight 0; leave the recording out instead"
        )


def _without(recording: ModelInputs, channels: Collection[int]) -> ModelInputs:
    """The recording without these channels' EMG."""
    gone = {MUSCLES[c] for c in channels} | {*recording.missing_emg}
    if gone == {*recording.missing_emg}:
        return recording
    emg = recording.emg.copy()
    emg[:, [MUSCLES.index(m) for m in gone]] = 0.0
    missing = tuple(m for m in MUSCLES if m in gone)
    return replace(recording, emg=read_only(emg), missing_emg=missing)


def _check_emg(inputs: Sequence[ModelInputs], fixed: Mapping[str, float], spec: ModelSpec) -> None:
    """A muscle without EMG needs its weight fixed: its column is all zeros."""
    for recording in inputs:
        for muscle in recording.missing_emg:
            weight = spec.weights[MUSCLES.index(muscle)]
            if weight not in fixed:
                raise InputError(
                    f"{recording.where}: no EMG of muscle {muscle!r}, so its weight {weight} "
                    f"cannot be estimated; add the channel emg_{muscle} or fix the weight "
                    f"({weight}=0)"
                )
