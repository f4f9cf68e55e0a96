"""A perturbed recording is known, and its command named."""

from dataclasses import replace

import numpy as np
import pytest

import surae
from perturbed_ankle import Ankle, ramps
from surae.api.fitting import inputs_for
from surae.base.errors import InputError
from surae.quality import finding
from surae.quality.position import is_perturbed, perturbing
from surae.quality.used import used
from surae.recording import Channel, Recording
from surae.settings import FitSettings
from surae.signals import Weighting


def test_a_perturbed_recording_names_the_command() -> None:
    found = {f.code: f for f in surae.check(Ankle().recording()).findings}
    assert "surae impedance" in found["rom-not-covered"].advice


def test_a_fit_of_a_perturbed_recording_is_refused_in_a_line() -> None:
    with pytest.raises(InputError, match="use surae impedance"):
        surae.fit(Ankle().recording())


def test_slow_and_fast_stretches_name_the_command_and_ramps_of_one_speed_do_not() -> None:
    for speeds, named in (((10.0, 10.0, 120.0, 120.0), True), ((30.0, 30.0, 30.0, 30.0), False)):
        found = {f.code: f for f in surae.check(ramps(speeds)).findings}
        assert ("stretch-series" in found) is named
    assert "surae stretches" in finding.KINDS["stretch-series"].advice


def test_only_what_is_used_makes_a_recording_a_perturbed_one() -> None:
    """Junk after the torque's end would make degrees of radians, and these a small movement."""
    t = np.arange(0.0, 35.0, 0.01)
    junk = np.where(t < 32.0, 0.0, -6.3 + 0.1 * np.random.default_rng(4).standard_normal(len(t)))
    angle = Channel("angle", t, 0.6 * np.sin(t) + 0.2 * np.sin(40.0 * t) + junk, "rad", "t: angle")
    torque = Channel("torque", t[:3000], 5.0 * np.sin(t[:3000]), "Nm", "t: torque")
    recording = Recording("t", {"angle": angle, "torque": torque})
    assert is_perturbed(recording)
    assert not is_perturbed(used(recording)[0])
    settings = FitSettings(model="muscle", fixed=dict.fromkeys(("g1", "g2", "g3", "g4"), 0.0))
    assert len(inputs_for(settings, [recording])) == 1
    out = replace(settings, weights=Weighting(windows=((31.0, 40.0, 0.0),)))
    long = replace(torque, time=t, values=5.0 * np.sin(t))
    with pytest.raises(InputError, match="use surae impedance"):
        inputs_for(settings, [Recording("t", {"angle": angle, "torque": long})])
    assert len(inputs_for(out, [Recording("t", {"angle": angle, "torque": long})])) == 1


@pytest.mark.parametrize("hz", [0.3, 2.0])
def test_a_slow_movement_a_still_foot_and_noise_are_none(hz) -> None:
    t = np.arange(0.0, 40.0, 0.01)
    assert not perturbing(0.05 * np.sin(2.0 * np.pi * hz * t), 100.0)
    assert not perturbing(1e-4 * np.sin(2.0 * np.pi * 8.0 * t), 100.0)
    assert not perturbing(0.02 * np.random.default_rng(1).standard_normal(len(t)), 100.0)


def test_a_hold_that_begins_by_settling_is_none() -> None:
    """Put in its place, a foot moves fast and little, and then no more."""
    t = np.arange(0.0, 30.0, 0.01)
    trembles = 1e-4 * np.random.default_rng(2).standard_normal(len(t))
    for degrees in (0.9, 6.0):
        settles = np.radians(degrees) * np.exp(-t / 0.08)
        assert not perturbing(settles + trembles, 100.0)


@pytest.mark.parametrize("kind", ["active", "isometric", "passive"])
def test_legs_of_another_generator_are_neither_perturbed_nor_stretched(kind, tmp_path) -> None:
    make = pytest.importorskip("ankle_legs.make")
    for path in make.make("f", 962, tmp_path, kind=kind):
        recording = surae.read(path)
        assert not is_perturbed(recording)
        assert "stretch-series" not in {f.code for f in surae.check(recording).findings}


@pytest.mark.parametrize("name", ["gait/walk36.toml", "dynamometer/PL_50_01.toml"])
def test_measured_trials_are_neither(shared, name) -> None:
    recording = surae.read(shared / name)
    assert not is_perturbed(recording)
    assert "stretch-series" not in {f.code for f in surae.check(recording).findings}
