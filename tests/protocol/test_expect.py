"""What a protocol is said to tell is what fits of noisy trials then show."""

import json
from dataclasses import replace

import numpy as np
import pytest

import surae
from surae.api.requested import ready_trajectory
from surae.base.errors import InputError
from surae.planning.legs import population_legs
from surae.protocol import Protocol, generate, named_device, read_protocol, write_protocol_csv
from surae.studies import virtual_subject, virtual_trial

NOISE = 0.5
RATE = 64.0


def motion(**changes):
    settings = {"profile": "multiple-holds", "chirp_amplitude": 0.1, "rate_hz": RATE}
    return generate(Protocol(**{**settings, "device": named_device("achilles"), **changes}))


def recorded(trajectory, seed, path, population="healthy"):
    """A noisy trial of a virtual leg as a CSV; the leg's parameters."""
    subject = virtual_subject(seed, population)
    trial = virtual_trial(subject, trajectory, noise=0.0)
    torque = trial.torque + NOISE * np.random.default_rng(seed).standard_normal(trial.n)
    table = np.column_stack(
        [trial.time, trial.angle, torque, trial.emg, trial.velocity, trial.acceleration]
    )
    header = (
        "time_s,angle_rad,torque_Nm,emg_ta_V,emg_gl_V,emg_sol_V,emg_gm_V,"
        "angular_velocity_rad_s,angular_acceleration_rad_s2"
    )
    np.savetxt(path, table, delimiter=",", header=header, comments="", fmt="%.12g")
    return subject.parameters


def fitted_errors(trajectory, legs, tmp_path, starts=2):
    """Relative errors of real fits, and the standard errors expected for the same legs.

    What is expected is of the best fit: of thirty, one may need ten starts to come to it.
    """
    errors, said = [], []
    for seed, population in legs:
        truth = recorded(trajectory, seed, tmp_path / "trial.csv", population)
        fit = surae.fit(tmp_path / "trial.csv", "muscle", prepared=True, starts=starts)
        names = list(fit.parameters)
        errors.append([fit.parameters[n].value / truth[n] - 1.0 for n in names])
        own = replace(population_legs("muscle", population, 1))
        own = replace(own, values=np.array([[truth[n] for n in own.spec.names]]))
        from surae.planning.expectation import expected

        told = expected(trajectory, own, NOISE)
        said.append([told.parameters[n].relative_sem for n in names])
    return np.array(errors), np.array(said)


@pytest.mark.slow
@pytest.mark.parametrize("name", ["multiple-holds", "multi-sine-holds"])
def test_errors_of_thirty_fits_are_within_15_percent(tmp_path, name) -> None:
    legs = [(100 + seed, ("healthy", "patient")[seed % 2]) for seed in range(30)]
    errors, said = fitted_errors(motion(profile=name, duration=35.0), legs, tmp_path, starts=10)
    assert np.sqrt(np.mean((errors / said) ** 2)) == pytest.approx(1.0, abs=0.15)


@pytest.mark.slow
def test_errors_of_thirty_fits_of_a_designed_protocol_are_within_15_percent(tmp_path) -> None:
    designed = ready_trajectory("everything-35", named_device("achilles"), (-0.9, 0.6), RATE)
    legs = [(100 + seed, ("healthy", "patient")[seed % 2]) for seed in range(30)]
    errors, said = fitted_errors(designed, legs, tmp_path, starts=10)
    assert np.sqrt(np.mean((errors / said) ** 2)) == pytest.approx(1.0, abs=0.15)


def test_a_file_says_what_its_trajectory_says(tmp_path) -> None:
    trajectory = motion()
    write_protocol_csv(trajectory, tmp_path / "p.csv")
    read = read_protocol(tmp_path / "p.csv")
    np.testing.assert_allclose(read.velocity[:-8], trajectory.velocity[:-8], atol=2e-3)
    first = surae.expect(trajectory, "muscle", legs=4)
    second = surae.expect(tmp_path / "p.csv", "muscle", legs=4)
    for name, p in first.parameters.items():
        assert second.parameters[name].relative_sem == pytest.approx(p.relative_sem, rel=0.02)


def test_the_whole_is_made_of_the_parameters() -> None:
    told = surae.expect(motion(), "muscle", legs=6)
    sems = [p.relative_sem for p in told.parameters.values()]
    assert told.worst == max(sems)
    assert told.parameters[told.weakest].relative_sem == told.worst
    assert told.geometric_mean == pytest.approx(np.exp(np.mean(np.log(sems))))
    assert told.parameters["k_tib"].verdict in ("weak", "undetermined")
    assert told.parameters["beta"].verdict == "identified"
    # what rests on arms and paths no trial identifies, however little its noise
    assert told.parameters["g1"].verdict == "weak"
    assert told.parameters["g1"].relative_sem < 0.05
    assert told.parameters["g1"].half_width > 0.18
    assert json.loads(json.dumps(told.to_json()))["worst"] == told.worst


def test_twice_the_noise_is_twice_the_error_and_the_laboratory_adds_its_own() -> None:
    quiet = surae.expect(motion(), "muscle", legs=2)
    loud = surae.expect(motion(), "muscle", legs=2, noise=1.0)
    assert loud.worst == pytest.approx(2.0 * quiet.worst)
    whole = surae.expect(motion(), "muscle", legs=2, nuisances="all")
    assert all(
        whole.parameters[name].relative_sem > p.relative_sem for name, p in quiet.parameters.items()
    )
    assert sum(whole.parameters["f0"].budget.values()) == pytest.approx(1.0)
    assert whole.parameters["f0"].budget["delay"] > 0.2
    assert quiet.caution in repr(quiet)
    assert quiet.caution
    assert not whole.caution
    assert "caution" not in repr(whole)


def test_nothing_is_claimed_where_nothing_is_told() -> None:
    passive = surae.expect(
        motion(profile="ramp-and-hold", task="passive", chirp_amplitude=0.0), "muscle", legs=3
    )
    # at rest the muscles' EMG is 1 µV: their optimal lengths are not determined
    for name in ("g2", "l0_tri", "f0", "beta"):
        assert passive.parameters[name].verdict == "undetermined"
        assert passive.parameters[name].identified_share == 0.0


def test_a_fit_is_a_leg_too(tmp_path) -> None:
    recorded(motion(), 3, tmp_path / "trial.csv")
    fit = surae.fit(tmp_path / "trial.csv", "muscle", prepared=True, starts=2)
    told = surae.expect(motion(), fit=fit, legs=5)
    assert told.noise == pytest.approx(NOISE, rel=0.4)
    for name in ("m", "tau_rel", "k_rel", "f0"):  # those that rest on no arm
        own = fit.parameters[name]
        half = max(own.ci95[1] - own.value, own.value - own.ci95[0]) / own.value
        assert told.parameters[name].now == pytest.approx(half, rel=0.01)
        # a trial as this one comes to what it knows already
        assert told.parameters[name].half_width == pytest.approx(half / 2.0**0.5, rel=0.6)
        assert told.parameters[name].half_width < half


@pytest.mark.parametrize(
    ("text", "complaint"),
    [
        ("time_s,angle_rad\n0,0\n", "no column emg_ta"),
        ("time_s,angle_rad,emg_ta,emg_gl,emg_sol,emg_gm\n" + "0,x,0,0,0,0\n" * 20, "numbers"),
        ("time_s,angle_rad,emg_ta,emg_gl,emg_sol,emg_gm\n" + "0,0,0,0,0,0\n" * 20, "equal steps"),
        (
            "time_s,angle_rad,emg_ta,emg_gl,emg_sol,emg_gm\n"
            + "".join(f"{k},{k},0,0,0,0\n" for k in range(20)),
            "degrees",
        ),
        (
            "time_s,angle_rad,emg_ta,emg_gl,emg_sol,emg_gm\n"
            + "".join(f"{k},0,50,0,0,0\n" for k in range(20)),
            "from 0 to 1",
        ),
    ],
)
def test_what_is_no_protocol_is_refused(tmp_path, text, complaint) -> None:
    (tmp_path / "p.csv").write_text(text)
    with pytest.raises(InputError, match=complaint):
        surae.expect(tmp_path / "p.csv")


@pytest.mark.parametrize(
    "change",
    [
        {"noise": 0.0},
        {"noise": 5e-324},
        {"legs": 0},
        {"population": "other"},
        {"model": "muscle-2010"},
    ],
)
def test_impossible_questions_are_refused(change) -> None:
    with pytest.raises(InputError):
        surae.expect(motion(), **change)
