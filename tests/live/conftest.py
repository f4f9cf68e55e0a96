"""Streams of the Lab Streaming Layer on this computer: never missing where tests run for all."""

import os
import signal

import pytest

#: What a test of live streams may take at most [s]: nothing hangs where a stream does not come.
LIMIT, SLOW_LIMIT = 300, 900


@pytest.hookimpl(wrapper=True)
def pytest_runtest_protocol(item):
    """Hold a test, with what it is prepared by, to its limit."""
    if not hasattr(signal, "SIGALRM"):
        return (yield)
    limit = SLOW_LIMIT if item.get_closest_marker("slow") else LIMIT

    def over(number, frame):
        raise TimeoutError(f"{item.nodeid} took more than {limit} s")

    before = signal.signal(signal.SIGALRM, over)
    signal.alarm(limit)
    try:
        return (yield)
    finally:
        signal.alarm(0)
        signal.signal(signal.SIGALRM, before)


@pytest.fixture(scope="session")
def lsl():
    """The module pylsl, kept to the loopback."""
    try:
        import pylsl  # noqa: F401
    except (ImportError, RuntimeError) as error:
        if os.environ.get("CI"):
            pytest.fail(f"pylsl does not work here: {error}")
        pytest.skip(f"LIVE STREAMS NOT TESTED, pylsl does not work here: {error} (extra live)")
    from surae_workbench.live.lsl import SESSION
    from surae_workbench.live.lsl import lsl as configured

    # Tests that run beside these ones must not hear them.
    os.environ[SESSION] = f"test-{os.getpid()}"
    return configured()
