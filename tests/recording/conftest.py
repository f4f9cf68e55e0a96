"""What tests of readers share."""

import pytest

from surae.recording.formats import open_table
from surae.recording.source import open_source


@pytest.fixture
def table(tmp_path):
    """Opens the table in some bytes."""

    def opened(data):
        path = tmp_path / "data"
        path.write_bytes(data)
        return open_table(open_source(path))

    return opened


@pytest.fixture
def file(tmp_path):
    """Writes a file, as bytes or as text of a code page."""

    def write(content, name="trial.csv", encoding="utf-8"):
        path = tmp_path / name
        path.parent.mkdir(parents=True, exist_ok=True)
        path.write_bytes(content if isinstance(content, bytes) else content.encode(encoding))
        return path

    return write
