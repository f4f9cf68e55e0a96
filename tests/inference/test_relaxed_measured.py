"""The relaxed leg on a measured one: a slow rotation, held angles and active trials agree."""

import numpy as np
import pytest

import surae

HOLDS = ("Pas_-15", "Pas_5", "Pas_10", "Pas_20")
ROTATION = ("Pas_Sho2Long",)
ACTIVE = ("PL_0_01", "PL_50_01", "PL_50_02", "PL_100_01", "Ref_Long_01", "Ref_Long_02")


@pytest.fixture(scope="module")
def trials(shared, tmp_path_factory):
    """Every trial by its name, prepared once."""
    folders = [shared / "dynamometer", shared / "repeats"]
    paths = {path.stem: path for folder in folders for path in folder.glob("*.mat")}
    if not {*HOLDS, *ROTATION, *ACTIVE} <= {*paths}:
        pytest.skip("no measured trials of the dynamometer are beside the repository")
    text = (shared / "dynamometer" / "PL_50_01.toml").read_text()
    mapping = tmp_path_factory.mktemp("mapping") / "map.toml"
    mapping.write_text(text.replace('"PL_50_01.mat"', '"{trial}.mat"'))
    return {
        name: surae.prepare(surae.read(paths[name], mapping=mapping))
        for name in (*HOLDS, *ROTATION, *ACTIVE)
    }


def slope(trials, names):
    """Slope of the relaxed torque between 9 and 19° [Nm/deg], and its standard deviation."""
    torque, V = surae.relaxed([trials[name] for name in names]).curve.torque([9.0, 19.0])
    variance = V[0, 0] + V[1, 1] - 2.0 * V[0, 1]
    return (torque[1] - torque[0]) / 10.0, float(np.sqrt(variance)) / 10.0


def test_rotation_and_holds_agree_with_the_ruler(trials) -> None:
    turned, its = slope(trials, ROTATION)
    held, other = slope(trials, HOLDS)
    assert abs(turned - held) < 2.0 * np.hypot(its, other)
    assert turned == pytest.approx(0.22, abs=2.0 * its)  # by ruler 0.21 and 0.23
    assert held == pytest.approx(0.23, abs=2.0 * other)


def test_all_trials_say_what_the_passive_ones_say(trials) -> None:
    together, sd = slope(trials, (*ROTATION, *HOLDS, *ACTIVE))
    assert together == pytest.approx(0.25, abs=0.03)
    found = surae.relaxed([*trials.values()]).findings
    said = {message.code for message in found}
    assert not said & {"relaxed/plate", "relaxed/heavy", "relaxed/reflex"}
    assert not said & {"relaxed/tone_calf", "relaxed/tone_tibialis", "relaxed/noisy"}
    assert sd < 0.05


def test_rest_at_two_ends_only_is_no_curve(trials) -> None:
    found = surae.relaxed([trials[name] for name in ACTIVE], angles=(-5.0, 5.0))
    for name in ("passive_stiffness@5deg", "slow_stiffness@5deg", "passive_stiffness@-5deg"):
        assert found.measures[name].value is None


def test_its_efforts_are_no_rest_and_its_hum_is_no_effort(trials) -> None:
    found = surae.relaxed([*trials.values()])
    seconds = {trial.name: trial.seconds for trial in found.curve.trials}
    passive = [s for name, s in seconds.items() if "Pas" in name]
    active = [s for name, s in seconds.items() if "Pas" not in name]
    assert min(passive) > 15.0
    assert max(active) < 12.0
