"""`surae.fit` as people call it: a file, its filters, and no model named.

In the fast suite tests/measures/test_measures.py has one such fit.
"""

import numpy as np
import pytest

import surae
from promises import IDENTIFIED, keeps_the_promise
from richer_legs import richer_leg
from surae.protocol import Protocol, generate
from surae.recording import MUSCLES
from surae.studies import virtual_subject, virtual_trial

pytestmark = pytest.mark.slow


def fitted(folder, seed: int):
    """The fit of a virtual subject's file, envelopes clipped at zero, and its true values."""
    subject = virtual_subject(seed)
    motion = generate(
        Protocol(
            profile="multiple-holds",
            chirp_amplitude=0.1,
            chirp_rate=0.2,
            rate_hz=125.0,
            duration=25.0,
        )
    )
    trial = virtual_trial(subject, motion)
    columns = {"time_s": trial.time, "angle_rad": trial.angle, "torque_Nm": trial.torque}
    emg = np.maximum(trial.emg, 0.0)
    columns |= {f"emg_{m}_V": emg[:, i] for i, m in enumerate(MUSCLES)}
    path = folder / f"{seed}.csv"
    surae.write_csv(path, columns, ["emg: envelope"])
    return surae.fit(path, quality=()), subject.parameters


@pytest.fixture(scope="module")
def legs(tmp_path_factory):
    folder = tmp_path_factory.mktemp("auto")
    return [fitted(folder, seed) for seed in (1, 2, 4)]


def test_a_filtered_recording_is_followed(legs) -> None:
    """The filters take noise away where there is no signal: that is not to be trusted."""
    for fit, _ in legs:
        assert fit.adequacy.grade == "adequate"


def test_what_is_identified_of_a_filtered_recording_is_true(legs) -> None:
    free = [(p, truth) for fit, truth in legs for p in fit.parameters.values() if p.free]
    held = [
        p.ci95[0] <= truth[p.name] <= p.ci95[1] for p, truth in free if p.verdict == "identified"
    ]
    assert len(held) >= IDENTIFIED * len(free)  # 14 of 51 when it was looked at, all true
    assert keeps_the_promise(sum(held), len(held), 0.95)


@pytest.mark.parametrize("drifting", [False, True])
def test_what_is_identified_of_richer_legs_is_true(tmp_path, drifting) -> None:
    """Twelve legs that `auto` can describe, as files; `benchmarks/trust.py` counts on others."""
    free = claimed = true = 0
    for seed in range(900, 912):
        leg = richer_leg(seed, drifting=drifting)
        leg.write(tmp_path / "leg.csv")
        for name, p in surae.fit(tmp_path / "leg.csv", quality=()).parameters.items():
            free += p.free
            if p.verdict == "identified":
                claimed += 1
                true += p.ci95[0] <= leg.parameters[name] <= p.ci95[1]
    assert claimed >= IDENTIFIED * free  # 72 and 70 of 204 when looked at
    assert true >= 0.9 * claimed


def test_the_filter_is_not_identified_where_two_muscles_have_no_electrode(tmp_path) -> None:
    # What gastrocnemius does shows as another filter: β was called identified, four deviations off.
    leg = richer_leg(662)
    leg.write(tmp_path / "leg.csv", ("ta", "sol"))
    fit = surae.fit(tmp_path / "leg.csv", fixed={"g2": 0.0, "g4": 0.0}, quality=())
    for name in ("f0", "beta"):
        assert fit.parameters[name].verdict != "identified"
        low, high = fit.parameters[name].ci95
        assert low <= leg.parameters[name] <= high
    assert fit.parameters["beta"].budget["unheard"] > 0.5
