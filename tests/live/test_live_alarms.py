"""Alarms within a trial: told within two seconds, and never of a trial in which all is well."""

from dataclasses import replace

import numpy as np
import pytest

from marks import slow
from surae.protocol import DEVICES, Protocol, generate
from surae.studies import realistic_imperfections, virtual_recording, virtual_subject
from surae_workbench.live.alarms import EVERY, Watch
from surae_workbench.live.stream import Stream

ROLES = ("angle", "torque", "emg_ta", "emg_gl", "emg_sol", "emg_gm")
RATE, BEFORE = 1024.0, 6.0
SPAN = (-0.9, 0.6)
DEVICE = DEVICES["achilles"]


def made(leg=1, profile="multiple-holds", task="active", seconds=20.0):
    """A trial as it is measured after some rest: request, and signals of shape (n, 6)."""
    settings = Protocol(
        profile=profile,
        task=task,
        duration=seconds,
        rate_hz=RATE,
        device=DEVICE,
        angle_range=SPAN,
    )
    asked, who = generate(settings), virtual_subject(leg)
    channels = virtual_recording(
        who, asked, seed=leg, imperfections=realistic_imperfections(who)
    ).channels
    signals = np.column_stack([channels[role].values for role in ROLES])
    rest = np.repeat(signals[:1] * [1, 1, 0, 0, 0, 0], round(BEFORE * RATE), axis=0)
    signals = np.concatenate([rest, signals])
    rng = np.random.default_rng(leg)
    signals[:, 2:] += 2e-6 * rng.standard_normal((len(signals), 4))
    return asked, signals


def watched(asked, signals, watch=None, start=0.0):
    """All alarms with when they are told [s] from the trial's begin, sent as a device sends."""
    watch = watch or Watch(DEVICE, SPAN)
    watch.roles = {f"D: {role}": (role, 1.0, 0.0) for role in ROLES}
    watch.speed = float(np.abs(asked.velocity).max())
    stream = Stream(2, "D", "x", "here", list(ROLES), [""] * 6, RATE, False, "")
    told, sent, due = [], 0, EVERY
    while sent < len(signals):
        end = min(sent + 16, len(signals))
        times = start + np.arange(sent, end) / RATE
        watch.show(stream, times, signals[sent:end])
        sent = end
        if times[-1] - start >= due:
            own = due - BEFORE
            effort = np.array(
                [np.interp(own, asked.time, e, left=0.0, right=0.0) for e in asked.effort.T]
            )
            told += [(own, alarm) for alarm in watch.look(start + due, effort)]
            due += EVERY
    return told


@pytest.fixture(scope="module")
def trial():
    return made()


QUIET = [
    (1, "multiple-holds", "active"),
    (2, "sine", "passive"),
    (3, "multiple-holds", "part-passive"),
    (4, "ramp-and-hold", "active"),
    (5, "sine", "active"),
    (6, "multiple-holds", "passive"),
]


@pytest.mark.parametrize(("leg", "profile", "task"), [*QUIET[:3], *(slow(*q) for q in QUIET[3:])])
def test_a_good_trial_has_no_alarm(leg, profile, task) -> None:
    asked, signals = made(leg, profile, task)
    told = watched(asked, signals)
    if np.abs(signals[:, 1]).max() > 0.9 * DEVICE.max_torque:  # which is true
        told = [(at, alarm) for at, alarm in told if alarm.code != "torque-limit"]
    assert told == []


def first(asked, signals, code, role):
    told = [(at, alarm) for at, alarm in watched(asked, signals) if alarm.code == code]
    assert told, f"no {code}"
    assert {alarm.role for _, alarm in told} == {role}
    return told[0]


MAINS = 50.0


def spoilt(signals, what, at, column):
    """Signals with a fault from `at` seconds of the trial on."""
    signals = signals.copy()
    on = slice(round((BEFORE + at) * RATE), None)
    time = np.arange(len(signals))[on] / RATE
    noise = np.random.default_rng(0).standard_normal(len(time))
    hum = np.sin(2 * np.pi * MAINS * time)
    if what == "electrode-off":
        signals[on, column] = 2e-3 * hum + 1e-4 * noise
    elif what == "hum":
        signals[on, column] += 3e-4 * hum
    elif what == "silent":
        signals[on, column] = signals[on, column][0]
    elif what == "cable":
        signals[on, column] = 1e-9 * noise
    elif what == "clipped":
        most = 0.3 * np.quantile(np.abs(signals[:, column]), 0.999)
        signals[on, column] = np.clip(signals[on, column], -most, most)
    elif what == "offset":
        signals[on, column] += 5e-3
    return signals


@pytest.mark.parametrize("what", ["electrode-off", "silent", "cable", "offset"])
@pytest.mark.parametrize("at", [0.5, slow(8.0)])
@pytest.mark.parametrize("column", [slow(2), 4])
def test_an_electrode_that_fails_is_named_within_two_seconds(trial, what, at, column) -> None:
    asked, signals = trial
    # Before a muscle has worked, nothing tells mains alone from mains beside it.
    code = {"cable": "silent"}.get(what, "hum" if what == "electrode-off" and at < 1 else what)
    told, alarm = first(asked, spoilt(signals, what, at, column), code, ROLES[column])
    assert at <= told <= at + 2.0
    assert {2: "tibialis", 4: "soleus"}[column] in alarm.text
    assert ":" in alarm.text  # what to do


@pytest.mark.parametrize("leg", [1, slow(2), slow(3)])
def test_hum_is_named_within_two_seconds_of_rest(leg) -> None:
    asked, signals = made(leg, "sine", "passive")
    told, alarm = first(asked, spoilt(signals, "hum", 5.0, 3), "hum", "emg_gl")
    assert 5.0 <= told <= 7.0
    assert "50 Hz" in alarm.text


def test_a_clipped_amplifier_is_named_while_the_muscle_works() -> None:
    asked, signals = made(2, "sine", "active", 25.0)
    role = "emg_sol"
    at = 3.0
    broken = spoilt(signals, "clipped", at, 4)
    reached = np.abs(broken[:, 4]) >= np.abs(broken[round((BEFORE + at) * RATE) :, 4]).max()
    begin = float(np.flatnonzero(reached[round((BEFORE + at) * RATE) :])[20]) / RATE + at
    told, _ = first(asked, broken, "clipped", role)
    assert told <= begin + 2.0


def test_torque_and_speed_near_the_limit_are_told(trial) -> None:
    asked, signals = trial
    high = signals.copy()
    at = round((BEFORE + 5.0) * RATE)
    high[at : at + 600, 1] = 75.0
    told = [a for at, a in watched(asked, high) if 5.0 <= at <= 6.0 and a.role == "torque"]
    assert "75 Nm, 94 %" in told[0].text
    fast = signals.copy()
    fast[at:, 0] = fast[at, 0] + np.clip(1.8 * np.arange(len(fast) - at) / RATE, 0, 0.4)
    assert first(asked, fast, "speed-limit", "angle")[0] <= 6.0


def test_effort_that_nobody_asked_for_and_effort_that_does_not_come(trial) -> None:
    asked, signals = trial
    watch = Watch(DEVICE, SPAN)
    watched(asked, signals, watch)  # what effort is, is known now
    rest, relaxed = made(1, "sine", "passive")
    pushing = slice(round((BEFORE + 5.0) * RATE), round((BEFORE + 9.0) * RATE))
    noise = np.random.default_rng(1).standard_normal(4096)
    relaxed[pushing, 3] += 2.0 * signals[:, 3].std() * noise
    ((told, alarm),) = watched(rest, relaxed, watch, 100.0)
    assert (alarm.code, alarm.role, "relax" in alarm.text) == ("effort", "emg_gl", True)
    assert 5.0 < told <= 7.0
    rest, relaxed = made(1, "sine", "passive")
    working = np.zeros_like(rest.effort)
    working[rest.time > 6.0, 1:] = 0.5
    ((told, alarm),) = watched(replace(rest, effort=working), relaxed)
    assert (alarm.code, "push down" in alarm.text) == ("effort", True)
    assert 6.0 < told <= 8.0


def test_envelopes_that_rest_are_no_silent_electrodes() -> None:
    asked, signals = made(1, "sine", "passive")
    signals[:, 2:] = 0.0
    at = round(BEFORE * RATE)
    signals[at - 3000 : at - 1000, 2:] = 0.4  # they were heard once
    assert [a for _, a in watched(asked, signals) if a.code == "silent" and _ > 0] == []
