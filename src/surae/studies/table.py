"""The table of a study: one row for each combination of its factors, in a fixed order."""

import hashlib
from collections.abc import Iterator

from surae.files import PathLike, csv_row, write_table
from surae.model import MODELS
from surae.studies.store import Store
from surae.studies.study import Study, Value, parse_study

#: A cell: None where there is no number.
Cell = Value | None


def study_columns(study: Study) -> list[str]:
    """Names of the columns: factors, goodness, three of every parameter estimated, seconds."""
    models = [MODELS[str(name)] for name in study.factors["model"]]
    names = dict.fromkeys(p.name for m in MODELS.values() for p in m.parameters)
    estimated = [name for name in names if any(name in m.free for m in models)]
    parameters = [name + end for name in estimated for end in ("", "_sem", "_true")]
    return [*study.factors, "status", "vaf", "ipde", *parameters, "seconds"]


def study_table(store: Store) -> Iterator[dict[str, Cell]]:
    """The rows whose fit is there, in the order of the plan, by column."""
    study = parse_study(store.text())
    names = study_columns(study)
    for factors, outcome in store.rows():
        row: dict[str, Cell] = dict.fromkeys(names)
        row |= factors | {"status": outcome.status, "vaf": outcome.vaf, "ipde": outcome.ipde}
        for estimate in outcome.estimates:
            name = estimate.name
            row[name], row[f"{name}_sem"] = estimate.value, estimate.sem
            row[f"{name}_true"] = estimate.true
        row["seconds"] = outcome.seconds
        yield row


def export_study(store: Store, path: PathLike) -> tuple[int, str]:
    """Write the table; see `surae.files.write_table`.

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
    names = study_columns(parse_study(store.text()))
    rows = list(study_table(store))
    unhurried = [csv_row(names[:-1]), *(csv_row(row[name] for name in names[:-1]) for row in rows)]
    digest = hashlib.sha256("".join(unhurried).encode()).hexdigest()[:16]
    write_table(path, names, rows)
    return len(rows), digest
