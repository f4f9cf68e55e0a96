"""EMG that is lost in pieces, or hums at multiples of the mains, is told; other EMG is not."""

from dataclasses import replace

import numpy as np
import pytest

import surae
from surae.base.frozen import read_only
from surae.quality import Quality, check_recording
from surae.recording import Recording

MOTION = (("sine", 0.0, False),)
#: Begins and lengths of lost pieces [s].
LOST = ((4.0, 0.02), (9.3, 0.05), (14.1, 0.1), (17.0, 0.2), (21.7, 0.4))


def lines(quality: Quality, code: str) -> list[str]:
    return [str(finding.message) for finding in quality.findings if finding.code == code]


@pytest.mark.parametrize("held", [False, True])
@pytest.mark.parametrize("channels", [[2], [0, 1, 2, 3]])
def test_pieces_that_are_lost_are_counted(planted, held, channels) -> None:
    signals = planted.signals(70000, motions=MOTION)
    for begin, seconds in LOST:
        first = round(begin * signals.rate)
        gone = slice(first, first + round(seconds * signals.rate) + 1)
        signals.emg[gone, channels] = signals.emg[first, channels] if held else 0.0
    told = lines(check_recording(signals.recording), "emg-flat")
    assert len(told) == len(channels)
    assert all("stands still 5 times, for 0.77 s in all" in line for line in told)


@pytest.mark.parametrize("pieces", [0, 2])
def test_a_piece_or_two_are_no_lost_packets(planted, pieces) -> None:
    signals = planted.signals(70000, motions=MOTION)
    for begin, _ in LOST[:pieces]:
        signals.emg[round(begin * signals.rate) :][:200] = 0.0
    assert not lines(check_recording(signals.recording), "emg-flat")


@pytest.mark.parametrize("digit", [1e-6, 5e-6, 2e-5])
def test_coarse_digits_are_no_lost_packets(planted, digit) -> None:
    """A muscle at rest keeps one value for long behind a coarse recorder, then another."""
    signals = planted.signals(70000, task="part-passive", motions=MOTION)
    signals.emg = np.round(signals.emg / digit) * digit
    told = lines(check_recording(signals.recording), "emg-flat")
    assert not [line for line in told if "stands still" in line]


@pytest.mark.parametrize("hz", [100.0, 150.3, 180.0])
def test_hum_is_told_by_a_multiple_of_the_mains_alone(planted, hz) -> None:
    signals = planted.signals(70000, motions=MOTION)
    signals.emg[:, 1] += 3e-5 * np.sin(2 * np.pi * hz * signals.time)
    (line,) = lines(check_recording(signals.recording), "mains-hum")
    assert f"a hum of {hz:.1f} Hz" in line


def test_hum_is_no_co_contraction(planted) -> None:
    """Two electrodes that hear the mains are as loud as each other throughout."""
    signals = planted.signals(70000, task="active", motions=MOTION)
    own = signals.emg.copy()
    signals.emg += 1e-3 * np.sin(2 * np.pi * 50.0 * signals.time)[:, None]
    quality = check_recording(signals.recording)
    assert len(lines(quality, "mains-hum")) == 4
    assert not lines(quality, "co-contraction")
    (reason,) = [skip.reason for skip in quality.skipped if skip.check == "co-contraction"]
    assert "hum" in reason
    # what both sides do is told beside a hum that does not cover it
    both = own + own[:, [1, 0, 0, 0]]
    signals.emg = both + 5e-5 * np.sin(2 * np.pi * 50.0 * signals.time)[:, None]
    quality = check_recording(signals.recording)
    assert lines(quality, "co-contraction")
    assert lines(quality, "mains-hum")


def test_measured_emg_is_not_lost_in_pieces(shared) -> None:
    files = [*shared.glob("dynamometer/*.mat"), *shared.glob("repeats/*.mat")]
    assert files
    for path in files:
        assert not [line for line in lines(surae.check(path), "emg-flat") if "stands still" in line]


def leg(kind: str, seed: int = 3, family: str = "a", *, raw: bool = True):
    """A virtual leg of another generator, its signals by name."""
    make = pytest.importorskip("ankle_legs.make")
    one = make.leg(family, seed)
    return one.columns(one.record(1, 35.0, kind), 1, raw=raw)


def recorded(columns, *, raw: bool) -> Recording:
    emg = np.stack([values for name, values in columns.items() if name.startswith("emg_")], axis=1)
    kind = "raw" if raw else "envelope"
    signals = (columns[name] for name in ("time_s", "angle_rad", "torque_Nm"))
    return Recording.from_arrays(*signals, emg, emg_kind=kind)


@pytest.mark.parametrize("raw", [True, False])
@pytest.mark.parametrize(("muscle", "begin"), [("ta", 16.0), ("gl", 16.0), ("sol", 20.0)])
def test_an_electrode_that_falls_silent_is_named_with_its_time(muscle, begin, raw) -> None:
    columns = leg("active", raw=raw)
    dead = columns["time_s"] >= begin
    noise = 2e-6 * np.random.default_rng(1).standard_normal(dead.sum())
    name = f"emg_{muscle}_V"
    columns[name] = columns[name].copy()
    columns[name][dead] = noise if raw else np.abs(1.5e-6 + 0.1 * noise)
    quality = check_recording(recorded(columns, raw=raw))
    (found,) = [f for f in quality.findings if f.code == "electrode-off"]
    assert (found.channel, found.severity) == (f"emg_{muscle}", "error")
    assert begin - 4.0 < found.start_s < begin + 0.5  # the last effort that it showed
    assert "silent from about" in found.message


@pytest.mark.parametrize("raw", [True, False])
@pytest.mark.parametrize("kind", ["active", "passive", "isometric", "alone", "maximal"])
def test_a_muscle_that_is_not_asked_again_has_its_electrode(kind, raw) -> None:
    """One muscle after another rests from its turn on; so does the tibialis before the calf."""
    for seed, family in ((3, "a"), (4, "p")):
        quality = check_recording(recorded(leg(kind, seed, family, raw=raw), raw=raw))
        assert not lines(quality, "electrode-off")


@pytest.mark.parametrize(("family", "seed"), [("w", 905), ("h", 905)])
def test_tissue_that_pulls_alike_both_ways_has_no_turned_signs(family, seed) -> None:
    """With both signs turned a relaxed leg is one too, and may be followed better for no reason."""
    right = recorded(leg("slow", seed, family), raw=True)
    signs = {"angle-sign", "torque-sign"}
    assert not signs & {f.code for f in surae.check(right).findings}
    channels = dict(right.channels)
    torque = channels["torque"]
    channels["torque"] = replace(torque, values=read_only(-torque.values))
    one_turned = replace(right, channels=channels)  # which of the two, a relaxed leg cannot tell
    assert signs & {f.code for f in surae.check(one_turned).findings}
