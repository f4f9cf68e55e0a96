"""What findings say: spans, numbers, severities; and what is no fault."""

from dataclasses import replace

import numpy as np
import pytest

import surae
from surae.base.frozen import read_only
from surae.base.records import from_plain
from surae.quality import CODES, SEVERITIES, Commanded, Quality, check_recording, recording_of
from surae.recording import Channel, Recording


@pytest.fixture(scope="module")
def recording(noisy) -> Recording:
    """A trial of 35 s at 125 Hz with the thesis's noise, its EMG as envelopes."""
    return recording_of(noisy)


def changed(recording: Recording, role: str, values) -> Recording:
    channel = replace(recording.channels[role], values=read_only(values))
    return replace(recording, channels={**recording.channels, role: channel})


def at_times(recording: Recording, time, keep=slice(None)) -> Recording:
    channels = {
        role: replace(c, time=read_only(time[keep]), values=read_only(c.values[keep]))
        for role, c in recording.channels.items()
    }
    return replace(recording, channels=channels)


def only(quality: Quality, code: str):
    (match,) = [finding for finding in quality.findings if finding.code == code]
    return match


def codes(quality: Quality) -> list[str]:
    return [finding.code for finding in quality.findings]


def test_every_finding_is_one_sentence_each_and_has_a_known_code(planted) -> None:
    for name in ("emg-flat", "torque-sign", "time-gap", "trial-too-short"):
        plant, needs = planted.FAULTS[name]
        signals = planted.signals(70001, **{**needs, "motions": (("sine", 0.0, False),)})
        plant(signals)
        for finding in check_recording(signals.recording).findings:
            assert finding.code in CODES
            assert finding.severity in SEVERITIES
            assert finding.start_s <= finding.end_s
            for text in (finding.message, finding.advice):
                assert text.endswith(".")
                assert "\n" not in text


def test_the_worst_comes_first(recording) -> None:
    wrong = changed(recording, "torque", -recording.channels["torque"].values)
    values = recording.channels["emg_ta"].values + 5e-5 * np.sin(
        2 * np.pi * 50.0 * recording.channels["emg_ta"].time
    )
    quality = check_recording(changed(wrong, "emg_ta", values))
    ranks = [SEVERITIES.index(finding.severity) for finding in quality.findings]
    assert ranks == sorted(ranks, reverse=True)
    assert quality.worst == "error"


def test_a_gap_has_its_span(recording) -> None:
    time = recording.channels["angle"].time
    keep = (time < 10.0) | (time > 12.0)
    finding = only(check_recording(at_times(recording, time, keep)), "time-gap")
    assert finding.severity == "error"
    assert finding.start_s == pytest.approx(10.0, abs=0.01)
    assert finding.end_s == pytest.approx(12.0, abs=0.01)
    assert finding.value == pytest.approx(2.0, abs=0.02)


def test_rounded_time_stamps_are_no_jitter(recording) -> None:
    time = np.round(np.arange(recording.channels["angle"].time.size) / 128.0, 3)
    assert "time-jitter" not in codes(check_recording(at_times(recording, time)))


def test_jitter_is_measured(recording) -> None:
    rng = np.random.default_rng(1)
    time = recording.channels["angle"].time
    moved = time + 0.1 / 125.0 * np.clip(rng.standard_normal(time.size), -3, 3)
    finding = only(check_recording(at_times(recording, moved)), "time-jitter")
    assert finding.value == pytest.approx(0.1 / 125.0, rel=0.05)


def test_a_dropout_of_raw_emg_has_its_span(planted) -> None:
    signals = planted.signals(70000, motions=(("sine", 0.0, False),))
    inside = (signals.time > 20.0) & (signals.time < 21.5)
    signals.emg[inside, 2] = 0.0
    finding = only(check_recording(signals.recording), "emg-flat")
    assert finding.channel == "emg_sol"
    assert finding.severity == "warning"
    assert (finding.start_s, finding.end_s) == pytest.approx((20.0, 21.5), abs=0.01)


def test_hum_is_measured(planted) -> None:
    signals = planted.signals(70000, motions=(("sine", 0.0, False),))
    signals.emg[:, 1] += 1e-4 * np.sin(2 * np.pi * 60.0 * signals.time)
    finding = only(check_recording(signals.recording), "mains-hum")
    assert finding.value == pytest.approx(1e-4, rel=0.1)
    assert "60.0 Hz" in finding.message


@pytest.mark.parametrize(("amplitude", "mains"), [(2e-3, 50.0), (3e-4, 60.0)])
def test_an_electrode_that_comes_off_is_named_with_its_time(planted, amplitude, mains) -> None:
    signals = planted.signals(70000, motions=(("sine", 0.0, False),))
    off = signals.time >= 12.0
    noise = 1e-5 * np.random.default_rng(1).standard_normal(signals.time.size)
    hum = amplitude * np.sin(2 * np.pi * mains * signals.time) + noise
    signals.emg[off, 2] = hum[off]
    match = only(check_recording(signals.recording), "electrode-off")
    assert (match.channel, match.severity) == ("emg_sol", "error")
    assert match.start_s == pytest.approx(12.0, abs=0.5)
    assert "soleus" in match.message


@pytest.mark.parametrize("back", [20.0, 25.0])
def test_an_electrode_that_works_again_has_not_come_off(planted, back) -> None:
    signals = planted.signals(70000, motions=(("sine", 0.0, False),))
    assert signals.time[-1] > back + 3.0
    still = (signals.time >= 12.0) & (signals.time < back)
    signals.emg[still, 2] = 2e-3 * np.sin(2 * np.pi * 50.0 * signals.time[still])
    assert "electrode-off" not in codes(check_recording(signals.recording))


@pytest.mark.parametrize("part", [slice(None), slice(0, 20000)])
def test_hum_throughout_or_only_at_first_is_no_electrode_that_comes_off(planted, part) -> None:
    signals = planted.signals(70000, motions=(("sine", 0.0, False),))
    signals.emg[part, 2] += 2e-3 * np.sin(2 * np.pi * 50.0 * signals.time[part])
    codes_found = codes(check_recording(signals.recording))
    assert "electrode-off" not in codes_found
    assert "mains-hum" in codes_found


@pytest.mark.parametrize("lag", [0.2, -0.2])
def test_a_lag_has_its_size_and_direction(recording, lag) -> None:
    moved = recording
    for muscle in ("ta", "gl", "sol", "gm"):
        values = np.roll(recording.channels[f"emg_{muscle}"].values, round(lag * 125.0))
        moved = changed(moved, f"emg_{muscle}", values)
    finding = only(check_recording(moved), "emg-torque-lag")
    assert finding.value == pytest.approx(lag, abs=0.05)
    assert ("late" if lag > 0 else "early") in finding.message


def test_an_offset_of_the_torque_has_its_size(recording) -> None:
    torque = recording.channels["torque"].values
    plus = only(check_recording(changed(recording, "torque", torque + 15.0)), "torque-offset")
    minus = only(check_recording(changed(recording, "torque", torque - 15.0)), "torque-offset")
    assert plus.value - minus.value == pytest.approx(30.0, abs=5.0)


def test_an_impossible_torque_is_an_artefact(recording) -> None:
    torque = recording.channels["torque"].values.copy()
    torque[2000:2010] = -400.0
    finding = only(check_recording(changed(recording, "torque", torque)), "torque-artefact")
    assert finding.value == 400.0
    assert finding.start_s == pytest.approx(16.0, abs=0.01)


def test_a_torque_that_is_not_explained_is_an_artefact(recording) -> None:
    torque = recording.channels["torque"].values.copy()
    torque[2000:2020] -= 60.0
    finding = only(check_recording(changed(recording, "torque", torque)), "torque-artefact")
    assert finding.start_s == pytest.approx(16.0, abs=0.2)


def test_a_torque_at_the_limit_of_a_stated_device(recording) -> None:
    torque = np.minimum(recording.channels["torque"].values, 30.0)
    stated = replace(changed(recording, "torque", torque), device={"max_torque": 30.0})
    finding = only(check_recording(stated), "torque-limit")
    assert finding.value == 30.0
    assert "the limit of 30 Nm" in finding.message


def test_an_isometric_trial_has_no_wrong_unit(recording) -> None:
    rng = np.random.default_rng(2)
    still = 0.1 + 0.003 * rng.standard_normal(recording.channels["angle"].time.size)
    told = codes(check_recording(changed(recording, "angle", still)))
    assert "angle-units" not in told
    assert "rom-not-covered" in told


def test_a_muscle_without_emg_is_information_where_its_weight_is_fixed(recording) -> None:
    channels = {r: c for r, c in recording.channels.items() if r != "emg_gl"}
    without = replace(recording, channels=channels)
    assert only(check_recording(without), "emg-missing").severity == "warning"
    fixed = replace(without, fixed={"g2": 0.0})
    assert only(check_recording(fixed), "emg-missing").severity == "info"
    assert "emg-missing" not in codes(check_recording(recording))


def test_without_any_emg_much_is_left_out_with_a_reason(recording) -> None:
    channels = {r: c for r, c in recording.channels.items() if not r.startswith("emg")}
    quality = check_recording(replace(recording, channels=channels))
    assert {"emg-torque-lag", "active-not-active", "co-contraction", "reflex-suspected"} <= {
        skip.check for skip in quality.skipped
    }
    assert codes(quality).count("emg-missing") == 4


def test_without_torque_what_needs_it_is_left_out(recording) -> None:
    channels = {r: c for r, c in recording.channels.items() if r != "torque"}
    skipped = {
        skip.check for skip in check_recording(replace(recording, channels=channels)).skipped
    }
    assert {"torque-limit", "torque-sign", "torque-offset", "emg-torque-lag"} <= skipped


def test_slow_envelopes_are_not_searched_for_hum(recording) -> None:
    time = recording.channels["angle"].time
    quality = check_recording(at_times(recording, time, slice(None, None, 2)))
    (reason,) = [skip.reason for skip in quality.skipped if skip.check == "mains-hum"]
    assert "62.5 Hz" in reason


def test_a_passive_task_that_was_commanded_needs_no_effort(recording) -> None:
    time = recording.channels["angle"].time
    quiet = recording
    for muscle in ("ta", "gl", "sol", "gm"):
        rest = 1e-6 * (1.0 + 0.05 * np.random.default_rng(3).standard_normal(time.size))
        quiet = changed(quiet, f"emg_{muscle}", rest)
    angle = recording.channels["angle"].values
    asked = Commanded("the protocol", time, angle, read_only(np.zeros((time.size, 4))))
    assert "active-not-active" in codes(check_recording(quiet))
    assert "active-not-active" not in codes(check_recording(quiet, asked))


def test_a_commanded_range_that_is_not_reached(recording) -> None:
    time, angle = recording.channels["angle"].time, recording.channels["angle"].values
    asked = Commanded("the protocol", time, read_only(1.3 * angle))
    finding = only(check_recording(recording, asked), "rom-not-covered")
    assert finding.severity == "warning"
    assert "77 %" in finding.message


def test_a_commanded_hold_is_no_range_that_is_missed(recording) -> None:
    angle = recording.channels["angle"]
    still = Commanded("a hold", angle.time, np.zeros_like(angle.values))
    assert "rom-not-covered" not in codes(check_recording(recording, still))


def test_an_overshoot_is_seen_without_a_known_profile() -> None:
    time = np.arange(0.0, 24.0, 1 / 256)
    angle = np.full(time.size, -0.3)
    for start, size in ((2.0, 0.5), (7.0, -0.4), (13.0, 0.6), (19.0, -0.55)):
        since = np.maximum(time - start, 0.0)
        angle += size * (1 - np.exp(-3 * since) * np.cos(18 * since)) * (time > start)
    ringing = Recording.from_arrays(time, angle)
    finding = only(check_recording(ringing), "overshoot")
    assert finding.value > 0.1
    smooth = np.full(time.size, -0.3)
    for start, size in ((2.0, 0.5), (7.0, -0.4), (13.0, 0.6), (19.0, -0.55)):
        since = np.clip((time - start) / 0.8, 0.0, 1.0)
        smooth += size * since**3 * (10 - 15 * since + 6 * since**2)
    assert "overshoot" not in codes(check_recording(Recording.from_arrays(time, smooth)))


def test_a_movement_there_and_back_before_a_hold_is_no_overshoot() -> None:
    time = np.arange(0.0, 24.0, 1 / 256)
    angle = np.full(time.size, -0.3)
    for start, size in ((2.0, 0.6), (3.0, -0.35), (9.0, -0.3), (10.0, 0.2)):
        since = np.clip((time - start) / 0.9, 0.0, 1.0)
        angle += size * since**3 * (10 - 15 * since + 6 * since**2)
    assert "overshoot" not in codes(check_recording(Recording.from_arrays(time, angle)))


def test_findings_are_plain_data_there_and_back(planted) -> None:
    signals = planted.signals(70001, motions=(("sine", 0.0, False),))
    signals.torque *= -1.0
    quality = check_recording(signals.recording)
    assert quality.findings
    assert from_plain(Quality, quality.as_dict()) == quality


@pytest.mark.parametrize("n", [2, 5, 31, 40])
def test_a_few_samples_are_too_short_and_nothing_breaks(n) -> None:
    time = np.arange(n) / 100.0
    made = Recording.from_arrays(time, np.sin(time), np.cos(time), np.abs(np.ones((n, 4))))
    assert "trial-too-short" in codes(check_recording(made))


@pytest.mark.parametrize("value", [0.0, 1.0])
def test_constant_signals_break_nothing(value) -> None:
    time = np.arange(4000) / 200.0
    same = np.full(time.size, value)
    made = Recording.from_arrays(time, same, same, np.full((time.size, 4), value))
    assert codes(check_recording(made)).count("emg-flat") == 4


@pytest.mark.parametrize(
    ("rate", "bursts", "said"),
    [
        (128.0, 0.0, []),
        (1000.0, 0.0, []),
        (128.0, 1.0, ["error"]),
        (1000.0, 1.0, ["error"]),
    ],
)
def test_an_envelope_of_a_muscle_at_rest_is_not_raw(recording, rate, bursts, said) -> None:
    """Noise of one strength on a constant may be an envelope's; EMG that comes and goes is not."""
    time = np.arange(0.0, 30.0, 1 / rate)
    noise = np.random.default_rng(7).standard_normal(time.size)
    emg = 2.6e-6 * (1 + 0.03 * noise * (1 + bursts * 2 * (np.sin(time) > 0)))
    channel = Channel("emg_ta", read_only(time), read_only(emg), "V", "")
    made = replace(recording, channels={**recording.channels, "emg_ta": channel})
    kind = [f for f in check_recording(made).findings if f.code == "emg-kind"]
    assert [f.severity for f in kind] == said
    assert all(f.message.endswith("raw on an offset).") for f in kind)


def test_a_relaxed_trial_of_another_generator_is_not_called_raw(tmp_path) -> None:
    laboratory = pytest.importorskip("ankle_legs.laboratory")
    folder = laboratory.write(laboratory.measure("a", 981, ("slow",)), tmp_path)
    assert "emg-kind" not in codes(surae.check(folder / "slow.csv"))


def test_channels_that_share_no_time_are_not_compared() -> None:
    time = np.arange(400) / 100.0
    angle = Channel("angle", read_only(time), read_only(np.sin(time)), "rad", "")
    torque = Channel("torque", read_only(time + 50.0), read_only(np.sin(time)), "Nm", "")
    quality = check_recording(Recording("apart", {"angle": angle, "torque": torque}))
    assert all("share" in skip.reason for skip in quality.skipped)


def test_the_reference_solutions_are_clean(references) -> None:
    for name in ("muscle_healthy", "muscle_patient", "tendon_thesis", "tendon_slack_length"):
        quality = surae.check(references / f"{name}.csv")
        # Their envelopes are prepared, and declared nowhere.
        assert [finding.code for finding in quality.findings] == ["emg-kind"]
        assert quality.worst == "warning"  # a fit refuses them, unless told that they are prepared
        assert not surae.check(references / f"{name}.csv", prepared=True).findings


def test_known_faults_of_measured_data_are_found(shared) -> None:
    walk = surae.check(shared / "gait" / "walk36.toml")
    assert only(walk, "torque-artefact").start_s == pytest.approx(6.3, abs=0.3)
    run = surae.check(shared / "gait" / "run81.toml")
    assert only(run, "torque-artefact").value == pytest.approx(431, abs=2)
    turned = surae.read(shared / "dynamometer" / "PL_50_01.toml")
    assert "torque-sign" not in codes(check_recording(turned))
    flipped = changed(turned, "torque", -turned.channels["torque"].values)
    assert "torque-sign" in codes(check_recording(flipped))


def test_one_signal_in_two_channels_is_said_of_copies_alone(recording) -> None:
    sol = recording.channels["emg_sol"].values
    for same in (sol, 0.5 * sol):
        finding = only(check_recording(changed(recording, "emg_gm", same)), "emg-doubled")
        assert (finding.channel, finding.severity) == ("emg_gm", "error")
        assert "gastrocnemius medialis is that of the soleus" in finding.message
    near = sol + 0.01 * sol.std() * np.random.default_rng(3).standard_normal(len(sol))
    assert "emg-doubled" not in codes(check_recording(changed(recording, "emg_gm", near)))
    assert "emg-doubled" not in codes(check_recording(recording))
    rng, raw = np.random.default_rng(4), replace(recording, emg="raw")
    for role in ("emg_ta", "emg_gl", "emg_sol", "emg_gm"):
        noise = rng.standard_normal(len(sol))
        raw = changed(raw, role, recording.channels[role].values * noise)
    assert "emg-doubled" not in codes(check_recording(raw))
    turned = changed(raw, "emg_gl", -raw.channels["emg_ta"].values)
    assert only(check_recording(turned), "emg-doubled").channel == "emg_gl"
