"""Which options have an effect on which model; one that has none is refused in one line."""

from collections.abc import Collection, Iterator
from dataclasses import fields, replace

from surae.base import names
from surae.base.errors import InputError
from surae.estimators import names_of, options_of
from surae.model.knowledge import Knowledge
from surae.model.options import ModelOptions

#: Switches of equations that only some models have: of compliant tendons.
_OF_TENDONS = ("tendon_strain", "integrator")
#: What the virtual-work geometry alone reads.
_OF_VIRTUAL_WORK = ("x_ref_tri", "x_ref_tib")
#: What becomes a prior of what the laboratory cannot rule out, which a named model does not have;
#: a size or an arm that is stated is in its intervals.
_PRIORS = (
    "axis_mm",
    "geometry_sd_percent",
    "mass_kg",
    "crosstalk",
)
#: What to do about an option that only the other kind of estimator has.
_NAMED = "leave it out, or name a model, as model='muscle' (--model muscle)"
_AUTO = f"leave it out, or use model {names.AUTO}"


def refuse(option: str, model: str, remedy: str) -> InputError:
    """The one line about an option that changes nothing of a fit."""
    return InputError(f"{option} has no effect with model {model}; {remedy}")


def check_estimator(model: str, given: Collection[str]) -> None:
    """Refuse what only the estimator of other models is asked, of the options that are `given`.

    Raises
    ------
    InputError
        One has no effect.
    """
    there = names_of(options_of(model))
    for name in given:
        if name in names_of() and name not in there:
            raise refuse(name, model, _NAMED if model == names.AUTO else _AUTO)


def check_switches(
    model: str, given: Collection[str], options: ModelOptions, mentioned: Collection[str]
) -> None:
    """Refuse switches that are `given` and that no equation of the model reads.

    `mentioned` are the parameters that the request names; `emg_shape` alone reads `emg_ref`.

    Raises
    ------
    InputError
        One has no effect.
    """
    for name in given:
        if name in _OF_TENDONS and model != names.AUTO and not _has_tendons(model):
            raise refuse(name, model, "leave it out, or use a model with tendons, as muscle-tendon")
        if name == "integrator" and model == names.AUTO:
            raise refuse(name, model, f"its own is {ModelOptions().integrator}; {_NAMED}")
        if name in _OF_VIRTUAL_WORK and options.geometry == ModelOptions().geometry:
            remedy = "leave it out, or give geometry='virtual-work' (--geometry virtual-work)"
            raise refuse(name, f"{model} and geometry {options.geometry}", remedy)
        if name == "emg_ref" and model != names.AUTO and "emg_shape" not in mentioned:
            raise refuse(
                name, model, "leave it out, or free or fix emg_shape, which alone reads it"
            )


def check_knowledge(model: str, known: Knowledge) -> None:
    """Refuse what a named model has no prior for, of what is known beforehand.

    Raises
    ------
    InputError
        Something stated has no effect.
    """
    for part in prior_parts(known) if model != names.AUTO else ():
        remedy = f"leave it out of what is known (session.toml), or use model {names.AUTO}"
        raise refuse(f"knowledge: {part}", model, remedy)


def prior_parts(known: Knowledge) -> Iterator[str]:
    """What is known that only priors can take in, by name."""
    yield from (part for part in _PRIORS if getattr(known, part))
    if known.plate is not None and not known.plate.file:
        yield "plate"
    if known.geometry_of == names.GEOMETRY_OF[1]:
        yield "geometry_of"


def without_priors(known: Knowledge) -> Knowledge:
    """What a named model reads: the angle's zero, a recorded plate, arms, a generic geometry."""
    usual = {each.name: getattr(Knowledge(), each.name) for each in fields(Knowledge)}
    return replace(known, **{part: usual[part] for part in prior_parts(known)})


def differing(options: ModelOptions) -> set[str]:
    """Names of switches that are not as they are by default."""
    usual = ModelOptions()
    names_ = [each.name for each in fields(options)]
    return {name for name in names_ if getattr(options, name) != getattr(usual, name)}


def _has_tendons(model: str) -> bool:
    """Whether a model's tendons give way; a plugin's may."""
    from surae.model.registry import OWN

    return model not in OWN or OWN[model].parent is not None
