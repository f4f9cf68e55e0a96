"""Virtual recordings with planted faults, as the benchmark makes them."""

from types import ModuleType

import pytest

from benchmark_files import load


@pytest.fixture(scope="session")
def planted() -> ModuleType:
    """The benchmark of the quality gate, for its recordings and faults."""
    return load("quality")
