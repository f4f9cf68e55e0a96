"""Marks of single cases among many."""

import pytest


def slow(*case: object):
    """A case of a test that only ``make test-all`` runs: one like it runs always."""
    return pytest.param(*case, marks=pytest.mark.slow)
