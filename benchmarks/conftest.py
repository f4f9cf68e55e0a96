"""The trial that every benchmark uses, and the ratios printed at the end."""

from collections.abc import Callable

import pytest

from surae.inference import FitProblem, make_problem
from surae.protocol import Protocol, generate
from surae.signals import ModelInputs
from surae.studies import virtual_subject, virtual_trial

_RATIOS: list[str] = []


@pytest.fixture(scope="session")
def trial() -> ModelInputs:
    """A noisy trial of 8,192 samples."""
    protocol = Protocol(
        profile="multiple-holds", chirp_amplitude=0.2, chirp_rate=0.5, rate_hz=8191 / 35.0
    )
    trial = virtual_trial(virtual_subject(seed=1), generate(protocol))
    assert trial.n == 8192
    return trial


@pytest.fixture(scope="session")
def problem(trial: ModelInputs) -> FitProblem:
    """The default problem of model 1.0 on that trial."""
    return make_problem([trial])


@pytest.fixture
def ratio() -> Callable[[str], None]:
    """Print a line after the tables."""
    return _RATIOS.append


def pytest_terminal_summary(terminalreporter: pytest.TerminalReporter) -> None:
    """Print the ratios."""
    if _RATIOS:
        terminalreporter.section("ratios")
        for line in _RATIOS:
            terminalreporter.write_line(line)
