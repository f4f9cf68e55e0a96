"""Holds of a leg of another generator, cut out of one recording: followed, and claimed truly."""

import numpy as np
import pytest

import surae
from promises import keeps_the_promise
from surae.recording import MUSCLES, Recording

#: Speed [rad/s] above which the leg is on its way, and what is left out at both ends of a hold [s].
MOVES, EDGE = 0.02, 0.2


def holds(path) -> list[Recording]:
    """The parts of a recording in which the angle rests, muscles active or not."""
    whole = surae.read(path)
    channels = whole.channels
    time, angle = channels["angle"].time, channels["angle"].values
    emg = np.stack([channels[f"emg_{muscle}"].values for muscle in MUSCLES], axis=1)
    moving = np.flatnonzero(np.abs(np.gradient(angle, time)) > MOVES)
    gaps = np.flatnonzero(np.diff(time[moving]) > 2.0)
    ends = [*((time[moving[g]], time[moving[g + 1]]) for g in gaps), (time[moving[-1]], time[-1])]
    made = []
    for number, (first, last) in enumerate(ends):
        at = (time > first + EDGE) & (time < last - EDGE)
        made.append(
            Recording.from_arrays(
                time[at],
                angle[at],
                channels["torque"].values[at],
                emg[at],
                name=f"hold {number}",
                emg_kind="envelope",
            )
        )
    return made


@pytest.mark.slow
@pytest.mark.parametrize("family", ["a", "d"])
def test_holds_cut_in_mid_effort_are_followed_and_claims_are_true(tmp_path, family) -> None:
    make = pytest.importorskip("ankle_legs.make")
    (path,) = make.make(family, 967, tmp_path, kind="isometric", seconds=64.0)
    cut = holds(path)
    assert len(cut) == 8
    fit = surae.fit(cut, quality=())
    assert str(fit.adequacy.grade) == "adequate"
    truth = make.truth_of(family, 967, 1, ("isometric",), 64.0)["parameters"]
    told = {n: p for n, p in fit.parameters.items() if p.free and p.ci95 and truth.get(n)}
    missed = [n for n, p in told.items() if not p.ci95[0] <= truth[n] <= p.ci95[1]]
    assert not [n for n in missed if told[n].verdict == "identified"]
    assert len(told) >= 13
    assert keeps_the_promise(len(told) - len(missed), len(told), 0.95)  # 3 of 17 once in twenty
