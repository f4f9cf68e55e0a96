"""What a recording might be is named by what fits it best; what is right is left alone."""

from dataclasses import replace

import numpy as np
import pytest

import surae
from marks import slow
from surae.base.frozen import read_only
from surae.inference.diagnosis import quick
from surae.inference.diagnosis.quick import quick_fit
from surae.inference.least_squares.separable import scan_lengths
from surae.protocol import Protocol, generate
from surae.quality import recording_of
from surae.quality.trial import signals_of
from surae.recording import Recording
from surae.signals import Weighting
from surae.studies import virtual_subject, virtual_trial

CLAIMS = {"angle-sign", "torque-sign", "angle-units", "torque-unit", "electrodes-swapped"}
DEGREES = "trial.csv: angle_deg [deg]"


@pytest.fixture(scope="module")
def legs(tmp_path_factory) -> list[Recording]:
    """Legs of another generator than ours, of families that depart from every model here."""
    make = pytest.importorskip("ankle_legs.make")
    folder = tmp_path_factory.mktemp("legs")
    paths = [make.make(family, 7, folder)[0] for family in "afhk"]
    return [surae.read(path) for path in paths]


@pytest.fixture(scope="module")
def recording() -> Recording:
    motion = generate(Protocol(profile="multiple-holds", chirp_amplitude=0.2, rate_hz=125.0))
    return recording_of(virtual_trial(virtual_subject(1), motion, noise=0.05))


def changed(recording: Recording, role: str, change, source: str | None = None) -> Recording:
    channel = recording.channels[role]
    values, source = read_only(change(channel.values)), source or channel.source
    channel = replace(channel, values=values, source=source)
    return replace(recording, channels={**recording.channels, role: channel})


def swapped(recording: Recording, other: str) -> Recording:
    ta, second = (recording.channels[f"emg_{muscle}"] for muscle in ("ta", other))
    exchanged = {
        "emg_ta": replace(second, role="emg_ta"),
        f"emg_{other}": replace(ta, role=f"emg_{other}"),
    }
    return replace(recording, channels={**recording.channels, **exchanged})


def claims(recording: Recording) -> dict[str, surae.quality.Finding]:
    return {f.code: f for f in surae.check(recording).findings if f.code in CLAIMS}


FAULTS = {
    "zero at 90°": (
        lambda r: changed(r, "angle", lambda v: v + np.pi / 2, DEGREES),
        "angle-units",
        "--offset angle=-90.",
        "offset = -90 for the angle",
    ),
    "zero at 90°, turned": (
        lambda r: changed(r, "angle", lambda v: np.pi / 2 - v, DEGREES),
        "angle-units",
        "--offset angle=-90 --sign angle=-1.",
        "offset = -90 and sign = -1",
    ),
    "turned, in radians": (
        lambda r: changed(r, "angle", lambda v: np.pi / 2 - v),
        "angle-units",
        "--offset angle=-1.5708 --sign angle=-1.",
        "offset = -1.5708",
    ),
    "wrapped": (
        lambda r: changed(r, "angle", lambda v: np.mod(v, 2 * np.pi), DEGREES),
        "angle-units",
        "--wrap angle=360",
        "wrap = 360",
    ),
    "swapped": (
        lambda r: swapped(r, "sol"),
        "electrodes-swapped",
        "--swap ta:sol.",
        'swap = ["ta", "sol"]',
    ),
    "per kilogram": (
        lambda r: changed(r, "torque", lambda v: v / 50),
        "torque-unit",
        "--scale torque=70.",
        "scale = 70 for the torque",
    ),
}


@pytest.mark.parametrize("name", FAULTS)
@pytest.mark.parametrize("leg", [None, slow(0), slow(3)])
def test_the_best_explanation_is_named_with_lines_that_work(legs, recording, name, leg) -> None:
    plant, code, option, line = FAULTS[name]
    told = claims(plant(recording if leg is None else legs[leg]))
    assert set(told) == {code}
    assert option in told[code].advice
    assert line in told[code].advice


def test_right_recordings_are_not_claimed_to_be_anything_else(legs, recording) -> None:
    for right in (recording, *legs):
        assert claims(right) == {}


def test_what_is_said_of_the_angle_has_the_runner_up_beside_it(legs) -> None:
    turned = changed(legs[0], "angle", np.negative)
    message = claims(turned)["angle-sign"].message
    assert "the next best, that" in message
    assert message.count("%") == 3


@pytest.mark.parametrize("name", ["gait/walk36.toml", "dynamometer/PL_50_01.toml"])
def test_measured_recordings_are_left_alone(shared, name) -> None:
    assert claims(surae.read(shared / name)) == {}


def test_a_joint_moment_per_kilogram_is_asked_about(shared) -> None:
    """Without gravity no fit tells the unit: it is a question, and nothing is put right."""
    gait = changed(surae.read(shared / "gait" / "walk36.toml"), "torque", lambda v: v / 70)
    (finding,) = claims(gait).values()
    assert (finding.code, finding.severity) == ("torque-unit", "warning")
    assert "cannot tell" in finding.message
    assert "per kilogram" in finding.message


@pytest.mark.slow
def test_only_what_is_used_is_judged(recording) -> None:
    """Faults after the end of the other channels, and in windows that are left out."""

    def junk(v):
        return np.concatenate([v[:-400], v[-400:] - 2 * np.pi])

    angle = changed(recording, "angle", junk).channels["angle"]
    shorter = {
        role: replace(c, time=read_only(c.time[:-500]), values=read_only(c.values[:-500]))
        for role, c in recording.channels.items()
    }
    told = surae.check(replace(recording, channels={**shorter, "angle": angle}))
    assert "angle-units" not in {f.code for f in told.findings}
    (beside,) = (f for f in told.findings if f.code == "not-used")
    assert (beside.severity, beside.channel) == ("info", "angle")
    assert beside.end_s == pytest.approx(shorter["torque"].time[-1])

    def within(v):
        return np.where((np.arange(v.size) > 1000) & (np.arange(v.size) < 1100), 6.0, v)

    faulty = changed(recording, "angle", within)
    time = recording.channels["angle"].time
    window = (float(time[1000]), float(time[1100]), 0.0)
    assert "angle-units" in {f.code for f in surae.check(faulty).findings}
    assert "angle-units" not in {f.code for f in surae.check(faulty, exclude=[window]).findings}
    settings = surae.api.FitSettings.of("muscle", weights=Weighting((window,)))
    (checked,) = surae.api.checks_for(settings, [faulty])
    found = {f.code for f in checked.findings}
    assert not {"angle-units", "position-steps"} & found


def test_a_torque_that_drifts_is_found(legs) -> None:
    for leg in legs:
        drifting = changed(leg, "torque", lambda v: v + np.linspace(0.0, 8.0, v.size))
        found = {f.code: f for f in surae.check(drifting).findings}
        assert found["torque-drift"].value == pytest.approx(8.0, abs=2.0)


def test_emg_whose_gain_falls_is_found_where_nothing_else_is_left(recording) -> None:
    fading = recording
    for muscle in ("ta", "gl", "sol", "gm"):
        fading = changed(fading, f"emg_{muscle}", lambda v: v * np.linspace(1.0, 0.65, v.size))
    found = {f.code: f for f in surae.check(fading).findings}
    assert found["emg-gain"].value == pytest.approx(0.65, abs=0.08)


def shifted(recording: Recording, seconds: float) -> Recording:
    """With all EMG late by some time."""
    for role in (r for r in recording.channels if r.startswith("emg_")):
        samples = round(seconds * recording.channels[role].rate_hz)
        recording = changed(recording, role, lambda v, samples=samples: np.roll(v, samples))
    return recording


def test_emg_is_out_of_step_where_no_muscle_follows_it_so(legs, monkeypatch) -> None:
    """These torques follow their EMG late by 40 ms, and by what tendons take."""
    scans = []
    monkeypatch.setattr(quick, "scan_lengths", lambda *of: scans.append(of) or scan_lengths(*of))
    for leg, lag in zip(legs, (None, 0.2, -0.2, None), strict=True):
        scans.clear()
        found = {f.code: f for f in surae.check(shifted(leg, lag or 0.0)).findings}
        assert ("emg-torque-lag" in found) is (lag is not None)
        if leg is legs[0]:
            assert len(scans) == 1  # the fits beside begin where the first one ended
        if lag is not None:
            assert found["emg-torque-lag"].value == pytest.approx(lag - 0.06, abs=0.07)


def test_right_recordings_do_not_drift_or_fade(legs, recording, shared) -> None:
    measured = [surae.read(shared / "dynamometer" / "PL_50_01.toml")]
    for right in (recording, *legs, *measured):
        codes = {f.code for f in surae.check(right).findings}
        assert not {"torque-drift", "emg-gain"} & codes


def test_an_amplifier_that_idles_is_no_passive_trial(legs) -> None:
    """Its EMG is noise of half a microvolt while the torque is an effort's."""
    rng, idle = np.random.default_rng(1), legs[0]
    for muscle in ("ta", "gl", "sol", "gm"):
        noise = 5e-7 * np.abs(rng.standard_normal(idle.channels["angle"].values.size))
        idle = changed(idle, f"emg_{muscle}", lambda _, noise=noise: noise)
    (finding,) = (f for f in surae.check(idle).findings if f.code == "active-not-active")
    assert finding.severity == "error"
    assert "amplifier" in finding.advice
    assert "passive trial, fix" not in finding.advice


def test_a_zero_competes_with_signs_and_lag_and_has_the_runner_up_beside_it(legs) -> None:
    told = {}
    for leg in legs:
        zero = quick_fit(leg, signals_of(leg)).zero
        off = changed(leg, "torque", lambda v, zero=zero: v - zero - 15.0)
        told = {f.code: f for f in surae.check(off).findings}
        assert told["torque-offset"].value == pytest.approx(-15.0, abs=3.0)
        assert not CLAIMS & set(told)
    assert "the next best, that" in told["torque-offset"].message
    assert told["torque-offset"].message.count("%") == 3


def test_no_fit_tells_the_unit_of_emg(recording) -> None:
    """It competes with nothing: weights take any unit that all electrodes have alike."""
    as_it_is = quick_fit(recording, signals_of(recording))
    for factor in (1e-3, 1e3):
        other = recording
        for muscle in ("ta", "gl", "sol", "gm"):
            other = changed(other, f"emg_{muscle}", lambda v, by=factor: v * by)
        same = quick_fit(other, signals_of(other))
        assert same.r2 == pytest.approx(as_it_is.r2, abs=1e-9)
