"""Fits whose torque is predicted while it is measured, and a compiler."""

import os
import shutil

import pytest

from surae import fit
from surae.protocol import Protocol, generate
from surae.studies import virtual_trial


@pytest.fixture(scope="session")
def slower():
    """A movement that a causal filter can follow at 250 Hz: up to 3 Hz."""
    return generate(
        Protocol(profile="multiple-holds", chirp_amplitude=0.2, chirp_rate=0.08, rate_hz=250.0)
    )


@pytest.fixture(scope="session")
def fitted(subject, slower):
    """A fit of the muscle model to envelopes."""
    return fit(virtual_trial(subject, slower, seed=1), "muscle", starts=1)


@pytest.fixture(scope="session")
def family(subject, slower):
    """A fit of the family to the same trial."""
    return fit(virtual_trial(subject, slower, seed=1), "auto")


@pytest.fixture(scope="session")
def gcc():
    """The compiler; in CI it has to be there."""
    path = shutil.which("gcc")
    if path is None:
        if os.environ.get("CI"):
            pytest.fail("gcc is missing; .ci/compiler installs it")
        pytest.skip("THE PREDICTOR IN C IS NOT TESTED: no gcc here")
    return path
