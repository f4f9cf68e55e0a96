"""The sections of the reproduction, in the order of the page."""

from collections.abc import Sequence
from importlib import import_module

from surae.errors import InputError
from surae.reproduction.chapter import Section

#: Name → module with its `SECTION`; imported only when it is run.
SECTIONS = {
    "protocols": "surae.reproduction.protocols",
    "tendons": "surae.reproduction.tendons",
    "simulation": "surae.reproduction.simulation",
    "subjects": "surae.reproduction.cohort.subjects",
    "beyond": "surae.reproduction.cohort.beyond",
    "appendix": "surae.reproduction.appendix",
}


def sections(only: Sequence[str] = ()) -> list[Section]:
    """The sections asked for, all of them by default, in the order of the page.

    Raises
    ------
    InputError
        A name is not known.
    """
    for name in only:
        if name not in SECTIONS:
            raise InputError(f"no section {name!r}; use one of: {', '.join(SECTIONS)}")
    chosen = [name for name in SECTIONS if not only or name in only]
    return [section(name) for name in chosen]


def section(name: str) -> Section:
    """The section of a name of `SECTIONS`."""
    found: Section = import_module(SECTIONS[name]).SECTION
    return found
