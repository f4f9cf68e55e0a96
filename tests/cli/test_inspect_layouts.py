"""What `surae inspect`, `check` and `fit` say of layouts, contractions and clocks."""

import sys
from dataclasses import replace
from pathlib import Path

import numpy as np
import pytest

import surae
from surae.base.frozen import read_only
from surae.recording import csv_columns, write_csv

sys.path.insert(0, str(Path(__file__).parents[1] / "recording"))
import layouts as made


@pytest.fixture(scope="module")
def leg():
    """A virtual leg's trial of 35 s with raw EMG."""
    return surae.example()


def codes(recording):
    return {finding.code: finding for finding in surae.check(recording).findings}


def test_what_maps_nothing_ends_with_2(run, tmp_path):
    (tmp_path / "x.csv").write_text("time_s,depth\n" + "".join(f"{i},{i % 7}\n" for i in range(99)))
    ended = run("inspect", tmp_path / "x.csv", "--output", tmp_path / "m.toml")
    assert ended.code == 2
    assert "none of its columns is known" in ended.out + ended.err
    assert not (tmp_path / "m.toml").exists()


def test_trials_in_a_file_are_inspected_checked_and_fitted_each(run, tmp_path):
    (tmp_path / "t.csv").write_text(made.trials())
    assert "3 trials in one file" in run("inspect", tmp_path / "t.csv").out
    ended = run("check", tmp_path / "t.csv")
    assert ended.code == 2
    assert (
        "never joined" in ended.out + ended.err or "3 trials in one file" in ended.out + ended.err
    )
    assert "sort the rows" not in ended.out + ended.err
    assert run("inspect", tmp_path / "t.csv", "--output", tmp_path / "m.toml").code == 0
    checked = run("check", tmp_path / "m.toml")
    assert checked.code == 0
    assert all(f"t-{k}" in checked.out for k in (1, 2, 3))
    session = surae.session([tmp_path / "m.toml"])
    assert [trial.name for trial in session.trials] == ["m-1", "m-2", "m-3"]
    given = surae.session([tmp_path / "t.csv"], mapping=tmp_path / "m.toml")
    assert [trial.name for trial in given.trials] == ["t-1", "t-2", "t-3"]


def test_channels_apart_in_time_are_said_as_a_fit_says_it(run, tmp_path):
    (tmp_path / "robot.csv").write_text(made.timed(names=made.OURS[:2], data=made.DATA[:, :2]))
    later = made.TIME + 1.548e9
    (tmp_path / "emg.csv").write_text(
        made.text(("time_s", *made.OURS[2:]), (later, made.EMG), form="{:.15g}")
    )
    both = (tmp_path / "robot.csv", tmp_path / "emg.csv")
    ended = run("inspect", *both, "--output", tmp_path / "m.toml")
    assert "share no span of time" in ended.out + ended.err
    found = codes(surae.read(tmp_path / "m.toml"))
    assert found["no-shared-span"].severity == "error"
    assert "trial-too-short" not in found
    with pytest.raises(surae.InputError, match="share no span of time"):
        surae.prepare(surae.read(tmp_path / "m.toml"))


@pytest.mark.parametrize("times", [1e-3, 1e-6])
def test_volts_under_a_smaller_name_are_said(leg, times):
    small = {
        role: replace(c, values=read_only(c.values * times)) if role.startswith("emg_") else c
        for role, c in leg.channels.items()
    }
    found = codes(replace(leg, channels=small))
    assert found["emg-unit"].severity == "warning"  # weights take any unit of all EMG alike
    assert "V named" in found["emg-unit"].message
    assert "active-not-active" not in found


def test_quiet_emg_is_not_called_another_unit(leg):
    rng = np.random.default_rng(5)
    quiet = {
        role: replace(c, values=read_only(1e-6 * rng.normal(size=len(c.values))))
        if role.startswith("emg_")
        else c
        for role, c in leg.channels.items()
    }
    assert "emg-unit" not in codes(replace(leg, channels=quiet))
    assert "emg-unit" not in codes(leg)


def contraction(path, leg, factor, *, alone):
    """EMG of a maximum: the trial's, times a factor."""
    channels = {
        role: replace(c, values=read_only(c.values * factor)) if role.startswith("emg_") else c
        for role, c in leg.channels.items()
        if role.startswith("emg_") or not alone
    }
    if alone:
        names = [f"{role}_V" for role in channels]
        first = next(iter(channels.values()))
        data = np.column_stack([c.values for c in channels.values()])
        path.write_text(
            made.text(("time_s", *names), (first.time, data), form="{:.9g}"), encoding="utf-8"
        )
    else:
        write_csv(path, csv_columns(replace(leg, channels=channels)), ["emg: raw"])
    return path


@pytest.mark.slow
@pytest.mark.parametrize(("factor", "above"), [(0.2, True), (1.5, False)])
@pytest.mark.parametrize("alone", [True, False])
def test_a_maximum_needs_emg_alone_and_less_than_the_trial_is_said(
    tmp_path, leg, factor, above, alone
):
    mvc = contraction(tmp_path / "mvc.csv", leg, factor, alone=alone)
    fit = surae.fit(leg, model="muscle", normalise="mvc", mvc=mvc, starts=1)
    found = [f for quality in fit.quality for f in quality.findings if f.code == "emg-above-mvc"]
    assert bool(found) == above
    if above:
        assert all("% of its maximum" in f.message for f in found)
        assert found[0].value == pytest.approx(1 / factor, rel=0.1)


def with_fast_clock(recording, ppm, late=0.0):
    """The recording whose EMG has stamps of a clock that is so fast, and begins late."""
    channels = {
        role: replace(c, time=read_only(c.time * (1 + 1e-6 * ppm) + late))
        if role.startswith("emg_")
        else c
        for role, c in recording.channels.items()
    }
    return replace(recording, channels=channels)


@pytest.mark.parametrize("ppm", [3000.0, -3000.0])
def test_a_clock_that_drifts_is_found_and_its_correction_is_right(leg, ppm):
    found = codes(with_fast_clock(leg, ppm))
    assert found["emg-clock"].severity == "error"
    assert 1e6 * found["emg-clock"].value == pytest.approx(ppm, abs=1000.0)
    assert "clock_ppm = " in found["emg-clock"].advice
    assert "emg-torque-lag" not in found


@pytest.mark.parametrize("late", [0.0, 0.2, -0.1])
def test_a_lag_that_does_not_grow_is_no_drift(leg, late):
    assert "emg-clock" not in codes(with_fast_clock(leg, 0.0, late))


@pytest.mark.parametrize(("ppm", "drifts"), [(0.0, False), (3000.0, True), (-3000.0, True)])
def test_a_measured_walk_has_no_drift_unless_it_is_put_in(ppm, drifts, shared):
    recording = surae.read(shared / "gait" / "walk36.toml")
    found = codes(with_fast_clock(recording, ppm))
    assert ("emg-clock" in found) == drifts
    if drifts:
        assert 1e6 * found["emg-clock"].value == pytest.approx(ppm, abs=800.0)
