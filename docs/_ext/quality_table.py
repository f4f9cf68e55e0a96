"""The table of the quality gate's codes, made of its records at every build."""

from surae.quality import KINDS


def table() -> str:
    """A table in Markdown: every code, what it looks for, what to do."""
    rows = "".join(f"| `{k.code}` | {k.looks_for} | {k.advice} |\n" for k in KINDS.values())
    return "| code | looks for | what to do |\n|---|---|---|\n" + rows
