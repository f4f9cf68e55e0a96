"""The formats of data files: surae's own, OpenSim's, other programs' and those of plugins."""

import re
from collections import Counter
from collections.abc import Iterable, Mapping, Sequence
from dataclasses import replace
from itertools import chain
from pathlib import Path
from typing import Any

from surae.base.cleaning import cleaned
from surae.base.errors import InputError
from surae.base.files import PathLike, shown
from surae.base.plugins import plugins
from surae.recording import delimited, hdf5, opensim, unread
from surae.recording.format_module import FormatModule
from surae.recording.source import Source
from surae.recording.table import Column, Table
from surae.recording.unknown import not_understood

#: In the order in which they are asked, `_others` behind them; CSV takes what no other claims.
FORMATS: tuple[FormatModule, ...] = (hdf5, opensim)
#: Columns of a file.
_MOST = 10_000
#: What data sets in subfolders (BIDS) say of themselves in tables: no recordings.
_ABOUT = re.compile(
    r"(?:participants|samples|sessions)\.tsv|sub-.*_(?:scans|events|channels|electrodes)\.tsv",
    re.IGNORECASE,
)
#: How the names of files end that can hold signals.
ENDINGS = (".h5", ".hdf5", ".csv", ".tsv", ".txt", ".sto", ".mot")


def trial_names(paths: Sequence[Path], own: Sequence[str] = ()) -> list[str]:
    """What trials are called: as their files, or by their `own` names, and what tells two apart.

    That is the folder, or within one folder the end of the file's name.
    """
    own = own or [path.stem for path in paths]
    folders = [path.resolve().parent for path in paths]
    alike = Counter(own)
    beside = Counter(zip(folders, own, strict=True))
    names = []
    for path, folder, name in zip(paths, folders, own, strict=True):
        one = path.name if beside[folder, name] > 1 else name
        names.append(shown(f"{folder.name}-{one}" if alike[name] > beside[folder, name] else one))
    return names


def data_files(folder: PathLike) -> list[Path]:
    """The files of a folder that can hold signals, by their names' ends.

    Raises
    ------
    InputError
        There is no such folder, or it cannot be read.
    """
    try:
        files = [path for path in Path(folder).iterdir() if path.is_file()]
    except OSError as error:
        raise InputError(f"cannot read {shown(folder)}: {str(error.strerror).lower()}") from None
    ends = {*ENDINGS, *chain(*(getattr(form, "ENDINGS", ()) for form in _others()))}
    return sorted(
        path
        for path in files
        if path.suffix.lower() in ends
        and not path.name.startswith(".")
        and not _ABOUT.fullmatch(path.name)
    )


def open_table(source: Source, *, timed: bool = True) -> Table:
    """The columns of a data file in any supported format.

    A table without times is read too where `timed` is false: its rows are then counted.

    Raises
    ------
    InputError
        The file is of no supported format or its header is wrong.
    """
    source = source.in_utf8()
    form = next((form for form in chain(FORMATS, _others()) if form.recognises(source)), None)
    if form is None and (known := unread.named(source)):
        raise InputError(known)
    table = form.open_table(source) if form else delimited.open_table(source)
    if timed and not table.time_name:
        raise InputError(not_understood(source, table))
    if len(table.names) > _MOST:
        raise InputError(
            f"{source.shown}: {len(table.names)} columns, more than the {_MOST} that are read; "
            "keep those of the recording"
        )
    return _printable(table)


def _printable(table: Table) -> Table:
    """A table whose texts can be shown and written anywhere."""
    original = {cleaned(name): name for name in reversed((*table.names, table.time_name))}
    retimed: Any = table.retimed
    cells: Any = table.cells
    if all(name == its for name, its in original.items()):
        names = table.names
        load = table.load
    else:
        names = tuple(map(cleaned, table.names))

        def load(wanted: Sequence[str]) -> Mapping[str, Column]:
            loaded = table.load([original[name] for name in wanted])
            return {name: replace(loaded[original[name]], name=name) for name in wanted}

    return replace(
        table,
        names=names,
        load=load,
        time_name=cleaned(table.time_name),
        units={cleaned(name): cleaned(unit) for name, unit in table.units.items()},
        remarks={cleaned(name): cleaned(text, 1000) for name, text in table.remarks.items()},
        descriptions={cleaned(name): cleaned(text) for name, text in table.descriptions.items()},
        notes={key: cleaned(text) for key, text in table.notes.items()},
        offered=table.offered and replace(table.offered, column=cleaned(table.offered.column)),
        retimed=table.retimed
        and (lambda name, unit: _printable(retimed(original.get(name, name), unit))),
        cells=table.cells and (lambda name: cells(original[name])),
    )


def _others() -> Iterable[FormatModule]:
    """Other programs' formats and those of plugins: loaded where surae's own are not meant."""
    from surae.recording import programs

    return (programs, *plugins("readers", FormatModule).values())
