"""`surae check`."""

import json
from collections.abc import Sequence
from typing import TYPE_CHECKING

import click

from surae.cli.paths import check_recordings
from surae.files import shown

if TYPE_CHECKING:
    from surae.quality import Quality


@click.command("check")
@click.argument("recordings", metavar="REC…", nargs=-1, required=True)
@click.option("--json", "as_json", is_flag=True, help="Print the findings as JSON.")
@click.option("--strict", is_flag=True, help="Exit with 1 if there is a warning or an error.")
@click.option("--commanded", metavar="P.csv", help="What the device was to follow.")
def command(recordings: tuple[str, ...], as_json: bool, strict: bool, commanded: str | None) -> int:
    """Look for faults in recordings before they are fitted.

    Every finding has a code, a severity (info, warning, error), a span of time and an advice. A
    file with findings is no failure: the exit status is 0, but with --strict 1 on a warning or
    error. The commanded motion may also be a column commanded_angle_rad of the recording.
    """
    check_recordings(recordings)

    from surae.api.quality import check
    from surae.cli.progress import work
    from surae.quality import commanded_file

    asked = None if commanded is None else commanded_file(commanded)
    found = []
    with work() as progress:
        for path in recordings:
            progress.describe(f"reading and checking {path}")
            found.append(check(path, commanded=asked))
    if as_json:
        click.echo(json.dumps(_plain(recordings, found), ensure_ascii=False, indent=2))
    else:
        from surae.cli.findings import show_quality

        for path, one in zip(recordings, found, strict=True):
            show_quality(one, shown(path))
    return 1 if strict and not all(one.clean for one in found) else 0


def _plain(paths: Sequence[str], found: "Sequence[Quality]") -> dict[str, object]:
    """The findings as plain data, each with the recording it is of."""
    return {
        "findings": [
            {"recording": path, **finding}
            for path, one in zip(paths, found, strict=True)
            for finding in one.as_dict()["findings"]
        ],
        "skipped": [
            {"recording": path, **skipped}
            for path, one in zip(paths, found, strict=True)
            for skipped in one.as_dict()["skipped"]
        ],
    }
