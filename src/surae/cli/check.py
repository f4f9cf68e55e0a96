"""`surae check`."""

import json
from collections.abc import Iterator, Sequence
from dataclasses import dataclass, replace
from typing import Any

import click

from surae import api
from surae.base.files import shown
from surae.cli.option_records import as_record
from surae.cli.options import EXCLUDE, MAPPING, corrections
from surae.cli.paths import in_folders
from surae.cli.progress import work
from surae.cli.screen import show_answer, show_line


@dataclass(frozen=True, slots=True)
class Taken:
    """What recordings are taken for, as `surae.check` is told it."""

    exclude: tuple[tuple[float, float, float], ...]  #: Spans of time [s].
    prepared: bool
    commanded: str | None
    joint: str | None


@click.command("check")
@click.argument("recordings", metavar="REC…|DIR", nargs=-1, required=True)
@MAPPING
@corrections
@click.option("--json", "as_json", is_flag=True, help="Print the findings as JSON.")
@click.option("--strict", is_flag=True, help="Exit with 1 if there is a warning or an error.")
@as_record(
    "taken",
    Taken,
    EXCLUDE,
    click.option("--prepared", is_flag=True, help="The signals are used as they are: see `fit`."),
    click.option("--commanded", metavar="P.csv", help="What the device was to follow."),
    click.option("--joint", metavar="JOINT.toml", help="Another joint than the ankle: see `fit`."),
)
def command(
    recordings: tuple[str, ...],
    mapping: str | None,
    as_json: bool,
    strict: bool,
    taken: Taken,
    corrections: dict[str, Any],
) -> int:
    """Look for faults in recordings before they are fitted.

    Every finding has a code, a severity (info, warning, error), a span of time, and says what to
    do. Findings are no failure: the exit status is 0, or with --strict 1 where there is a warning
    or an error. The commanded motion may also be a column commanded_angle_rad of the recording.
    """
    recordings = in_folders(recordings, mapping)

    protocol = None if taken.commanded is None else api.commanded_file(taken.commanded)
    names: list[str] = []
    with work() as progress:

        def each() -> "Iterator[api.AnyRecording]":
            for path in recordings:
                progress.describe(f"reading and checking {path}")
                several = api.is_several(path, mapping)
                if mapping is None and not corrections and not several:
                    names.append(path)
                    yield path
                    continue
                for one in api.read_trials(path, mapping=mapping, **corrections):
                    names.append(f"{path}: {one.name}" if several else path)
                    yield one

        qualities = api.check_together(
            each(),
            commanded=protocol,
            prepared=taken.prepared,
            joint=taken.joint,
            exclude=taken.exclude,
        )
    if as_json:
        click.echo(json.dumps(_plain(names, qualities), ensure_ascii=False, indent=2))
    else:
        for path, quality in zip(names, qualities, strict=True):
            show_answer(replace(quality, recording=shown(path)).as_table())
    return 1 if strict and not all(quality.clean for quality in qualities) else 0


def _plain(paths: Sequence[str], qualities: "Sequence[api.Quality]") -> dict[str, object]:
    """The findings as plain data, each with the recording it is of."""
    checked = [(path, each.as_dict()) for path, each in zip(paths, qualities, strict=True)]
    return {
        key: [{"recording": path, **one} for path, plain in checked for one in plain[key]]
        for key in ("findings", "skipped")
    }


def show_short(quality: "api.Quality") -> None:
    """One line for a recording with findings that matter, and one for each of these."""
    if quality.clean:
        return
    show_line(f"{quality.recording}: {quality.summary}; see `surae check`")
    for finding in quality.findings:
        if finding.severity != "info":
            show_line(f"    {finding.severity} {finding.code}: {finding.message}")
