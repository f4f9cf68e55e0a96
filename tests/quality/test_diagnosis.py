"""Wrong signs, units and zeros are named with what fits better, and right ones never."""

from dataclasses import replace

import numpy as np
import pytest

import surae
from surae.base.errors import InputError
from surae.base.frozen import read_only
from surae.protocol import Protocol, generate
from surae.quality import recording_of
from surae.recording import Recording
from surae.signals import prepare
from surae.studies import virtual_subject, virtual_trial

#: What says that a recording is not what it is said to be.
CODES = {
    "angle-sign",
    "torque-sign",
    "torque-unit",
    "emg-unit",
    "time-unit",
    "angle-units",
    "angle-still",
    "torque-offset",
}
TRAJECTORY = generate(Protocol(profile="multiple-holds", chirp_amplitude=0.2, rate_hz=128.0))


def trial(seed: int, population: str = "healthy") -> Recording:
    subject = virtual_subject(seed, population)
    return recording_of(virtual_trial(subject, TRAJECTORY, noise=0.03, seed=seed))


def scaled(recording: Recording, roles: tuple[str, ...], factor: float, plus: float = 0.0):
    channels = dict(recording.channels)
    for role in roles:
        values = channels[role].values * factor + plus
        channels[role] = replace(channels[role], values=read_only(values))
    return replace(recording, channels=channels)


def timed(recording: Recording, factor: float) -> Recording:
    channels = {
        role: replace(channel, time=read_only(channel.time * factor))
        for role, channel in recording.channels.items()
    }
    return replace(recording, channels=channels)


def told(recording: Recording) -> dict[str, surae.quality.Finding]:
    findings = surae.check(recording).findings
    return {finding.code: finding for finding in findings if finding.code in CODES}


def test_an_envelope_at_rest_that_hardly_changes_is_not_below_the_noise() -> None:
    resting = trial(4)
    for role in EMG:
        hardly = 3e-6 + 1e-7 * np.sin(resting.channels[role].time)
        channel = replace(resting.channels[role], values=read_only(hardly))
        resting = replace(resting, channels={**resting.channels, role: channel})
    assert "emg-unit" not in told(resting)


@pytest.mark.parametrize("population", ["healthy", "patient"])
@pytest.mark.parametrize(
    ("turned", "codes"),
    [
        ((), set()),
        (("angle",), {"angle-sign"}),
        (("torque",), {"torque-sign"}),
        (("angle", "torque"), {"angle-sign", "torque-sign"}),
    ],
)
def test_turned_signs_are_named_with_what_fits_better(population, turned, codes) -> None:
    findings = told(scaled(trial(4, population), turned, -1.0))
    assert set(findings) == codes
    if turned:
        first = findings[f"{turned[0]}-sign"]
        assert f"the {' and the '.join(turned)} " in first.message
        assert "turned: with that" in first.message
        assert all(f"--sign {role}=-1" in first.advice for role in turned)
        assert "R² rises from" in first.message
        assert first.value > 0.95


EMG = ("emg_ta", "emg_gl", "emg_sol", "emg_gm")


@pytest.mark.parametrize(
    ("change", "code", "words"),
    [
        (lambda r: scaled(r, ("torque",), 1e3), "torque-unit", "mNm"),
        (lambda r: scaled(r, ("torque",), 1e-3), "torque-unit", "kNm"),
        (lambda r: scaled(r, ("torque",), 1e3 / 70.0), "torque-unit", "mNm per kilogram"),
        (lambda r: scaled(r, EMG, 1e-4), "emg-unit", "less than the noise"),
        (lambda r: scaled(r, ("emg_sol",), 1e6), "emg-unit", "soleus"),
        (lambda r: scaled(r, ("emg_ta",), 1e3), "emg-unit", "mV"),
        (lambda r: scaled(r, EMG, 1e6), "emg-unit", "µV"),
        (lambda r: scaled(r, EMG, 1e3), "emg-unit", "behind an amplifier"),
        (lambda r: timed(r, 1e3), "time-unit", "128 Hz"),
        (lambda r: scaled(r, ("angle",), float(np.rad2deg(1.0))), "angle-units", "degrees"),
        (lambda r: scaled(r, ("angle",), float(np.deg2rad(1.0))), "angle-units", "R² rises"),
        (lambda r: scaled(r, ("torque",), 1.0, 15.0), "torque-offset", "Nm"),
        (lambda r: scaled(r, ("angle",), 1e-3), "angle-still", "static hold"),
    ],
)
def test_wrong_units_and_zeros_are_named_alone(change, code, words) -> None:
    findings = told(change(trial(4)))
    assert set(findings) == {code}
    assert words in findings[code].message


def test_a_unit_and_a_sign_that_are_wrong_are_both_named() -> None:
    changed = scaled(scaled(trial(5), ("torque",), 1e3), ("angle",), -1.0)
    assert set(told(changed)) == {"torque-unit", "angle-sign"}


@pytest.mark.parametrize("seed", range(460000, 460002))
def test_nothing_is_said_of_right_recordings_with_crosstalk_delay_and_noise(planted, seed) -> None:
    signals = planted.signals(seed)
    mixed = np.eye(4) + 0.05 * (1.0 - np.eye(4))
    late = round(0.04 * signals.rate)
    emg = signals.emg if signals.raw else signals.emg @ mixed
    signals.emg = np.vstack([emg[late:], np.repeat(emg[-1:], late, axis=0)])
    signals.torque = signals.torque + 2.0
    assert told(signals.recording) == {}


@pytest.mark.slow
def test_a_passive_trial_does_not_tell_which_sign_is_turned() -> None:
    subject = virtual_subject(6)
    passive = generate(Protocol(profile="multiple-holds", task="passive", rate_hz=128.0))
    recording = recording_of(virtual_trial(subject, passive, noise=0.01, seed=6))
    findings = told(scaled(recording, ("angle",), -1.0))
    assert {"angle-sign", "torque-sign"} & set(findings)
    assert told(recording) == {}


@pytest.mark.slow
def test_the_lag_on_periodic_gait_is_not_claimed(shared) -> None:
    findings = surae.check(shared / "gait" / "walk36.toml").findings
    assert "electrode-lag" not in {finding.code for finding in findings}


def test_the_dynamometers_both_signs(shared) -> None:
    recording = surae.read(shared / "dynamometer" / "PL_50_01.toml")
    assert not {"angle-sign", "torque-sign"} & set(told(recording))
    turned = scaled(recording, ("angle", "torque"), -1.0)
    assert {"angle-sign", "torque-sign"} <= set(told(turned))


@pytest.mark.parametrize("name", ["dynamometer/PL_50_01", "repeats/PL_50_02", "repeats/PL_0_01"])
def test_a_zero_that_was_taken_away_is_not_told_again_the_other_way(shared, tmp_path, name) -> None:
    """What is left of the torque at rest is the foot's, or the muscles': a fit finds no zero."""
    written = (shared / "dynamometer" / "PL_50_01.toml").read_text()
    mapping = tmp_path / "map.toml"
    mapping.write_text(written.replace('file = "PL_50_01.mat"', ""))
    recording = surae.read(shared / f"{name}.mat", mapping=mapping)
    zero = told(recording)["torque-offset"].value
    assert zero > 8.0
    assert "torque-offset" not in told(scaled(recording, ("torque",), 1.0, -zero))
    again = told(scaled(recording, ("torque",), 1.0, -zero - 15.0))["torque-offset"]
    assert again.value < -8.0


def test_a_fit_of_milliseconds_says_so(tmp_path) -> None:
    with pytest.raises(surae.InputError, match="in ms, these are 35 s at 128 Hz"):
        surae.fit(timed(trial(4), 1e3), "muscle", starts=1)


def test_raw_emg_on_an_offset_is_taken_as_it_is(planted) -> None:
    signals = planted.signals(70010)
    assert signals.raw
    signals.emg = signals.emg + 0.05
    recording = signals.recording
    assert min(recording.channels[role].values.min() for role in EMG) > 0.0
    assert "emg-offset" in {finding.code for finding in surae.check(recording).findings}
    prepared = prepare(recording)
    assert prepared.emg[:, 1].min() < 1e-4  # the offset is gone


@pytest.mark.parametrize(("declared", "severity"), [("raw", "warning"), ("envelope", "error")])
def test_emg_that_is_not_as_declared_is_a_finding(planted, declared, severity) -> None:
    smooth = recording_of(virtual_trial(virtual_subject(4), TRAJECTORY, noise=0.0))
    recording = planted.signals(70010).recording if declared == "envelope" else smooth
    recording = replace(recording, emg=declared)
    (finding,) = surae.check(recording).findings  # and nothing that only follows from it
    assert (finding.code, finding.severity) == ("emg-kind", severity)
    with pytest.raises(InputError, match=r"is declared .* but looks") as refusal:
        surae.prepare(recording)
    said = finding.message.removesuffix(".")
    assert said.split(" is declared")[1] in str(refusal.value)  # in the same words
    other = "envelope" if declared == "raw" else "raw"
    assert f'emg = "{other}"' in finding.advice
    assert finding.message.endswith(").")  # what it looks like is told whole
