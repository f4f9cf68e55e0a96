"""Two visits of one leg: what differs by more than chance, and what is not to be compared."""

import pytest

import surae
from perturbed_ankle import ramps
from surae.base.errors import InputError
from surae.nerve.change import nerve_change, of_files


def saved(stiffness, ci, torque=5.0):
    measure = {"value": stiffness, "ci95": ci}
    none = {"value": None, "ci95": [0.0, None]}
    return {
        "measures": {"intrinsic_stiffness": measure, "reflex_gain": none},
        "recordings": [{"mean_torque": torque}],
        "reflex": {},
    }


@pytest.mark.parametrize(("after", "verdict"), [(66.0, "changed"), (61.0, "no change shown")])
def test_a_change_is_claimed_beyond_both_intervals_alone(after, verdict) -> None:
    found = nerve_change(saved(60.0, [58.0, 62.0]), saved(after, [after - 2.0, after + 2.0]))
    stiffness, gain = found.differences
    assert stiffness.verdict == verdict
    assert stiffness.smallest == pytest.approx(8.0**0.5)
    assert gain.verdict == "not comparable"
    assert len(found.notes) == 1


def test_another_effort_is_named() -> None:
    found = nerve_change(saved(60.0, [58.0, 62.0]), saved(90.0, [88.0, 92.0], torque=12.0))
    assert "effort" in found.notes[1]


def test_stretches_of_the_same_leg_show_no_change(tmp_path) -> None:
    speeds, paths = (10.0, 10.0, 120.0, 120.0), []
    for seed in (1, 2):
        paths.append(tmp_path / f"{seed}.json")
        surae.stretches(ramps(speeds, neural=6.0, seed=seed)).save(paths[-1])
    found = of_files(*paths)
    told = {d.name: d.verdict for d in found.differences if d.name.startswith("neural")}
    assert told
    assert "changed" not in told.values()


def test_files_of_two_commands_are_refused() -> None:
    with pytest.raises(InputError, match="the other"):
        nerve_change(saved(60.0, [58.0, 62.0]), {"stretches": [], "threshold": {}})
