"""More seconds never tell less, and a recording that is cut inside tells what it tells whole."""

import sys
from itertools import pairwise
from pathlib import Path

import numpy as np
import pytest

import surae
from surae.signals import windows

sys.path.insert(0, str(Path(__file__).parents[2] / "legs" / "src"))
from ankle_legs.make import make

#: Seconds of a recording that are fitted, the last of them by windows: the limits are a third of
#: what they are. What half-widths may be wider for more seconds, in the mean of two legs: windows
#: lie elsewhere, and which departures the data ask for moves those of single legs by a tenth.
SECONDS = (35.0, 99.0, 600.0)
LIMITS = (100.0, 6, 25.0)
SEEDS = (5003, 5004)
WIDER = 1.05
#: Standard deviations by which a cut inside may move a value, and by how much a half-width.
MOVED = 0.1
CHANGED = 0.1


def intervals(fit: surae.Fit) -> dict[str, tuple[float, float]]:
    """Value and standard deviation by the posterior, before arms that are not the leg's own."""
    variance = sum((by**2).sum(axis=0) for by in fit.result.solution.spread.values())
    names = fit.result.problem.free
    sd = dict(zip(names, np.sqrt(variance), strict=True))
    return {n: (fit.result.values[n], sd[n]) for n in names if n in fit.parameters}


@pytest.fixture(scope="module")
def recordings(tmp_path_factory):
    """Ten minutes of virtual legs."""
    folder = tmp_path_factory.mktemp("long")
    legs = [make("a", s, folder, (1,), kind="active", seconds=SECONDS[-1])[0] for s in SEEDS]
    return [surae.read(path) for path in legs]


def fitted(recording, limits) -> surae.Fit:
    """The fit of a recording that is read by windows beyond these limits."""
    with pytest.MonkeyPatch.context() as patch:
        patch.setattr(windows, "FAMILY", limits)
        return surae.fit(recording, quality=())


@pytest.fixture(scope="module")
def by_length(recordings):
    """Intervals of their first seconds, by how many they are."""
    return [
        {s: intervals(fitted(each.crop(0.0, s), LIMITS)) for s in SECONDS} for each in recordings
    ]


def narrower(by_length, more: float, less: float) -> float:
    """Geometric mean by which intervals are narrower for more seconds."""
    parts = [np.log(leg[more][n][1] / leg[less][n][1]) for leg in by_length for n in leg[less]]
    return float(np.exp(np.mean(parts)))


@pytest.mark.slow
def test_more_seconds_never_tell_less(by_length) -> None:
    for less, more in pairwise(SECONDS):
        assert narrower(by_length, more, less) <= WIDER, (less, more)
    assert narrower(by_length, SECONDS[-1], SECONDS[0]) <= 0.8


@pytest.mark.slow
def test_a_cut_inside_moves_nothing(recordings, by_length) -> None:
    """The same samples, of which the model begins anew before the second half."""
    recording = recordings[0]
    whole = by_length[0][SECONDS[1]]
    fit = fitted(recording.crop(0.0, SECONDS[1]), (50.0, 2, SECONDS[1] / 2.0))
    (inputs,) = fit.result.problem.inputs
    assert inputs.counted == pytest.approx(SECONDS[1] * inputs.rate_hz, rel=0.01)
    assert inputs.counted < inputs.n
    cut = intervals(fit)
    for name, (value, sd) in whole.items():
        assert abs(cut[name][0] - value) <= MOVED * sd, name
        assert abs(cut[name][1] / sd - 1.0) <= CHANGED, name
