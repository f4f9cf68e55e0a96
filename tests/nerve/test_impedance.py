"""`surae.impedance`: recovery, verdicts, measured ankles, and what is no perturbation."""

import json
import pickle
import re

import numpy as np
import pytest
from scipy import signal

import surae
from perturbed_ankle import Ankle
from surae.base.errors import InputError
from surae.nerve.judged import Number
from surae.nerve.measures import number_of
from surae.nerve.samples import usable
from surae.nerve.triggered import answering
from surae.nerve.turned import turned
from surae.recording import Recording

TRUE = {"intrinsic_stiffness": 60.0, "inertia": 0.015, "reflex_gain": 6.0, "reflex_delay": 45.0}


@pytest.mark.parametrize("direction", [1, -1])
def test_a_reflex_is_found_with_its_direction_and_its_numbers(ankle, direction) -> None:
    found = surae.impedance(ankle(branch=30.0, direction=direction).recording())
    assert found.reflex.verdict == "present"
    assert found.reflex.direction == {1: "dorsiflexion", -1: "plantarflexion"}[direction]
    for name, true in (TRUE | {"intrinsic_viscosity": 0.8 + 30.0 * 0.02}).items():
        low, high = found.measures[name].ci95
        assert low < true < high
        assert found.measures[name].value == pytest.approx(true, rel=0.1)


def test_tissue_that_relaxes_at_two_rates_is_not_sure_of_its_viscosity(ankle) -> None:
    moved = ankle(branch=40.0, time=0.01, noise=0.02).moved()
    s = 2j * np.pi * np.fft.rfftfreq(len(moved["time"]), 0.002)
    slow = 30.0 * s * 0.1 / (1.0 + s * 0.1) * np.fft.rfft(moved["angle"] - 0.1)
    moved["torque"] += np.fft.irfft(slow, len(moved["time"]))
    found = surae.impedance(Recording.from_arrays(**moved)).measures
    for name, true in {"intrinsic_viscosity": 0.8 + 0.4 + 3.0, "reflex_gain": 6.0}.items():
        low, high = found[name].ci95
        assert low < true < high


@pytest.mark.parametrize("seed", range(3))
def test_tissue_alone_is_no_reflex(ankle, seed) -> None:
    found = surae.impedance(ankle(gain=0.0, branch=40.0, seconds=60.0).recording(seed))
    assert found.reflex.verdict == "none seen"
    assert found.measures["reflex_gain"].value is None
    assert found.measures["reflex_share"].ci95[1] < 2.0
    assert found.measures["intrinsic_stiffness"].value == pytest.approx(60.0, rel=0.05)


def test_a_torque_of_the_other_sign_is_turned_and_that_is_said(ankle) -> None:
    moved = ankle().moved()
    plain = surae.impedance(Recording.from_arrays(**moved))
    turned = surae.impedance(Recording.from_arrays(**moved | {"torque": -moved["torque"]}))
    assert turned.measures == plain.measures
    assert "sign was turned" in turned.recordings[0].notes[0]


@pytest.mark.parametrize("samples", [0, 6, 10, 15])
def test_a_torque_that_is_late_is_moved_back_and_no_other(samples) -> None:
    """By 12 to 30 ms of a leg with a strong reflex; one that is not late stays, also turned."""
    own = Ankle(seconds=30.0, gain=8.0).moved()
    torque = own["torque"]
    own["torque"] = np.concatenate([np.full(samples, torque[0]), torque[: len(torque) - samples]])
    moved, _ = turned(usable("x", *own.values()))
    if samples:
        assert f"{2 * samples} ms later" in moved.notes[-1]
        assert not any("turned" in note for note in moved.notes)
    else:
        assert not moved.notes
        own["torque"] = -torque
        assert "turned" in turned(usable("x", *own.values()))[0].notes[-1]


def test_a_sign_is_not_turned_by_inertia_alone(ankle) -> None:
    """A reflex bends torque as negative inertia would, where stiffness is plain."""
    moved = ankle(stiffness=160.0, inertia=0.008, gain=30.0, switch=0.4).moved()
    samples = usable("ankle", moved["time"], moved["angle"], moved["torque"])
    assert turned(samples)[0] is samples
    found = surae.impedance(Recording.from_arrays(**moved))
    low, high = found.measures["intrinsic_stiffness"].ci95
    assert low < 160.0 < high


def test_a_torque_that_jumps_between_samples_is_timed_to_half_a_sample() -> None:
    """A stiff servo, no filter, one clock: all jumps of the torque are seen half a sample early."""
    draw, h, omega, zeta = np.random.default_rng(2), 1e-3, 190.0, 0.9
    a = np.array([[0.0, 1.0], [-(omega**2), -2.0 * zeta * omega]])
    step, taken = signal.cont2discrete((a, np.array([[0.0], [omega**2]]), a, np.zeros((2, 1))), h)[
        :2
    ]
    command = 0.015 * np.repeat(draw.choice([-1.0, 1.0], 240), 150)
    x = np.zeros((len(command) + 1, 2))
    for i, c in enumerate(command):
        x[i + 1] = step @ x[i] + taken[:, 0] * c
    angle, speed = x[:-1].T
    torque = 65.0 * angle + 0.6 * speed
    torque += 0.016 * (omega**2 * (command - angle) - 2.0 * zeta * omega * speed)
    torque += 0.01 * np.cumsum(draw.standard_normal(len(angle)))
    found = surae.impedance(Recording.from_arrays(h * np.arange(len(angle)), angle, torque))
    for name, true in (("intrinsic_viscosity", 0.6), ("inertia", 0.016)):
        low, high = found.measures[name].ci95
        assert low < true < high
    assert any("half a sample" in note for note in found.recordings[0].notes)


def test_a_stiffness_below_zero_claims_nothing(ankle) -> None:
    """No held ankle pushes away from where it is: a fit that says so has lost its way."""
    moved = ankle(gain=0.0).moved()
    torque = moved["torque"] - 160.0 * (moved["angle"] - moved["angle"].mean())
    found = surae.impedance(Recording.from_arrays(**moved | {"torque": torque}))
    assert found.reflex.verdict == "cannot tell"
    assert {m.value for m in found.measures.values()} == {None}
    assert "below zero" in found.measures["intrinsic_stiffness"].note


@pytest.mark.parametrize("answers", [True, False])
def test_emg_after_stretches_is_averaged_and_its_latency_said(ankle, answers) -> None:
    moved, draw = ankle().moved(), np.random.default_rng(3)
    speed = np.gradient(moved["angle"], moved["time"])
    emg = 1e-6 * np.abs(draw.standard_normal((len(speed), 4)))
    if answers:  # 40 ms later, in the calf alone
        late = np.roll(np.maximum(speed, 0.0), round(0.04 * 500))
        emg[:, 1:] += 1e-5 * late[:, None]
    recording = Recording.from_arrays(**moved, emg=emg, emg_kind="envelope", name="ankle")
    samples = usable("ankle", moved["time"], moved["angle"], moved["torque"])
    said = answering(recording, samples, 1)
    assert ("EMG answers stretch" in said) is answers
    assert ("No EMG" in said) is not answers
    if answers:
        latencies = [int(ms) for ms in re.findall(r"(\d+) ms", said)]
        assert len(latencies) == 3
        assert latencies == pytest.approx([40] * 3, abs=8)


@pytest.mark.slow
def test_half_a_recording_says_the_same(ankle) -> None:
    moved = ankle(seconds=60.0).moved()
    half = {name: values[: len(values) // 2] for name, values in moved.items()}
    whole, part = (surae.impedance(Recording.from_arrays(**m)) for m in (moved, half))
    for name in TRUE:
        low, high = part.measures[name].ci95
        assert low < whole.measures[name].value < high


def test_what_has_no_numbers_is_left_out_and_counted(ankle, tmp_path) -> None:
    moved = ankle(seconds=60.0).moved()
    moved["torque"][10_000:11_000] = np.nan
    path = tmp_path / "gap.csv"
    rows = zip(*moved.values(), strict=True)
    path.write_text(
        "time_s,angle_rad,torque_Nm\n" + "".join(f"{a},{b},{c}\n" for a, b, c in rows), "utf-8"
    )
    found = surae.impedance(path)
    assert any("Left out: 2 s without samples" in note for note in found.recordings[0].notes)
    assert found.measures["intrinsic_stiffness"].value == pytest.approx(60.0, rel=0.05)
    with pytest.raises(InputError, match="not a finite number"):
        surae.read(path)


def test_lost_contact_is_left_out(ankle) -> None:
    moved = ankle(seconds=60.0, noise=0.05).moved()
    moved["torque"][10_000:12_000] = 0.3
    found = surae.impedance(Recording.from_arrays(**moved))
    assert any("contact lost" in note for note in found.recordings[0].notes)
    assert found.measures["intrinsic_stiffness"].value == pytest.approx(60.0, rel=0.05)


def test_a_coarse_encoder_is_named(ankle) -> None:
    moved = ankle().moved()
    moved["angle"] = np.round(moved["angle"] / 0.003) * 0.003
    notes = surae.impedance(Recording.from_arrays(**moved)).recordings[0].notes
    assert any("finer encoder" in note for note in notes)


def test_one_direction_alone_tells_no_reflex(ankle) -> None:
    moved = ankle(gain=0.0).moved()
    t = moved["time"]
    moved["angle"] = 0.02 * np.minimum(
        t % 0.8 / 0.03, 1.0 - np.clip(t % 0.8 - 0.03, 0.0, 1.0) / 0.77
    )
    moved["torque"] = 60.0 * moved["angle"] + 0.05 * np.random.default_rng(1).standard_normal(
        len(t)
    )
    moved["torque"] += 0.5 * np.gradient(moved["angle"], t)
    found = surae.impedance(Recording.from_arrays(**moved))
    assert found.reflex.verdict == "cannot tell"
    assert "one direction only" in found.reflex.reason


def voluntary(moved):
    t = moved["time"]
    moved["angle"] = 0.3 * np.sin(2 * np.pi * 0.7 * t + np.sin(0.9 * t))
    moved["torque"] = -10.0 * np.sin(2 * np.pi * 0.7 * t)


def still(moved):
    moved["angle"] = 0.1 + 1e-4 * np.sin(moved["time"])


def slow(moved):
    moved["angle"] = 0.02 * np.sin(2 * np.pi * 1.5 * moved["time"] + np.sin(moved["time"]))


def saturated(moved):
    moved["torque"] = np.clip(moved["torque"], 2.6, 3.4)


def short(moved):
    for name in moved:
        moved[name] = moved[name][:5000]


@pytest.mark.parametrize(
    ("spoil", "said"),
    [
        (still, "does not move"),
        (voluntary, "by will"),
        (slow, "too little bandwidth"),
        (saturated, "at its limit.*raise the range"),
        (short, "record 60 s"),
    ],
)
def test_what_is_no_perturbation_is_said_in_one_line(ankle, spoil, said) -> None:
    moved = ankle().moved()
    spoil(moved)
    with pytest.raises(InputError, match=said) as caught:
        surae.impedance(Recording.from_arrays(**moved))
    assert "\n" not in str(caught.value)


def test_a_leg_that_drives_the_device_is_named(ankle) -> None:
    moved = ankle(viscosity=-0.8, gain=0.0).moved()
    said = surae.impedance(Recording.from_arrays(**moved))
    assert said.reflex.verdict == "cannot tell"
    assert "a movement by will" in said.reflex.reason
    assert all(m.value is None for m in said.measures.values())


def test_the_empty_device_leaves_the_foot(ankle) -> None:
    empty = ankle(stiffness=0.0, viscosity=0.01, inertia=0.005, gain=0.0, noise=0.02).recording(2)
    found = surae.impedance(ankle().recording(), empty=empty)
    low, high = found.measures["inertia"].ci95
    assert low < 0.010 < high
    assert found.measures["inertia"].value == pytest.approx(0.010, rel=0.05)


@pytest.mark.slow
def test_several_recordings_stand_in_one_table(ankle, tmp_path) -> None:
    each = [ankle(stiffness=k).recording(k) for k in (50, 70)]
    found = surae.impedance(each)
    low, high = found.measures["intrinsic_stiffness"].ci95
    assert low <= found.recordings[0].measures["intrinsic_stiffness"].value <= high
    assert pickle.loads(pickle.dumps(found)) == found
    found.save(tmp_path / "I.json")
    plain = json.loads((tmp_path / "I.json").read_text("utf-8"))
    assert plain["measures"]["reflex_share"]["ci95"][0] > 0.0
    assert {"path", "vaf", "vaf_held_out", "vaf_held_out_intrinsic"} <= set(plain["recordings"][0])


MEASURED = [("plantarflexing", 88.0), ("dorsiflexing", 94.0), ("dorsiflexing_stronger", 93.0)]


@pytest.mark.parametrize(("name", "least"), MEASURED)
def test_measured_ankles_show_a_reflex_to_dorsiflexion(shared, name, least) -> None:
    found = surae.impedance(shared / "perturbed" / f"{name}.csv")
    recording = found.recordings[0]
    assert (found.reflex.verdict, found.reflex.direction) == ("present", "dorsiflexion")
    assert recording.vaf_held_out > least
    assert recording.vaf_held_out > recording.vaf_held_out_other + 5.0
    (a, *_), (b, *_) = recording.stationarity.halves
    assert a == pytest.approx(b, rel=0.15)
    low, high = found.measures["intrinsic_stiffness"].ci95
    for value, *_ in recording.structures.values():
        assert low <= value <= high
    assert not any("moved back" in str(note) for note in recording.notes)


def test_no_number_of_a_reflex_is_identified_while_its_law_is_assumed() -> None:
    narrow = Number(40.0, 39.5, 40.5)
    told = number_of("reflex_delay", narrow)
    assert (told.verdict, told.ci95) == ("weak", (39.5, 40.5))
    assert "another law" in told.note
    assert number_of("intrinsic_stiffness", narrow).verdict == "identified"


def held_ankle(seed: int, servo: float) -> Recording:
    """Tissue alone on a servo [Nm/rad] that yields to it: a state space, solved by SciPy.

    Its angle is what motor, tissue and person make it; torque has drift and coloured noise.
    """
    draw, n, rate, motor = np.random.default_rng(seed), 30_000, 1000.0, 0.05
    time = np.arange(n) / rate
    k, b, i = draw.uniform((30.0, 0.4, 0.01), (150.0, 2.0, 0.03))
    command = 0.015 * draw.choice([-1.0, 1.0], n)[np.cumsum(draw.random(n) < 5.0 / rate)]
    coloured = signal.lfilter([1.0], [1.0, -0.98], draw.standard_normal(n))
    drift = np.cumsum(draw.standard_normal(n))
    person = 0.3 * coloured / coloured.std() + drift / drift.std()
    damping = 1.6 * np.sqrt(servo * (motor + i))
    a = np.array([[0.0, 1.0], [-(servo + k) / (motor + i), -(damping + b) / (motor + i)]])
    driven = np.array([[0.0, 0.0], [servo / (motor + i), -1.0 / (motor + i)]])
    given = np.column_stack([command, person])
    plant = signal.StateSpace(a, driven, np.eye(2), np.zeros((2, 2)))
    _, state, _ = signal.lsim(plant, given, time)
    acceleration = state @ a[1] + given @ driven[1]
    torque = state @ np.array([k, b]) + i * acceleration + person
    torque += 0.05 * draw.standard_normal(n)
    return Recording.from_arrays(time, state[:, 0] + 0.05, torque, name="held")


@pytest.mark.parametrize(("seed", "servo"), [(0, 3000.0), (1, 800.0), (2, 3000.0), (11, 800.0)])
def test_no_reflex_is_present_in_tissue_of_another_simulator(seed: int, servo: float) -> None:
    found = surae.impedance(held_ankle(seed, servo))
    assert found.reflex.verdict != "present"
    assert found.measures["reflex_gain"].value is None
    assert found.measures["reflex_gain"].verdict != "identified"
    assert not any("moved back" in str(note) for note in found.recordings[0].notes)
