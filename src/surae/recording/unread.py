"""Formats that are not read: each by its name, and how its program exports what is."""

import tomllib
from collections.abc import Mapping
from importlib.resources import files
from pathlib import Path
from typing import Any

from surae.recording.source import Source

#: How files begin, and how their names end, that are not read.
KNOWN: Mapping[str, Any] = tomllib.loads(
    files("surae.recording").joinpath("unread.toml").read_text(encoding="utf-8")
)


def named(source: Source) -> str:
    """What a file is that no reader takes, and how to export it; empty where it is not known."""
    ending = Path(source.path).suffix.lower()
    for at, magic, what, export in KNOWN["begins"]:
        if source.data.startswith(magic.encode("latin-1"), at):
            return _said(source, what, export)
    if b"\0" in source.data[:65536]:
        known = KNOWN["programs"].get(ending)
        if known is not None:
            return _said(source, f"of {known[0]}", known[1])
    return ""


def _said(source: Source, what: str, export: str) -> str:
    return f"{source.shown}: this is {what}, which is not read here; to export it: {export}"
