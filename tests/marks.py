"""Marks of single cases among many; which tests are slow."""

import pytest

#: Tests that were collected, cases of one together, and whether any is slow; see test_slow.py.
COLLECTED = pytest.StashKey[dict[str, bool]]()


def slow(*case: object):
    """A case of a test that only ``make test-all`` runs: one like it runs always."""
    return pytest.param(*case, marks=pytest.mark.slow)
