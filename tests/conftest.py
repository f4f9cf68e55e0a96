"""What every test shares: virtual trials; where the data are, or why a test is skipped."""

import gc
import os
import sys
import tempfile
import tomllib
from collections.abc import Iterator
from importlib.metadata import PackageNotFoundError, distribution
from pathlib import Path

import pytest
from hypothesis import HealthCheck, settings

from marks import COLLECTED

# What computes is imported where it is used: who only hands out tests goes without, and no library
# has begun its threads yet. Tests share the cores among them: threads of linear algebra on cores
# that others use wait for one another busily, and one decomposition takes a hundred times as long.
for _library in ("OMP", "OPENBLAS", "MKL"):
    os.environ[f"{_library}_NUM_THREADS"] = "1"

# Plugins of this repository are found, here and by children, where only pytest's path has them too.
_THESIS = Path(__file__).resolve().parents[1] / "thesis"
_paths = [str(_THESIS / "src")]
try:
    distribution("surae-thesis")
except PackageNotFoundError:
    _folder = Path(tempfile.mkdtemp()) / "surae_thesis-0.dist-info"
    _folder.mkdir()
    _groups = tomllib.loads((_THESIS / "pyproject.toml").read_text())["project"]["entry-points"]
    _points = "\n".join(
        "\n".join((f"[{group}]", *(f"{name} = {at}" for name, at in points.items())))
        for group, points in _groups.items()
    )
    (_folder / "METADATA").write_text("Name: surae-thesis\nVersion: 0\n")
    (_folder / "entry_points.txt").write_text(_points)
    sys.path.append(str(_folder.parent))
    _paths.append(str(_folder.parent))
os.environ["PYTHONPATH"] = os.pathsep.join([*_paths, *filter(None, [os.environ.get("PYTHONPATH")])])

# Nothing that is imported and collected is garbage: to look for some takes a sixth of it.
gc.disable()

# What fails once fails again, and a busy computer fails nothing.
settings.register_profile(
    "repeatable",
    derandomize=True,
    deadline=None,
    suppress_health_check=[HealthCheck.too_slow, HealthCheck.function_scoped_fixture],
)
settings.load_profile("repeatable")


#: What begins: what shares most, then what shares least, which a worker that is through takes over.
FIRST = ("/e2e/", "/web/", "/live/", "/recording/", "/signals/", "/model/")


#: Tests that take longer than most, a name a line: CI and ``make test-all`` run them. Renew it by
#: ``pytest --durations=0`` with what takes over half a second alone.
LONG = Path(__file__).with_name("long.txt")


@pytest.hookimpl(tryfirst=True)
def pytest_collection_modifyitems(config: pytest.Config, items: list[pytest.Item]) -> None:
    """Tests of the workbench come first: one worker has them, others work while they wait.

    Else their servers, windows, child processes and projects would be made twice or thrice.
    """
    long = set(LONG.read_text(encoding="utf-8").split())
    config.stash[COLLECTED] = collected = {}
    for item in items:
        name = item.nodeid.partition("[")[0]
        is_slow = item.get_closest_marker("slow") is not None
        collected[name] = is_slow or collected.get(name, False)
        if long & {item.nodeid, name}:
            item.add_marker("long")

    def place(item: pytest.Item) -> int:
        return next((i for i, part in enumerate(FIRST) if part in item.nodeid), len(FIRST))

    items.sort(key=place)


def pytest_collection_finish() -> None:
    """Let the collector of garbage leave alone what is there to the end: modules, tests, kernels.

    To look through all of it again and again takes a tenth of what all tests take.
    """
    gc.collect()
    gc.freeze()
    gc.set_threshold(20_000, 10, 10)
    gc.enable()


SHARED = Path(__file__).resolve().parents[2] / "shared" / "data"


@pytest.fixture(scope="session", autouse=True)
def taken_locks() -> Iterator[None]:
    """That a lock is taken is known sooner than where many look at it."""
    with pytest.MonkeyPatch.context() as patched:
        patched.setattr("surae.base.database._LOOKED_AT", 0.2)
        yield


@pytest.fixture(scope="session")
def references() -> Path:
    """The folder of reference solutions, made for the models by other means; see its README."""
    return Path(__file__).parent / "data" / "reference"


@pytest.fixture(scope="session")
def shared() -> Path:
    """The folder of measured recordings kept beside the repository."""
    if not SHARED.is_dir():
        pytest.skip("no reference data: the folder ../shared/data is not beside the repository")
    return SHARED


@pytest.fixture(scope="session")
def trajectory():
    from surae.protocol import Protocol, generate

    return generate(
        Protocol(profile="multiple-holds", chirp_amplitude=0.2, chirp_rate=0.5, rate_hz=125.0)
    )


@pytest.fixture(scope="session")
def subject():
    from surae.studies import virtual_subject

    return virtual_subject(1)


@pytest.fixture(scope="session")
def clean(subject, trajectory):
    """A trial without noise."""
    from surae.studies import virtual_trial

    return virtual_trial(subject, trajectory, noise=0.0)


@pytest.fixture(scope="session")
def noisy(subject, trajectory):
    """A trial with the thesis's noise."""
    from surae.studies import virtual_trial

    return virtual_trial(subject, trajectory, noise=0.05)


@pytest.fixture
def undrawn() -> Iterator[None]:
    """Reports of this test have no figures: their words are what is tested."""
    from undrawn import blank_figures

    with blank_figures():
        yield


@pytest.fixture(scope="module")
def few() -> Iterator[None]:
    """Measures of this module have intervals of few possible legs: others are its claims."""
    from undrawn import few_legs

    with few_legs():
        yield


@pytest.fixture(scope="session")
def trial_csv(tmp_path_factory) -> Path:
    """A CSV of a virtual subject: 40 s at 32 Hz, envelopes, with our column names."""
    import numpy as np

    from surae.protocol import Protocol, generate
    from surae.recording import write_csv
    from surae.studies import virtual_subject, virtual_trial

    motion = generate(
        Protocol(profile="multi-sine-holds", chirp_amplitude=0.2, chirp_rate=0.1, rate_hz=32.0)
    )
    made = virtual_trial(virtual_subject(3), motion, noise=0.0)
    assert made.torque is not None
    noise = 0.3 * np.random.default_rng(1).standard_normal(made.n)
    table = {"time_s": made.time, "angle_rad": made.angle, "torque_Nm": made.torque + noise}
    table |= {f"emg_{m}_V": made.emg[:, i] for i, m in enumerate(("ta", "gl", "sol", "gm"))}
    path = tmp_path_factory.mktemp("trial") / "trial.csv"
    write_csv(path, table, ["emg: envelope"])
    return path
