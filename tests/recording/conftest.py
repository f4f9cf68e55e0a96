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
