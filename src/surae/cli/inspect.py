"""`surae inspect`."""

import json
from typing import TYPE_CHECKING

import click

from surae.cli.paths import check_outputs, check_recordings
from surae.errors import InputError
from surae.files import shown

if TYPE_CHECKING:
    from surae.recording import InspectedChannel, Inspection


@click.command("inspect")
@click.argument("files", metavar="FILE…", nargs=-1, required=True)
@click.option("--side", metavar="left|right", help="The leg, where the files hold both.")
@click.option("--output", metavar="MAP.toml", help="Write the mapping, to check and then fit.")
@click.option("--json", "as_json", is_flag=True, help="Write JSON to stdout instead of a table.")
def command(files: tuple[str, ...], side: str | None, output: str | None, as_json: bool) -> None:
    """List the channels of data files, and guess which signal each is.

    Several files may hold the channels of one recording. Guesses go by names and are never used
    unseen: MAP.toml holds them with comments on what to check, and is what `surae fit` takes.
    """
    check_recordings(files)
    if output is not None and not output.lower().endswith(".toml"):
        raise InputError(f"--output: {shown(output)} must end in .toml, which says what it is")
    check_outputs({"--output": output}, files)

    from surae.cli.progress import work
    from surae.recording import inspect, write_mapping

    with work() as progress:
        progress.describe(f"reading {', '.join(files)}")
        found = inspect(files, side=side)
    if output is not None:
        write_mapping(found, output)

    from surae.cli.screen import show_line

    if as_json:
        show_line(json.dumps(found.to_json(), indent=1, allow_nan=False, ensure_ascii=False))
        return
    _show(found)
    if output is not None:
        show_line(f"mapping: {shown(output)}; check its comments, then: surae fit {shown(output)}")
    else:
        show_line("To use it: --output MAP.toml, check the comments in it, surae fit MAP.toml")


def _show(found: "Inspection") -> None:
    """The channels as a table, then what was found and what is left to say."""
    from surae.cli.screen import show_line, show_table
    from surae.recording.table import some

    for path, form in found.formats.items():
        show_line(f"{shown(path)}: {form}")
        headings = ("channel", "unit", "Hz", "samples", "start [s]", "least", "greatest", "role")
        rows = [
            (
                _printable(one.column),
                _printable(one.unit or "–"),
                _number(one.rate_hz, 6),
                "–" if one.n is None else str(one.n),
                _number(one.start_s, 4),
                _number(one.low, 4),
                _number(one.high, 4),
                _role(one, found),
            )
            for one in found.channels
            if one.file == path
        ]
        show_table(headings, rows)
    for role, one in found.roles.items():
        assert one.guess is not None
        show_line(f"{role} = {_printable(one.column)} ({one.guess.confidence}: {one.guess.rule})")
    if found.side is not None:
        show_line(f"side = {found.side} ({found.side_rule})")
    if found.emg is not None:
        show_line(f"EMG = {found.emg} ({found.emg_rule})")
    remarks: dict[str, list[str]] = {}
    for one in found.channels:
        for remark in filter(None, one.remark.split("; ")):
            remarks.setdefault(remark, []).append(one.column)
    for remark, names in remarks.items():
        show_line(f"- {some(names, 3)}: {remark}")
    for line in found.advice:
        show_line(f"- {line}")


def _role(one: "InspectedChannel", found: "Inspection") -> str:
    """The role that a channel has, or with a question mark could have."""
    from surae.recording import MUSCLES

    role = next((role for role, chosen in found.roles.items() if chosen is one), None)
    left = [role for role, several in found.open.items() if any(c is one for c in several)]
    if role is None and len(left) == len(MUSCLES) and all(r.startswith("emg_") for r in left):
        return "emg_?"
    return role or " or ".join(f"{each}?" for each in left) or "–"


def _printable(text: str) -> str:
    return text if text.isprintable() else repr(text)


def _number(value: float | None, digits: int) -> str:
    return "–" if value is None else f"{value:.{digits}g}"
