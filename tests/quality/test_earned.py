"""That nothing speaks against a fit is said only where no check of its recordings does.

Of virtual legs of another generator, with faults put into their files.
"""

from dataclasses import replace

import numpy as np
import pytest

import surae
import surae.api
from surae.base.frozen import read_only
from surae.recording import Recording
from undrawn import blank_figures

pytestmark = pytest.mark.usefixtures("few")
EARNED = "nothing that was looked at speaks against"


@pytest.fixture(scope="module")
def active() -> Recording:
    """Twenty seconds of effort of a virtual leg."""
    return trial("active")


def trial(kind: str) -> Recording:
    make = pytest.importorskip("ankle_legs.make")
    one = make.leg("a", 93)
    columns = one.columns(one.record(1, 20.0, kind), 1)
    emg = np.column_stack([v for name, v in columns.items() if name[:4] == "emg_"])
    signals = (columns[name] for name in ("time_s", "angle_rad", "torque_Nm"))
    return replace(Recording.from_arrays(*signals, emg, emg_kind="envelope"), name=kind)


def changed(recording: Recording, role: str, values: np.ndarray) -> Recording:
    channel = replace(recording.channels[role], values=read_only(values))
    return replace(recording, channels={**recording.channels, role: channel})


def limited(recording: Recording) -> Recording:
    """The torque's sensor ends at two thirds of what the leg does."""
    torque = recording.channels["torque"].values
    return changed(recording, "torque", np.minimum(torque, 0.65 * torque.max()))


def test_a_sound_recording_earns_it(active) -> None:
    fit = surae.fit(active)
    assert not [f for q in fit.quality for f in q.findings if f.severity != "info"]
    assert fit.adequacy.grade == "adequate"
    assert EARNED in fit.summary()


def test_an_error_that_stands_takes_it(active, tmp_path) -> None:
    fit = surae.fit(limited(active))
    errors = [f for q in fit.quality for f in q.findings if f.severity == "error"]
    assert [f.code for f in errors] == ["torque-limit"]
    assert fit.adequacy.grade != "adequate"
    assert str(errors[0].message) in " ".join(fit.adequacy.reasons)
    assert EARNED not in fit.summary()
    with blank_figures():
        fit.report(tmp_path / "fit.html")
    assert EARNED not in (tmp_path / "fit.html").read_text(encoding="utf-8")
    fit.save(tmp_path / "fit.json")
    assert surae.load(tmp_path / "fit.json").adequacy == fit.adequacy


def test_a_warning_is_named_in_its_place(active) -> None:
    emg = active.channels["emg_sol"].values.copy()
    emg[100] += 20.0 * emg.max()
    fit = surae.fit(changed(active, "emg_sol", emg))
    warned = {f.code for q in fit.quality for f in q.findings if f.severity == "warning"}
    assert warned
    assert fit.adequacy.grade == "adequate"
    assert EARNED not in fit.summary()
    assert all(code in fit.summary() for code in warned)


def test_rest_is_doubted_by_errors_of_its_torque_through_every_door() -> None:
    passive = trial("passive")
    assert not any("error" in each for each in surae.relaxed(passive).findings)
    wrong = limited(passive)
    told = surae.relaxed(wrong)
    assert told.curve.grade == "doubtful"
    assert "error" in told.findings[0]
    by_fit = surae.fit(wrong).measures()
    of_rest = [m for m in by_fit.values() if m.basis == "rest"]
    assert of_rest
    assert not [m.name for m in of_rest if m.verdict == "identified"]
    assert by_fit["torque_rise"].verdict == told.measures["torque_rise"].verdict


@pytest.mark.parametrize(("family", "number"), [("d", 0), ("d", 3), ("e", 1), ("f", 1), ("i", 1)])
def test_a_second_of_a_trial_is_stopped_for_nothing_that_it_cannot_tell(family, number) -> None:
    """Pieces as long as a stride, which were once called raw, doubled or per kilogram."""
    make = pytest.importorskip("ankle_legs.make")
    columns = make.leg(family, 6601).columns(make.leg(family, 6601).record(1, 20.0, "active"), 1)
    emg = np.column_stack([v for name, v in columns.items() if name[:4] == "emg_"])
    signals = (columns[name] for name in ("time_s", "angle_rad", "torque_Nm"))
    whole = replace(Recording.from_arrays(*signals, emg, emg_kind="envelope"), name="whole")
    piece = whole.crop(3.0 + 3.0 * number, 4.1 + 3.0 * number)
    _, quality = surae.api.check_together([whole, replace(piece, name="piece")])
    errors = {f.code for f in quality.findings if f.severity == "error"}
    assert errors <= {"angle-still"}
