"""Tables of a batch, however long: CSV row by row, Parquet piece by piece.

Rows come from the store one at a time, twice: once for the columns' names, once to be written. A
piece of Parquet is named by what is in it, so that a later run writes only those that are new.
"""

import hashlib
import json
from collections.abc import Callable, Iterable, Iterator, Sequence
from itertools import islice
from pathlib import Path
from typing import Any

from surae.base.errors import InputError
from surae.base.files import atomic_file, csv_row, make_folder, shown
from surae_thesis.section import Cell

#: Rows of a piece.
ROWS = 5_000
#: Columns that are no real numbers, or end so: what they are to Arrow.
_TEXTS = ("subject", "protocol", "model", "fixed", "status", "grade", "message", "file", "verdict")
_WHOLE = ("repetition",)

Rows = Callable[[], Iterable[tuple[Cell, ...]]]


def write_pieces(folder: Path, name: str, columns: Sequence[str], rows: Rows) -> int:
    """Write NAME.csv and, where pyarrow is there, the folder NAME.parquet; how many rows.

    Raises
    ------
    InputError
        They cannot be written.
    """
    count = 0
    with atomic_file(folder / f"{name}.csv") as handle:
        handle.write(csv_row(columns).encode())
        for row in rows():
            handle.write(csv_row(row).encode())
            count += 1
    try:
        import pyarrow as arrow
        from pyarrow import parquet
    except ImportError:
        return count
    place = make_folder(folder / f"{name}.parquet")
    schema = arrow.schema([(column, _type(arrow, column)) for column in columns])
    wanted = set()
    try:
        for number, piece in enumerate(_parted(rows())):
            text = json.dumps([list(columns), piece])
            digest = hashlib.sha256(text.encode()).hexdigest()[:16]
            path = place / f"part-{number:05d}-{digest}.parquet"
            wanted.add(path.name)
            if path.is_file():
                continue
            table = arrow.Table.from_pydict(
                dict(zip(columns, map(list, zip(*piece, strict=True)), strict=True)), schema=schema
            )
            with atomic_file(path) as handle:
                parquet.write_table(table, handle)
        for old in place.glob("part-*.parquet"):
            if old.name not in wanted:
                old.unlink()
    except OSError as error:
        raise InputError(f"cannot write {shown(place)}: {error.strerror}") from None
    return count


def _parted(rows: Iterable[tuple[Cell, ...]]) -> Iterator[list[tuple[Cell, ...]]]:
    every = iter(rows)
    while piece := list(islice(every, ROWS)):
        yield piece


def _type(arrow: Any, column: str) -> Any:
    """What a column holds, whatever this piece has of it."""
    if column in _WHOLE:
        return arrow.int64()
    return arrow.string() if column.endswith(_TEXTS) else arrow.float64()
