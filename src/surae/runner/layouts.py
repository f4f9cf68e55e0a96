"""The tables of a ledger, of every version, and what brings an older file to the present one."""

import json
import sqlite3

from surae.database import Format

_RUN = """
CREATE TABLE run (
    id INTEGER PRIMARY KEY, started REAL NOT NULL, ended REAL, how TEXT, process INTEGER NOT NULL,
    host TEXT NOT NULL
);
"""
#: Tables of surae 0.1, when studies alone were kept so.
_FIRST = f"""
CREATE TABLE study (name TEXT NOT NULL, text TEXT NOT NULL);
CREATE TABLE plan (row INTEGER PRIMARY KEY, key TEXT NOT NULL, factors TEXT NOT NULL);
CREATE TABLE outcome (
    key TEXT PRIMARY KEY, status TEXT NOT NULL, message TEXT NOT NULL, vaf REAL, ipde REAL,
    estimates TEXT NOT NULL, seconds REAL NOT NULL, finished REAL NOT NULL
) WITHOUT ROWID;
{_RUN}"""
_TABLES = f"""
CREATE TABLE about (kind TEXT NOT NULL, name TEXT NOT NULL, text TEXT NOT NULL);
CREATE TABLE plan (row INTEGER PRIMARY KEY, key TEXT NOT NULL, label TEXT NOT NULL);
CREATE TABLE result (
    key TEXT PRIMARY KEY, value TEXT NOT NULL, failed TEXT, finished REAL NOT NULL
) WITHOUT ROWID;
{_RUN}"""


def _second(file: sqlite3.Connection) -> None:
    """Bring a study of the first layout to the second."""
    file.execute("ALTER TABLE plan RENAME COLUMN factors TO label")
    for statement in _TABLES.replace(_RUN, "").split(";"):
        if "TABLE plan" not in statement:
            file.execute(statement)
    file.execute("INSERT INTO about SELECT 'study', name, text FROM study")
    file.executemany(
        "INSERT INTO result VALUES (?, ?, ?, ?)",
        (
            (
                key,
                json.dumps(
                    {
                        "status": status, "message": message, "vaf": vaf, "ipde": ipde,
                        "estimates": [
                            dict(zip(("name", "value", "sem", "true"), estimate, strict=True))
                            for estimate in json.loads(estimates)
                        ],
                        "seconds": seconds,
                    }
                ),
                message if status == "failed" else None,
                finished,
            )
            for key, status, message, vaf, ipde, estimates, seconds, finished in file.execute(
                "SELECT * FROM outcome"
            ).fetchall()
        ),
    )  # fmt: skip
    file.execute("DROP TABLE outcome")
    file.execute("DROP TABLE study")


FORMAT = Format(
    application=0x73726165,  # "srae"
    what="a store of surae",
    tables={1: _FIRST, 2: _TABLES},
    full="{name}: make room on its disk and run the same command again: what is finished is kept",
    damaged="restore it from a copy (`surae study backup` makes one)",
    upgrades={1: _second},
)
