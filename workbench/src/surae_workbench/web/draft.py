"""What a browser is working on: the request of a fit, its recordings, and the sliders."""

from collections.abc import Mapping, Sequence
from contextlib import suppress
from dataclasses import fields, replace
from typing import Any

from pydantic import ValidationError

from surae import api
from surae.base import names
from surae.base.records import from_plain, to_plain
from surae_workbench.web.schemas import DraftChange

#: Keys whose entries a change adds to or, with None, takes away; it replaces all others.
_MERGED = ("exclusions", "sliders")
#: Records of a fit's settings, but for the model's switches, which are a key of their own.
_RECORDS = api.FIT_RECORDS[:-1]
_SETTINGS = tuple(
    field.name for kind in _RECORDS for field in fields(kind) if field.name != "estimator"
)

#: The settings as plain data, with recordings, contractions, spans to leave out, and sliders.
Draft = dict[str, Any]


def empty_draft() -> Draft:
    """What a new session begins with; the settings are those of `surae fit`."""
    data: Draft = {"recordings": [], "mvc": [], "exclusions": {}, "sliders": {}}
    return {**_defaults_of_all(), **data}


def _defaults_of_all() -> Draft:
    """The settings as they are by default, those of both estimators: a model may yet be chosen."""
    plain: Draft = {}
    for kind in _RECORDS:
        plain |= to_plain(kind())
    return {name: plain[name] for name in _SETTINGS}


def changed(draft: Draft, change: Mapping[str, Any]) -> Draft:
    """The draft with a change, itself left as it is."""
    after = dict(draft)
    for key, value in change.items():
        if key in _MERGED and isinstance(value, Mapping):
            entries = {**draft[key], **value}
            after[key] = {name: entry for name, entry in entries.items() if entry is not None}
        elif key == "options":
            after[key] = {**api.FitSettings().options.as_dict(), **value}
        elif key != "parameters":
            after[key] = value
    for name, row in change.get("parameters", {}).items():
        _take_row(after, name, row)
    _check_effect(draft, after)
    return {**after, **_settings(after).as_dict()}


def _check_effect(before: Draft, after: Draft) -> None:
    """Refuse a change that gives what the draft's model does not read.

    What was given before another model was chosen waits for its own.

    Raises
    ------
    InputError
        An option has no effect.
    """
    usual = _defaults_of_all()
    given = {n for n in _SETTINGS if after[n] != before[n] and after[n] != usual[n]}
    model = after["model"]
    api.check_estimator(model, given)
    if "options" in given:
        switches = {
            name
            for name, value in after["options"].items()
            if value != before["options"].get(name) and value != usual["options"].get(name)
        }
        settings = _settings(after)
        api.check_switches(model, switches, settings.options, settings.mentioned)
    if "knowledge" in given:
        api.check_knowledge(model, from_plain(api.Knowledge, after["knowledge"]))


def _take_row(draft: Draft, name: str, row: Mapping[str, Any] | None) -> None:
    """Put into a draft what a row of the parameter table says; None: the defaults."""
    for key in ("fixed", "start", "bounds", "priors"):
        draft[key] = {other: value for other, value in draft[key].items() if other != name}
    draft["free"] = [other for other in draft["free"] if other != name]
    if row is None:
        return
    spec = api.with_optional(api.get_model(api.richest(draft["model"])), {name})
    default = api.adapted(spec.parameters, _settings(draft).options).get(name)
    usual = name in spec.free
    value = row.get("value")
    if not row.get("free", usual):
        if value is not None or default is not None:
            draft["fixed"][name] = default.start if value is None and default else value
        return
    if not usual and row.get("free"):
        draft["free"].append(name)
    if value is not None:
        draft["start"][name] = value
    low = row.get("lower")
    high = row.get("upper")
    if default is not None and (low is not None or high is not None):
        draft["bounds"][name] = [
            default.lower if low is None else low,
            default.upper if high is None else high,
        ]
    if row.get("prior") is not None:
        draft["priors"][name] = [row["prior"]["median"], row["prior"]["spread"]]


def shown(draft: Draft) -> Draft:
    """The draft as pages read it: with what it says of each parameter in one place."""
    rows: dict[str, dict[str, Any]] = {name: {"free": True} for name in draft["free"]}
    for name, value in draft["fixed"].items():
        rows.setdefault(name, {}).update(free=False, value=value)
    for name, value in draft["start"].items():
        rows.setdefault(name, {})["value"] = value
    for name, (low, high) in draft["bounds"].items():
        rows.setdefault(name, {}).update(lower=low, upper=high)
    for name, (median, spread) in draft["priors"].items():
        rows.setdefault(name, {})["prior"] = {"median": median, "spread": spread}
    return {**draft, "parameters": rows}


def upgraded(data: object) -> Draft:
    """A draft as it was kept; of what makes no sense, or is not known here, the defaults."""
    whole = empty_draft()
    kept = data if isinstance(data, Mapping) else {}
    for key in whole.keys() & kept.keys():
        with suppress(ValidationError):
            DraftChange.model_validate({key: kept[key]})
            whole[key] = kept[key]
    return whole


def settings_of(draft: Draft, recordings: Sequence[str]) -> api.FitSettings:
    """What a draft asks of these recordings, given by their ids, for its model.

    Parameters and options of a model that the session had chosen before are left out.
    """
    settings = _settings(draft)
    known = set(spec_of(draft).names)
    kept: dict[str, Any] = {
        field: {name: value for name, value in getattr(settings, field).items() if name in known}
        for field in ("fixed", "start", "bounds", "priors")
    }
    free = (name for name in settings.free if known.issuperset(api.OPTIONAL.get(name, (name,))))
    settings = replace(settings, free=tuple(free), **kept)
    if settings.model != names.AUTO and settings.knowledge is not None:
        settings = replace(settings, knowledge=api.without_priors(settings.knowledge))
    spans = [draft["exclusions"].get(id_, ()) for id_ in recordings]
    if not any(spans):
        return settings
    shared = settings.weights if isinstance(settings.weights, api.Weighting) else api.Weighting()
    each = tuple(
        replace(
            shared, windows=(*shared.windows, *((float(a), float(b), 0.0) for a, b in of_recording))
        )
        for of_recording in spans
    )
    return replace(settings, weights=each[0] if len(each) == 1 else each)


def _settings(draft: Draft) -> api.FitSettings:
    """The draft's settings, without what it says of single recordings."""
    return from_plain(api.FitSettings, {key: draft[key] for key in _SETTINGS})


def spec_of(draft: Draft) -> api.ModelSpec:
    """The model of a draft, with the drives of which it mentions a parameter."""
    return api.with_optional(api.get_model(api.richest(draft["model"])), _settings(draft).mentioned)


def values_of(draft: Draft, emg_unit: str, prescribed: Mapping[str, float]) -> dict[str, float]:
    """The value of every parameter before a fit: slider, else fixed or start, else default."""
    spec = spec_of(draft)
    table = api.adapted(spec.parameters, _settings(draft).options, emg_unit)
    values = {name: float(p.start) for name, p in table.items()}
    values |= {name: float(value) for name, value in prescribed.items() if name in table}
    for entries in (draft["start"], draft["fixed"]):
        values |= {name: float(value) for name, value in entries.items() if name in table}
    values |= {name: float(v) for name, v in draft["sliders"].items() if name in table}
    return values


def parameter_table(
    draft: Draft, emg_unit: str, prescribed: Mapping[str, float]
) -> list[dict[str, Any]]:
    """The parameters of the draft's model as a page shows them."""
    spec = spec_of(draft)
    table = api.adapted(spec.parameters, _settings(draft).options, emg_unit)
    now = values_of(draft, emg_unit, prescribed)
    priors = _population(draft)
    rows = []
    changes_of = shown(draft)["parameters"]
    for name, p in table.items():
        changed = changes_of.get(name, {})
        default = _defaults(p, name in spec.free)
        if name in prescribed:
            default |= {"free": False, "value": prescribed[name]}
        given = {key: changed[key] for key in default if changed.get(key) is not None}
        rows.append(
            {
                **described(p, name in spec.free),
                **default,
                **given,
                "prior": changed.get("prior") or priors.get(name),
                "default": default,
                "slider": now[name],
                "prescribed": prescribed.get(name),
                "optional": name in spec.optional,
            }
        )
    return rows


def described(p: api.Parameter, free: bool) -> dict[str, Any]:
    """What a parameter is, and its defaults."""
    about = {key: getattr(p, key) for key in ("name", "unit", "meaning", "group")}
    return {**about, **_defaults(p, free)}


def _defaults(p: api.Parameter, free: bool) -> dict[str, Any]:
    return {"free": free, "value": p.start, "lower": p.lower, "upper": p.upper}


def _population(draft: Draft) -> dict[str, dict[str, float]]:
    """Default priors that the draft asks for."""
    if draft["population"] is None:
        return {}
    known = api.population_priors(draft["population"], _settings(draft).options)
    return {name: {"median": m, "spread": s} for name, (m, s) in known.items()}
