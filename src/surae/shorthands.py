"""Keywords of a fit that stand for several of its settings."""

from typing import Any

from surae.base import names
from surae.effects import check_knowledge
from surae.model.options import ModelOptions


def with_geometry(
    model: str, options: ModelOptions, given: dict[str, Any], switches: dict[str, Any]
) -> dict[str, Any]:
    """Keywords with the knowledge that they name as a file.

    A geometry in it is put among the model's `switches` where there is no other.
    """
    from surae.model.knowledge_file import knowledge_of

    known = knowledge_of(given["knowledge"])
    check_knowledge(model, known)
    of_person = known.table is not None and options.geometry == ModelOptions().geometry
    of_person = of_person and switches.setdefault("geometry", known.table) is known.table
    if of_person and model == names.AUTO:
        given.setdefault("geometry_of", known.geometry_of)
    return {**given, "knowledge": known}


def priors_of_keyword(given: Any) -> dict[str, Any]:
    """The fields that the keyword `priors` of `surae.fit` stands for."""
    population, known = given if isinstance(given, tuple) else (None, given)
    if isinstance(known, str):
        population = known
        known = {}
    return {"priors": known or {}} | ({} if population is None else {"population": population})
