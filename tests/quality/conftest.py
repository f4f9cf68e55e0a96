"""Virtual recordings with planted faults, as the benchmark makes them."""

import importlib.util
import sys
from pathlib import Path
from types import ModuleType

import pytest

BENCHMARK = Path(__file__).resolve().parents[2] / "benchmarks" / "quality.py"


@pytest.fixture(scope="session")
def planted() -> ModuleType:
    """The benchmark of the quality gate, for its recordings and faults."""
    spec = importlib.util.spec_from_file_location("quality_benchmark", BENCHMARK)
    assert spec is not None
    assert spec.loader is not None
    module = importlib.util.module_from_spec(spec)
    sys.modules["quality_benchmark"] = module
    spec.loader.exec_module(module)
    return module
