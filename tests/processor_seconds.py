"""A plugin of pytest: what each test took of the processor, its children's part too.

Seconds on the wall say little where others compute beside; see tests/slow.toml.
"""

import os
from collections import defaultdict

import pytest

SECONDS: dict[str, float] = defaultdict(float)
BEGAN = pytest.StashKey[float]()


def spent() -> float:
    """Seconds that this process and its ended children computed."""
    t = os.times()
    return t.user + t.system + t.children_user + t.children_system


@pytest.hookimpl(wrapper=True)
def pytest_runtest_protocol(item):
    item.stash[BEGAN] = spent()
    return (yield)


@pytest.hookimpl(wrapper=True)
def pytest_runtest_makereport(item, call):
    report = yield
    if call.when == "teardown":
        report.user_properties.append(("processor_seconds", spent() - item.stash[BEGAN]))
    return report


def pytest_runtest_logreport(report):
    name = report.nodeid.partition("[")[0]
    SECONDS[name] += dict(report.user_properties).get("processor_seconds", 0.0)


def pytest_terminal_summary(terminalreporter):
    if SECONDS:
        terminalreporter.section("seconds of a processor, all cases of a test together")
        for name, seconds in sorted(SECONDS.items()):
            terminalreporter.write_line(f'"{name}" = {seconds:.1f}')
