"""What terms and symbols mean, for the page."""

import re
from dataclasses import dataclass, replace
from functools import cache
from importlib.resources import files

from surae import api

#: A term of the glossary: its bold name, what else stands on its line, and the explanation.
_ENTRY = re.compile(r"^\*\*(.+?)\*\*(.*)\n: ((?:.+\n?(?:  )?)+)", re.MULTILINE)
_CODE = re.compile(r"`([^`]+)`")


@dataclass(frozen=True, slots=True)
class Term:
    """An entry of the glossary."""

    key: str  #: What a link to it says after the ``#``.
    #: `name`, `more`, `text`: its name, what stands beside it, and what it means.
    name: str
    more: str
    text: str


@dataclass(frozen=True, slots=True)
class Symbol:
    """A parameter: its symbol, meaning, unit, and the models that have it."""

    name: str
    meaning: str
    unit: str
    models: tuple[str, ...]


@cache
def terms() -> tuple[Term, ...]:
    """The entries of the documentation's glossary, in its order."""
    text = (files("surae_workbench.web") / "glossary.md").read_text(encoding="utf-8")
    return tuple(
        Term(
            re.sub(r"[^a-z0-9]+", "-", name.lower()).strip("-"),
            _CODE.sub(r"\1", name),
            _CODE.sub(r"\1", more).lstrip(", "),
            _CODE.sub(r"\1", " ".join(explanation.split())),
        )
        for name, more, explanation in _ENTRY.findall(text)
    )


@cache
def symbols() -> tuple[Symbol, ...]:
    """Every parameter of every model, and what the laboratory cannot rule out."""
    known: dict[str, Symbol] = {}
    rows = [(p, spec.title) for spec in api.MODELS.values() for p in spec.parameters]
    for parameter, model in (*rows, *((p, "") for p in api.OPTIONAL_PARAMETERS)):
        before = known.get(parameter.name)
        meaning, models = parameter.meaning, (model,) if model else ()
        if before is not None:  # the same letter may stand for another thing in another model
            other = "" if before.meaning.startswith(meaning) else f"; of {model}: {meaning}"
            meaning, models = (
                before.meaning + other,
                tuple(dict.fromkeys((*before.models, *models))),
            )
        known[parameter.name] = Symbol(parameter.name, meaning, parameter.unit, models)
    every = tuple(spec.title for spec in api.MODELS.values())
    return tuple(replace(each, models=_shortly(each.models, every)) for each in known.values())


def _shortly(models: tuple[str, ...], every: tuple[str, ...]) -> tuple[str, ...]:
    """The models, or those that are missing where that is one at most."""
    missing = [model for model in every if model not in models]
    if len(missing) > 1:
        return models
    return (" but the ".join(("every model", *missing)),)
