"""What every test shares: where the reference and measured data are, or why a test is skipped."""

from pathlib import Path

import pytest

SHARED = Path(__file__).resolve().parents[2] / "shared" / "data"


@pytest.fixture(scope="session")
def shared() -> Path:
    """The folder of reference solutions and measured recordings kept beside the repository."""
    if not SHARED.is_dir():
        pytest.skip("no reference data: the folder ../shared/data is not beside the repository")
    return SHARED
