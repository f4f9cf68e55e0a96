"""A mapping of one file that lies beside others of the same layout, which it can describe too."""

from collections.abc import Collection
from contextlib import suppress
from pathlib import Path

from surae.base.errors import InputError
from surae.base.files import PathLike
from surae.recording.formats import open_table
from surae.recording.mapping import Description, recognises
from surae.recording.source import open_source

#: More mappings beside a file are not looked at.
_MOST = 200


def description_beside(path: PathLike, names: Collection[str] | None = None) -> Description | None:
    """The mapping in a file's folder that describes one other file, all of whose columns it has.

    `names` are the file's columns, where they are known. None where there is no such mapping, or
    where two say different things of these columns: then nobody knows which is meant.
    """
    file = Path(path)
    tomls = sorted(file.resolve().parent.glob("*.toml"))[:_MOST]
    fitting: list[Description] = []
    for toml in tomls:
        with suppress(InputError):
            source = open_source(toml)
            if not recognises(source):
                continue
            description = Description.of(source)
            names = open_table(open_source(file), timed=False).names if names is None else names
            if _is_of_one_file(description) and _columns(description) <= {*names}:
                fitting.append(description)
    alike = [each for each in fitting if _says(each) == _says(fitting[0])]
    return fitting[0] if fitting and len(alike) == len(fitting) else None


def _is_of_one_file(description: Description) -> bool:
    """Whether it is a mapping of one recording that lies in one file."""
    return len(description.named) == 1 and not description.patterns and not description.trials


def _columns(description: Description) -> set[str]:
    """The columns that it names."""
    return {channel.column for channel in description.mapped().channels.values()}


def _says(description: Description) -> dict[str, object]:
    """What it says, but for names."""
    table = {k: v for k, v in description.toml.items() if k not in ("name", "date", "notes")}
    channels = {
        role: {key: value for key, value in each.items() if key != "file"}
        for role, each in description.toml["channels"].items()
    }
    return {**table, "channels": channels}
