"""The simulated ankle that is perturbed."""

import pytest

from perturbed_ankle import Ankle


@pytest.fixture
def ankle() -> type[Ankle]:
    return Ankle
