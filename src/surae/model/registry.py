"""The models by name: adding one is one file with a simulator and one line here, or a plugin."""

from collections.abc import Iterable, Mapping
from dataclasses import dataclass, field, replace
from importlib import import_module
from typing import TYPE_CHECKING

import numpy as np

from surae.base.errors import InputError
from surae.base.formatting import named, nearest
from surae.base.frozen import Comparable
from surae.base.plugins import Extended, plugins
from surae.base.setting import is_number
from surae.base.units import FloatArray
from surae.model.geometry_table import GeometryTable
from surae.model.model_2010 import PARAMETERS_2010, WEIGHTS_2010
from surae.model.options import ModelOptions
from surae.model.parameter import Parameter, adapted
from surae.model.parameters import (
    COMPLIANT_ALONE,
    MUSCLE_PARAMETERS,
    OPTIONAL,
    OPTIONAL_PARAMETERS,
    TENDON_PARAMETERS,
)
from surae.signals import ModelInputs

if TYPE_CHECKING:
    from surae.model import Simulator

_WEIGHTS = ("g1", "g2", "g3", "g4")
#: Optional parameters in which the torque is linear.
_LINEAR = ("reflex_tri", "reflex_tib", *(p.name for p in OPTIONAL_PARAMETERS if p.torque))


@dataclass(frozen=True, slots=True, eq=False)
class ModelSpec(Comparable):
    """A model as data."""

    name: str  #: Its name on the command line and in files.
    title: str  #: What it is called in tables and reports, with the thesis's number.
    parameters: tuple[Parameter, ...]  #: All its parameters, in the order of its parameter vectors.
    free: tuple[str, ...]  #: Those a fit estimates by default; the others keep their `start`.
    #: What ties the model to a recording, ``"module:class"``; `simulator` does it. It is imported
    #: only when it is used: numba takes its time.
    tie: str
    #: The simpler model, of the same parameters and fewer, from whose solution a fit of this one
    #: starts; None for a model whose start is solved for its linear parameters.
    parent: str | None = None
    weights: tuple[str, ...] = _WEIGHTS  #: The weights of the EMG of TA, GL, SOL and GM.
    #: Parameters in which the torque is linear, given those in none of these three.
    linear: tuple[str, ...] = ()
    #: Slack lengths x0 by whose exp(−k·x0) it is linear too, each with its stiffness k.
    slack: Mapping[str, str] = field(default_factory=dict)
    #: Those along which the sum of squares, its linear parameters solved, has several valleys.
    scanned: tuple[str, ...] = ()
    #: Its optional parameters, the last of `parameters`, see `with_optional`; empty without.
    optional: tuple[str, ...] = ()

    @property
    def names(self) -> tuple[str, ...]:
        """Names of all parameters."""
        return tuple(p.name for p in self.parameters)

    def simulator(
        self, inputs: ModelInputs, options: ModelOptions, *, beyond: bool = False
    ) -> "Simulator":
        """The model tied to a recording, with its optional parameters.

        A movement `beyond` the angles of a geometry's table is refused unless it is wanted.
        """
        if isinstance(options.geometry, GeometryTable) and not beyond:
            options.geometry.check_covers(inputs)
        module, _, name = self.tie.partition(":")
        tied: Simulator = getattr(import_module(module), name)(inputs, options, self.optional)
        return tied

    def vector(self, given: Mapping[str, float], options: ModelOptions) -> FloatArray:
        """Parameter vector from values by name.

        Parameters that the model does not free by default may be left out: they take the start
        that `adapted` gives them under `options`.

        Raises
        ------
        InputError
            A parameter is unknown, missing, not finite or not physical.
        """
        check_names(given, self)
        if missing := [name for name in self.names if name in self.free and name not in given]:
            raise InputError(f"model {self.name!r} needs a value for: {', '.join(missing)}")
        for p in self.parameters:
            if p.name in given:
                check_value(p, given[p.name], self)
        table = adapted(self.parameters, options)
        return np.array([float(given.get(name, p.start)) for name, p in table.items()])


def with_optional(spec: ModelSpec, names: Iterable[str]) -> ModelSpec:
    """The model with every group of optional parameters of which `names` mentions one.

    A group is there whole (`OPTIONAL`), after the model's own parameters, none of it freed.

    Parameters
    ----------
    spec : ModelSpec
        The model.
    names : iterable of str
        Of parameters, whatever they are.

    Returns
    -------
    ModelSpec
        `spec` itself where nothing is to be added.
    """
    mentioned = {*names, *spec.optional}
    compliant = spec.parent is not None  # the rigid kernels have what the thesis prints
    wanted = {
        p
        for name, group in OPTIONAL.items()
        if mentioned.intersection(group) and (compliant or name not in COMPLIANT_ALONE)
        for p in group
    }
    added = tuple(p for p in OPTIONAL_PARAMETERS if p.name in wanted)
    optional = tuple(p.name for p in added)
    if optional == spec.optional:
        return spec
    plain = tuple(p for p in spec.parameters if p.name not in spec.optional)
    linear = tuple(name for name in spec.linear if name not in spec.optional)
    if linear:  # a model of which this is known
        linear += tuple(name for name in optional if name in _LINEAR)
    return replace(spec, parameters=plain + added, linear=linear, optional=optional)


def check_names(names: Mapping[str, object] | tuple[str, ...], spec: ModelSpec) -> None:
    """Refuse a parameter name that the model does not have, listing those it has.

    Raises
    ------
    InputError
        A name is none of the model's.
    """
    for name in names:
        if name not in spec.names:
            known = ", ".join(spec.names)
            raise InputError(
                f"model {spec.name!r} has no parameter {name!r}{nearest(name, spec.names)}; "
                f"it has: {known}"
            )


def check_value(parameter: Parameter, value: float, spec: ModelSpec) -> None:
    """Refuse a value for which the equations have no meaning.

    Parameters
    ----------
    parameter : Parameter
        Which one.
    value : float
        In its unit.
    spec : ModelSpec
        The model, for the message.

    Raises
    ------
    InputError
        It is no finite number, or of a sign that it cannot have.
    """
    if not is_number(value) or not np.isfinite(value):
        raise InputError(f"{spec.name}: {parameter.name} is {value!r}; give a finite number")
    if not parameter.signed and (value < 0 or (parameter.positive and value == 0)):
        rule = "above zero" if parameter.positive else "zero or more"
        unit = "" if parameter.unit == "-" else f" {parameter.unit}"
        raise InputError(f"{spec.name}: {parameter.name} is {value:g}{unit}; it must be {rule}")


_FIFTEEN = tuple(p.name for p in MUSCLE_PARAMETERS)
_WITH_TENDON = MUSCLE_PARAMETERS + TENDON_PARAMETERS


def _compliant(name: str, title: str, *freed: str) -> ModelSpec:
    """One of the models with tendons that give way: what is freed of them is all that differs."""
    return ModelSpec(
        name,
        f"muscle-tendon model{title}",
        _WITH_TENDON,
        (*_FIFTEEN, *freed),
        "surae.model.integrators:muscle_tendon_simulator",
        "muscle",
    )


#: Those that come with surae.
OWN: dict[str, ModelSpec] = {
    spec.name: spec
    for spec in (
        ModelSpec(
            "muscle",
            "muscle model [1.0]",
            MUSCLE_PARAMETERS,
            _FIFTEEN,
            "surae.model.muscle:MuscleSimulator",
            linear=("m", *_WEIGHTS),
            slack={"x0_tri": "k_tri", "x0_tib": "k_tib"},
            scanned=("l0_tri", "l0_tib"),
        ),
        _compliant("muscle-tendon", " [2.0]"),
        _compliant("muscle-tendon-strain", ", tendon strain freed [2.1]", "dlt_tri", "dlt_tib"),
        _compliant("muscle-tendon-toe", ", tendon toe force freed [2.2]", "pt_tri", "pt_tib"),
        ModelSpec(
            "muscle-2010",
            "muscle model of 2010, reconstructed",
            PARAMETERS_2010,
            tuple(p.name for p in PARAMETERS_2010),
            "surae.model.muscle_2010:Muscle2010Simulator",
            weights=WEIGHTS_2010,
            linear=("m", *WEIGHTS_2010, "b_tri", "F0"),
            slack={"x0_tri": "k_tri"},
        ),
    )
}


#: Every model by name, those of plugins too.
MODELS: Mapping[str, ModelSpec] = Extended(OWN, lambda: plugins("models", ModelSpec))
#: Every parameter by name; where a name means something else in another model, as in the muscle
#: model.
PARAMETERS: Mapping[str, Parameter] = Extended(
    {p.name: p for spec in OWN.values() for p in spec.parameters}
    | {p.name: p for p in (*_WITH_TENDON, *OPTIONAL_PARAMETERS)},
    lambda: {p.name: p for spec in plugins("models", ModelSpec).values() for p in spec.parameters},
)


def get_model(name: str) -> ModelSpec:
    """The model called `name`.

    Raises
    ------
    InputError
        The name is unknown; the message lists the known ones.
    """
    return named("model", MODELS, name)
