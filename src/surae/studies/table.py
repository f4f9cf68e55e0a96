"""The table of a study: one row for each combination of its factors, in a fixed order."""

import hashlib
from collections.abc import Iterator
from pathlib import Path

from surae.errors import InputError
from surae.files import PathLike, atomic_file, csv_row
from surae.model import MODELS
from surae.studies.store import Store
from surae.studies.study import Study, Value, parse_study

#: A cell: None where there is no number.
Cell = Value | None


def columns(study: Study) -> list[str]:
    """Names of the columns: factors, goodness, three of every parameter estimated, seconds."""
    models = [MODELS[str(name)] for name in study.factors["model"]]
    names = dict.fromkeys(p.name for m in MODELS.values() for p in m.parameters)
    estimated = [name for name in names if any(name in m.free for m in models)]
    parameters = [name + end for name in estimated for end in ("", "_sem", "_true")]
    return [*study.factors, "status", "vaf", "ipde", *parameters, "seconds"]


def table(store: Store) -> Iterator[dict[str, Cell]]:
    """The rows whose fit is there, in the order of the plan, by column."""
    study = parse_study(store.text())
    names = columns(study)
    for factors, outcome in store.rows():
        row: dict[str, Cell] = dict.fromkeys(names)
        row |= factors | {"status": outcome.status, "vaf": outcome.vaf, "ipde": outcome.ipde}
        for estimate in outcome.estimates:
            name = estimate.name
            row[name], row[f"{name}_sem"] = estimate.value, estimate.sem
            row[f"{name}_true"] = estimate.true
        row["seconds"] = outcome.seconds
        yield row


def export(store: Store, path: PathLike) -> tuple[int, str]:
    """Write the table, as Parquet where the name ends so, else as CSV.

    Numbers are written so that they are read back without loss; a missing one is an empty cell.

    Returns
    -------
    tuple of int and str
        The number of rows, and their hash without the seconds: equal results have equal hashes,
        however long they took.

    Raises
    ------
    InputError
        The file cannot be written, or Parquet is not installed.
    """
    names = columns(parse_study(store.text()))
    rows = list(table(store))
    lines = [csv_row(names), *(csv_row(row[name] for name in names) for row in rows)]
    unhurried = [csv_row(names[:-1]), *(csv_row(row[name] for name in names[:-1]) for row in rows)]
    digest = hashlib.sha256("".join(unhurried).encode()).hexdigest()[:16]
    if Path(path).suffix.lower() == ".parquet":
        _write_parquet(path, names, rows)
    else:
        with atomic_file(path) as handle:
            handle.writelines(line.encode() for line in lines)
    return len(rows), digest


def _write_parquet(path: PathLike, names: list[str], rows: list[dict[str, Cell]]) -> None:
    try:
        import pyarrow as pa
        from pyarrow import parquet
    except ImportError:
        raise InputError(
            "Parquet needs pyarrow: install it with `pip install 'surae[formats]'`, or write a .csv"
        ) from None
    content = {}
    for name in names:
        cells = [row[name] for row in rows]
        # A column without any number is one of numbers all the same.
        kind = pa.float64() if all(cell is None for cell in cells) else None
        content[name] = pa.array(cells, type=kind)
    with atomic_file(path) as handle:
        parquet.write_table(pa.table(content), handle)
