"""A fit that the tests of the assessment share."""

import pytest

from surae.inference import fit_problem, make_problem


@pytest.fixture(scope="session")
def fitted(noisy):
    """Fit of the noisy trial."""
    return fit_problem(make_problem([noisy]), starts=2)


@pytest.fixture
def arms_known(monkeypatch):
    """Judge as if arms and paths were the leg's own; what they add: test_arms_and_paths.py.

    Else nothing that rests on them is identified, and what a test asks of noise, EMG or another
    tissue would hold whatever the code does.
    """
    monkeypatch.setattr("surae.inference.uncertainty.combined.arms_and_paths", lambda *_: None)
