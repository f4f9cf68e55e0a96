"""Families for the last count alone. Who makes or tunes an estimate does not open this file."""

from __future__ import annotations

from ankle_legs.look import Draw

FAMILIES: dict[str, Draw] = {}
