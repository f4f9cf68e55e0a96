"""The tables of *Fit my own file* are what is read, and what is refused by name."""

import re
import sys
from pathlib import Path

import pytest

from surae.base.errors import InputError
from surae.recording import inspect
from surae.recording.formats import open_table
from surae.recording.source import open_source
from surae.recording.unread import KNOWN

sys.path.insert(0, str(Path(__file__).parents[1] / "recording"))
from reader_seeds import SEEDS

PAGE = Path(__file__).parents[2] / "docs" / "how-to" / "fit-my-file.md"


def rows(heading: str) -> list[list[str]]:
    """The cells of the table that follows a heading."""
    below = PAGE.read_text(encoding="utf-8").partition(f"{heading}\n")[2]
    lines = re.search(r"(?:^\|.*\n)+", below, re.MULTILINE)
    assert lines is not None
    return [
        [cell.strip() for cell in line.strip("|").split("|")] for line in lines[0].splitlines()[2:]
    ]


@pytest.mark.parametrize("reader", SEEDS)
def test_every_format_that_is_read_stands_in_the_table(tmp_path, reader):
    known = " ".join(row[0] for row in rows("## Formats"))
    path = tmp_path / "file"
    for make in SEEDS[reader]:
        path.write_bytes(make())
        name = open_table(open_source(path), timed=False).format
        assert all(word in known for word in name.removesuffix(" CSV").split()), name


def test_every_format_that_is_refused_stands_in_the_table_with_its_export():
    table = {(what, export): files for what, files, export in rows("### Named, but not read")}
    wanted: dict[tuple[str, str], set[str]] = {}
    for _, _, what, export in KNOWN["begins"]:
        wanted.setdefault((what, export), set())
    for ending, (what, export) in KNOWN["programs"].items():
        wanted.setdefault((what, export), set()).add(f"`{ending}`")
    assert {key: set(files.split()) for key, files in table.items()} == wanted


@pytest.mark.parametrize(("what", "export"), sorted({(w, e) for _, _, w, e in KNOWN["begins"]}))
def test_a_file_that_begins_so_is_named_with_its_export(tmp_path, what, export):
    at, magic = next((at, m) for at, m, w, e in KNOWN["begins"] if (w, e) == (what, export))
    path = tmp_path / "file.bin"
    path.write_bytes(bytes(at) + magic.encode("latin-1") + bytes(64))
    with pytest.raises(InputError) as refused:
        inspect(path)
    assert f"{what}, which is not read here; to export it: {export}" in str(refused.value)
