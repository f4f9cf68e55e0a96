"""What a browser is working on: its content, how it changes, and the fit it asks for."""

from collections.abc import Mapping
from typing import Any

from surae.errors import InputError
from surae.model import ModelOptions, ModelSpec, adapted, get_model
from surae.model.parameters import Parameter
from surae.model.registry import with_optional
from surae.studies.populations import POPULATIONS, TENDONS

#: Keys whose entries a change adds to or, with None, takes away; it replaces all others.
_MERGED = ("parameters", "exclusions", "sliders")

Draft = dict[str, Any]


def empty_draft() -> Draft:
    """What a new session begins with; the settings are those of `surae fit`."""
    return {
        "recordings": [],
        "model": "muscle",
        "options": {},
        "prepared": False,
        "parameters": {},
        "population": None,
        "loss": None,
        "peaks": 0.0,
        "activity": "torque",
        "exclusions": {},
        "body_mass": None,
        "starts": 8,
        "seed": 0,
        "sliders": {},
    }


def changed(draft: Draft, change: Mapping[str, Any]) -> Draft:
    """The draft with a change, itself left as it is."""
    made = dict(draft)
    for key, value in change.items():
        if key in _MERGED and isinstance(value, Mapping):
            entries = {**draft[key], **value}
            made[key] = {name: one for name, one in entries.items() if one is not None}
        else:
            made[key] = value
    return made


def spec_of(draft: Draft) -> ModelSpec:
    """The model of a draft, with the drives of which it mentions a parameter."""
    return with_optional(get_model(draft["model"]), draft["parameters"])


def fit_keywords(draft: Draft, prescribed: Mapping[str, float]) -> dict[str, Any]:
    """The keywords of `surae.fit` that a draft asks for, recordings and weights apart.

    Parameters
    ----------
    draft : dict
        The draft.
    prescribed : mapping of str to float
        What the recordings fix themselves.
    """
    spec = spec_of(draft)
    options = ModelOptions.of(**draft["options"])
    table = adapted(spec.parameters, options)
    fixed: dict[str, float] = {}
    start: dict[str, float] = {}
    bounds: dict[str, tuple[float, float]] = {}
    priors: dict[str, tuple[float, float]] = {}
    free = []
    for name, told in draft["parameters"].items():
        if name not in table:  # of another model that the session had chosen before
            continue
        default, value = table[name], told.get("value")
        if not told.get("free", name in spec.free and name not in prescribed):
            if value is not None:
                fixed[name] = value
            elif name in spec.free and name not in prescribed:
                fixed[name] = default.start
            continue
        if name not in spec.free:
            free.append(name)
        if value is not None:
            start[name] = value
        if told.get("lower") is not None or told.get("upper") is not None:
            low, high = told.get("lower"), told.get("upper")
            bounds[name] = (
                default.lower if low is None else low,
                default.upper if high is None else high,
            )
        if told.get("prior") is not None:
            priors[name] = (told["prior"]["median"], told["prior"]["spread"])
    population = draft["population"]
    return {
        "model": draft["model"],
        "fixed": fixed,
        "free": tuple(free),
        "start": start,
        "bounds": bounds,
        "priors": priors if population is None else (population, priors),
        "loss": draft["loss"],
        "starts": draft["starts"],
        "seed": draft["seed"],
        **draft["options"],
    }


def weighting(draft: Draft, recording: str) -> Any:
    """The `Weighting` of one recording; None where all its samples count alike."""
    from surae.signals import Weighting

    spans = draft["exclusions"].get(recording, [])
    if not spans and not draft["peaks"]:
        return None
    windows = tuple((float(start), float(end), 0.0) for start, end in spans)
    return Weighting(windows=windows, peaks=draft["peaks"], activity=draft["activity"])


def values_of(draft: Draft, emg_unit: str, prescribed: Mapping[str, float]) -> dict[str, float]:
    """The value of every parameter before a fit: slider, else fixed or start, else default."""
    spec = spec_of(draft)
    table = adapted(spec.parameters, ModelOptions.of(**draft["options"]), emg_unit)
    values = {name: float(p.start) for name, p in table.items()}
    values |= {name: float(value) for name, value in prescribed.items() if name in table}
    for name, told in draft["parameters"].items():
        if name in table and told.get("value") is not None:
            values[name] = float(told["value"])
    values |= {name: float(v) for name, v in draft["sliders"].items() if name in table}
    return values


def parameter_table(
    draft: Draft, emg_unit: str, prescribed: Mapping[str, float]
) -> list[dict[str, Any]]:
    """The parameters of the draft's model as a page shows them."""
    spec = spec_of(draft)
    table = adapted(spec.parameters, ModelOptions.of(**draft["options"]), emg_unit)
    now = values_of(draft, emg_unit, prescribed)
    priors = _population(draft)
    rows = []
    for name, p in table.items():
        told = draft["parameters"].get(name, {})
        default = described(p, name in spec.free)
        if name in prescribed:
            default |= {"free": False, "value": prescribed[name]}
        given = {
            key: told[key]
            for key in ("free", "value", "lower", "upper")
            if told.get(key) is not None
        }
        rows.append(
            {
                "name": name,
                "unit": p.unit,
                "meaning": p.meaning,
                "group": p.group,
                **default,
                **given,
                "prior": told.get("prior") or priors.get(name),
                "default": default,
                "slider": now[name],
                "normal": normal(name, "healthy"),
                "patient": normal(name, "patient"),
                "prescribed": prescribed.get(name),
                "optional": name in spec.optional,
            }
        )
    return rows


def described(p: Parameter, free: bool) -> dict[str, Any]:
    """The defaults of one parameter."""
    return {"free": free, "value": p.start, "lower": p.lower, "upper": p.upper}


def normal(name: str, population: str) -> list[float] | None:
    """The range of a parameter in a population; None where nothing is known."""
    limits = POPULATIONS[population].get(name) or TENDONS[population].get(name)
    return None if limits is None else list(limits)


def _population(draft: Draft) -> dict[str, dict[str, float]]:
    """Default priors that the draft asks for."""
    if draft["population"] is None:
        return {}
    from surae.estimation.population import population_priors

    try:
        known = population_priors(draft["population"], ModelOptions.of(**draft["options"]))
    except InputError:
        return {}
    return {name: {"median": m, "spread": s} for name, (m, s) in known.items()}
