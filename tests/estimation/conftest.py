"""Virtual trials that the tests of the estimation share."""

import pytest

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
