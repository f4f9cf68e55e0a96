"""The form of a fit, made from its settings."""

from dataclasses import fields as parts
from dataclasses import is_dataclass
from types import NoneType
from typing import Any

from surae import api
from surae.base import names
from surae.base.setting import default_of, kind_of, parts_of, settings_of
from surae.base.words import N_

#: Settings that are records of their own, each of whose settings is a field of the form.
_RECORDS = {
    "options": api.ModelOptions,
    "weights": api.Weighting,
    "preparation": api.Preparation,
    "knowledge": api.Knowledge,
}


def form() -> list[dict[str, Any]]:
    """The fields of the form in their order: what they are called, may hold, and hold by default.

    `path` names a key of the draft, or one within it.
    """
    rows: list[dict[str, Any]] = []
    every = [pair for kind in api.FIT_RECORDS[:-1] for pair in settings_of(kind)]
    for each, record in every:
        for row in fields(_RECORDS[each.name], each.name) if each.name in _RECORDS else ():
            rows.append({**row, "needs": row["needs"] or record.needs})
    return [*(row for kind in api.FIT_RECORDS[:-1] for row in fields(kind)), *rows]


def fields(kind: Any, *within: str) -> list[dict[str, Any]]:
    """Those of a request."""
    return [
        {
            "path": [*within, each.name],
            "label": record.label,
            "kind": "choice" if record.choices else kind_of(each),
            "choices": list((record.words or _words(record.known)).items()),
            "least": record.least if record.above is None else record.above,
            "most": record.most,
            "default": default_of(each),
            "optional": NoneType in parts_of(each.type),
            "parts": [
                part.name
                for kind in parts_of(each.type)
                if is_dataclass(kind)
                for part in parts(kind)
            ],
            "needs": record.needs,
            "first": record.first,
            "file": record.file,
        }
        for each, record in settings_of(kind)
        if record.label
    ]


def _words(choices: tuple[str, ...]) -> dict[str, str]:
    """Choices as a form calls them: models by their titles, others as they are."""
    titles = {names.AUTO: N_("automatic: what the data support")}
    titles |= {spec.name: spec.title for spec in api.MODELS.values()}
    return {choice: titles.get(choice, choice) for choice in choices}
