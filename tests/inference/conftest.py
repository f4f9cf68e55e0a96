"""A fit that the tests of the assessment share."""

import pytest

from surae.inference import fit_problem, make_problem


@pytest.fixture(scope="session")
def fitted(noisy):
    """Fit of the noisy trial."""
    return fit_problem(make_problem([noisy]), starts=2)
