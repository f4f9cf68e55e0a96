"""`surae inspect`."""

import json
from pathlib import Path

import click

from surae import api
from surae.base.errors import InputError
from surae.base.files import shown, write_atomic
from surae.base.records import to_plain
from surae.cli.options import MAPPING
from surae.cli.paths import check_outputs, check_recordings
from surae.cli.progress import work
from surae.cli.screen import show_answer, show_line


@click.command("inspect")
@click.argument("files", metavar="FILE…|DIR", nargs=-1, required=True)
@MAPPING
@click.option("--side", metavar="left|right", help="The leg, where the files hold both.")
@click.option("--output", metavar="MAP.toml", help="Write the mapping, to check and then fit.")
@click.option("--json", "as_json", is_flag=True, help="Write JSON to stdout instead of a table.")
def command(
    files: tuple[str, ...], mapping: str | None, side: str | None, output: str | None, as_json: bool
) -> None:
    """List the channels of data files, and guess which signal each is.

    Several files, or a folder, may hold the channels of one recording, or trials of one layout:
    then one mapping serves all, and where trials differ is listed. Guesses go by names and are
    never used unseen: MAP.toml holds them with comments on what to check, and is what `surae fit`
    takes. With --mapping: what each file is when it is read so.
    """
    check_recordings(files)
    if output is not None and not output.lower().endswith(".toml"):
        raise InputError(f"--output: {shown(output)} must end in .toml, which says what it is")

    paths = [
        str(path)
        for given in files
        for path in (api.data_files_below(given) if Path(given).is_dir() else [given])
    ]
    if not paths:
        raise InputError(f"{shown(files[0])}: no data file is there")
    check_outputs({"--output": output}, paths)
    if mapping is not None:
        if output is not None or as_json:
            raise InputError("--mapping shows how files are read; give it alone")
        _as_mapped(paths, mapping)
        return
    with work() as progress:
        progress.describe(f"reading {', '.join(paths[:3])}{' …' if len(paths) > 3 else ''}")
        inspected = api.inspect_trials(paths, side=side)
    if output is not None and not _is_empty(inspected):
        folder = Path(output).parent
        if isinstance(inspected, api.InspectedTrials):
            write_atomic(output, api.trials_text(inspected, folder))
        else:
            write_atomic(output, api.mapping_text(inspected, folder))

    _refuse_empty(inspected)
    if as_json:
        show_line(json.dumps(to_plain(inspected), indent=1, allow_nan=False, ensure_ascii=False))
        return
    to = "MAP.toml" if output is None else shown(output)
    shown_files = f"{shown(files[0])}{' …' if len(files) > 1 else ''}"
    if isinstance(inspected, api.InspectedTrials):
        show_answer(inspected.typical.as_table())
        _show_trials(inspected)
        then = f"surae session {shown_files} --mapping {to} --output OUT"
    else:
        show_answer(inspected.as_table())
        then = f"surae fit {to}"
    if output is None:
        show_line(f"To use it: --output MAP.toml, check the comments in it, {then}")
    else:
        show_line(f"mapping: {to}; check its comments, then: {then}")


def _is_empty(inspected: "api.Inspection | api.InspectedTrials") -> bool:
    """Whether no channel is, or could be, a signal."""
    one = inspected.typical if isinstance(inspected, api.InspectedTrials) else inspected
    return not one.roles and not one.open


def _refuse_empty(inspected: "api.Inspection | api.InspectedTrials") -> None:
    """Show what is there, and end as wrong input does, where nothing of it can be mapped."""
    if not _is_empty(inspected):
        return
    one = inspected.typical if isinstance(inspected, api.InspectedTrials) else inspected
    show_answer(one.as_table())
    raise InputError(api.nothing_mapped(one))


def _show_trials(inspected: "api.InspectedTrials") -> None:
    """Show of how many trials that was one, and where the others differ."""
    show_line(f"- {len(inspected.trials)} trials of this layout: {', '.join(inspected.trials)}")
    trials_by_text: dict[str, list[str]] = {}
    for difference in inspected.differences:
        trials_by_text.setdefault(difference.text, []).append(difference.trial)
    for text, trials in trials_by_text.items():
        show_line(f"- {', '.join(trials)}: {text}")
    for text in inspected.directions:
        show_line(f"- {text}")


def _as_mapped(paths: list[str], mapping: str) -> None:
    """What a mapping makes of each file; refused where one cannot be read so."""
    wrong = 0
    for path in paths:
        try:
            show_line(repr(api.read(path, mapping=mapping)))
        except InputError as error:
            wrong += 1
            show_line(f"{shown(path)}: {error}")
    if wrong:
        raise InputError(f"{wrong} of {len(paths)} files cannot be read so")
