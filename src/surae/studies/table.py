"""The table of a study: one row for each combination of its factors, in a fixed order."""

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
    """Names of the columns: factors, goodness, three of every parameter estimated."""
    models = [MODELS[str(name)] for name in study.factors["model"]]
    names = dict.fromkeys(p.name for m in MODELS.values() for p in m.parameters)
    estimated = [name for name in names if any(name in m.free for m in models)]
    parameters = [name + end for name in estimated for end in ("", "_sem", "_true")]
    return [*study.factors, "status", "vaf", "ipde", *parameters]


def table(store: Store) -> Iterator[dict[str, Cell]]:
    """The rows whose fit is there, in the order of the plan, by column."""
    study = parse_study(store.text())
    names = columns(study)
    for factors, outcome in store.rows():
        row: dict[str, Cell] = dict.fromkeys(names)
        row |= factors | {"status": outcome.status, "vaf": outcome.vaf, "ipde": outcome.ipde}
        for one in outcome.estimates:
            row[one.name], row[f"{one.name}_sem"] = one.value, one.sem
            row[f"{one.name}_true"] = one.true
        yield row


def export(store: Store, path: PathLike) -> int:
    """Write the table, as Parquet where the name ends so, else as CSV; its number of rows.

    Numbers are written so that they are read back without loss; a missing one is an empty cell.

    Raises
    ------
    InputError
        The file cannot be written, or Parquet is not installed.
    """
    names = columns(parse_study(store.text()))
    rows = list(table(store))
    if Path(path).suffix.lower() == ".parquet":
        _write_parquet(path, names, rows)
        return len(rows)
    with atomic_file(path) as handle:
        handle.write(csv_row(names).encode())
        handle.writelines(csv_row(row[name] for name in names).encode() for row in rows)
    return len(rows)


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
