"""Streams of the Lab Streaming Layer on this computer: never missing where tests run for all."""

import os

import pytest


@pytest.fixture(scope="session")
def lsl():
    """The module pylsl, kept to the loopback."""
    try:
        import pylsl  # noqa: F401
    except (ImportError, RuntimeError) as error:
        if os.environ.get("CI"):
            pytest.fail(f"pylsl does not work here: {error}")
        pytest.skip(f"LIVE STREAMS NOT TESTED, pylsl does not work here: {error} (extra live)")
    from surae.live.lsl import SESSION
    from surae.live.lsl import lsl as configured

    # Tests that run beside these ones must not hear them.
    os.environ[SESSION] = f"test-{os.getpid()}"
    return configured()
