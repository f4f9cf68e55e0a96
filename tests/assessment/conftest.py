"""Virtual trials that the tests of the assessment share."""

import pytest

from surae.estimation import fit_problem, make_problem
from surae.protocol import Protocol, generate
from surae.studies import virtual_subject, virtual_trial


@pytest.fixture(scope="session")
def trajectory():
    return generate(
        Protocol(profile="multiple-holds", chirp_amplitude=0.2, chirp_rate=0.5, rate_hz=125.0)
    )


@pytest.fixture(scope="session")
def subject():
    return virtual_subject(1)


@pytest.fixture(scope="session")
def clean(subject, trajectory):
    """A trial without noise."""
    return virtual_trial(subject, trajectory, noise=0.0)


@pytest.fixture(scope="session")
def noisy(subject, trajectory):
    """A trial with the thesis's noise."""
    return virtual_trial(subject, trajectory, noise=0.05)


@pytest.fixture(scope="session")
def fitted(noisy):
    """Fit of the noisy trial."""
    return fit_problem(make_problem([noisy]), starts=2)
