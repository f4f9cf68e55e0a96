"""A fit that the tests of the assessment share."""

import pytest

import promises
from surae.inference import fit_problem, make_problem


@pytest.fixture(scope="session")
def fitted(noisy):
    """Fit of the noisy trial."""
    return fit_problem(make_problem([noisy]), starts=2)


@pytest.fixture
def arms_known():
    """Judge as if arms and paths were the leg's own, see `promises`."""
    with promises.arms_known():
        yield
