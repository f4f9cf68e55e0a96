"""Delay and reflex in a fit: asked for by name, found off the sample grid, honest intervals."""

from dataclasses import replace

import numpy as np
import pytest

from promises import arms_known
from surae.base.errors import InputError
from surae.inference import assess, fit_problem, make_problem
from surae.inference.least_squares.residuals import Residuals
from surae.inference.least_squares.separable import solve_linear
from surae.model import ModelOptions, get_model
from surae.model.geometry import paths
from surae.protocol import Protocol, generate
from surae.signals import ModelInputs
from surae.studies import virtual_subject, virtual_trial

OPTIONS = ModelOptions()
#: The truth is simulated at the first rate [Hz], by the models without drives, and sampled at the
#: second: a delay of whole milliseconds lies off the grid of what is fitted.
FINE, COARSE = 1000, 125
OFF = {"emd": 0.0, "reflex_tri": 0.0, "reflex_tib": 0.0, "reflex_delay": 0.05}
REFLEX = {"reflex_tri": 2e3, "reflex_tib": 1e3, "reflex_delay": 0.061}


def active(seed: int = 3) -> ModelInputs:
    protocol = Protocol(
        profile="multiple-holds", chirp_amplitude=0.2, chirp_rate=0.5, rate_hz=float(FINE)
    )
    return virtual_trial(virtual_subject(seed), generate(protocol), noise=0.0)


def stretches(peak: float = 4.0) -> ModelInputs:
    """Passive stretches of 0.85 rad both ways without EMG, a second of rest after each."""
    pieces = [np.full(FINE // 2, -0.5)]
    for start, end in ((-0.5, 0.35), (0.35, -0.5), (-0.5, 0.35), (0.35, -0.5)):
        s = np.arange(1, round(1.7 / peak * FINE) + 1) / round(1.7 / peak * FINE)
        pieces.append(start + (end - start) * (s - np.sin(2 * np.pi * s) / (2 * np.pi)))
        pieces.append(np.full(FINE, end))
    angle = np.concatenate(pieces)
    velocity = np.gradient(angle, 1 / FINE)
    return replace(
        active(),
        name="stretches",
        time=np.arange(len(angle)) / FINE,
        angle=angle,
        velocity=velocity,
        acceleration=np.gradient(velocity, 1 / FINE),
        emg=np.zeros((len(angle), 4)),
    )


def later(signal: np.ndarray, samples: int) -> np.ndarray:
    return np.concatenate([np.repeat(signal[:1], samples, axis=0), signal])[: len(signal)]


def recorded(
    fine: ModelInputs, model: str = "muscle", *, noise: float = 0.0, seed: int = 3, **drives: float
) -> ModelInputs:
    """What would be measured of subject `seed` with these drives."""
    truth = dict(virtual_subject(seed).truth(model, OPTIONS))
    given = OFF | drives
    tri, tib = paths(angle=fine.angle, velocity=fine.velocity, options=OPTIONS)
    emg = later(fine.emg, round(1e3 * given["emd"])).copy()
    for channel, weight, gain, path in ((2, "g3", "reflex_tri", tri), (0, "g1", "reflex_tib", tib)):
        late = later(np.maximum(path.speed, 0.0), round(1e3 * given["reflex_delay"]))
        emg[:, channel] += given[gain] / truth[weight] * late
    spec = get_model(model)
    every = slice(None, None, FINE // COARSE)
    simulator = spec.simulator(replace(fine, emg=emg), OPTIONS)
    torque = simulator.torque(spec.vector(truth, OPTIONS))[every]
    rng = np.random.default_rng(seed)
    sampled = {
        name: np.ascontiguousarray(getattr(fine, name)[every])
        for name in ("time", "angle", "velocity", "acceleration", "emg")
    }
    torque = torque + noise * np.abs(torque).mean() * rng.standard_normal(len(torque))
    return replace(fine, rate_hz=float(COARSE), torque=torque, **sampled)


def true_values(model: str = "muscle", seed: int = 3) -> dict[str, float]:
    return dict(virtual_subject(seed).truth(model, OPTIONS))


@pytest.mark.parametrize(
    ("given", "drives", "free"),
    [
        ({"free": ["emd"]}, ["emd"], ["emd"]),
        ({"fixed": {"emd": 0.05}}, ["emd"], []),
        ({"fixed": {"emd": 0.0}}, ["emd"], []),
        ({"free": ["reflex"]}, list(REFLEX), list(REFLEX)),
        ({"free": ["reflex_tri", "reflex_delay"]}, list(REFLEX), ["reflex_tri", "reflex_delay"]),
        (
            {"free": ["reflex"], "fixed": {"reflex_tib": 0.0}},
            list(REFLEX),
            ["reflex_tri", "reflex_delay"],
        ),
        ({"free": ["reflex", "emd"]}, ["emd", *REFLEX], ["emd", *REFLEX]),
        (
            {"free": ["emd"], "start": {"emd": 0.03}, "bounds": {"emd": (0.01, 0.1)}},
            ["emd"],
            ["emd"],
        ),
    ],
)
def test_drives_are_there_when_they_are_named(clean, given, drives, free):
    model = "muscle-tendon-strain"
    problem = make_problem([clean], model, **given)
    spec = get_model(model)
    assert problem.spec.names == (*spec.names, *drives)
    assert problem.free == (*spec.free, *free)
    values = dict(zip(problem.spec.names, problem.base.tolist(), strict=True))
    for name in drives:
        expected = {**given.get("fixed", {}), **given.get("start", {})}
        assert values[name] == expected.get(name, OFF[name])


@pytest.mark.parametrize(
    ("given", "says"),
    [
        ({"free": ["emd"], "fixed": {"emd": 0.1}}, "emd is both free and fixed"),
        ({"fixed": {"emd": -0.1}}, "emd is -0.1 s; it must be zero or more"),
        ({"free": ["reflex_delay"]}, "the reflex is off: free reflex_tri or reflex_tib too"),
        ({"free": ["reflex"], "fixed": {"reflex_tri": 0.0, "reflex_tib": 0.0}}, "reflex is off"),
        ({"free": ["reflexes"]}, "no parameter 'reflexes'"),
        ({"free": ["reflex"], "fixed": dict.fromkeys(REFLEX, 0.05)}, "no parameter 'reflex'"),
    ],
)
def test_refusals(clean, given, says):
    with pytest.raises(InputError) as caught:
        make_problem([clean], **given)
    assert says in str(caught.value)
    assert "\n" not in str(caught.value)


@pytest.mark.parametrize("emd", [0.011, 0.083])
def test_a_delay_is_found_off_the_grid(emd):
    # Sampled EMG at 125 Hz is not that of 1000 Hz: what is left is a tenth of a sample.
    result = fit_problem(make_problem([recorded(active(), emd=emd)], free=["emd"]), starts=1)
    assert result.values["emd"] == pytest.approx(emd, abs=0.0008)
    assert result.values["f0"] == pytest.approx(true_values()["f0"], rel=0.03)


def test_compliant_tendons_have_one_too():
    truth = true_values("muscle-tendon")
    trial = recorded(active(), "muscle-tendon", emd=0.037)
    problem = make_problem([trial], "muscle-tendon", free=["emd"], fixed={"beta": truth["beta"]})
    result = fit_problem(problem, starts=1)
    assert result.values["emd"] == pytest.approx(0.037, abs=0.002)


def test_the_sum_of_squares_is_smooth_over_the_delay():
    # Envelopes as rough as they come, which is where interpolation between samples would show.
    trial = recorded(active(), emd=0.037)
    rng = np.random.default_rng(0)
    rough = np.maximum(trial.emg * (1 + 0.5 * rng.standard_normal(trial.emg.shape)), 0.0)
    spec, truth = get_model("muscle"), true_values()
    p, dt = spec.vector(truth, OPTIONS), 1 / COARSE
    torque = spec.simulator(replace(trial, emg=rough), OPTIONS).torque(p)
    trial = replace(trial, emg=rough, torque=torque + rng.standard_normal(trial.n))
    problem = make_problem([trial], free=["emd"])
    rows = Residuals(problem).rows
    x = np.array([truth.get(name, 0.0) for name in problem.free])
    # Two samples in steps of a twentieth, across two points of the grid.
    delays = 0.037 + dt * np.linspace(-1.0, 1.0, 41)
    sums, slopes, others = [], [], []
    for delay in delays:
        x[-1] = delay
        found = rows(x)
        sums.append(found[-1] @ found[-1])
        slopes.append(2 * found[-2] @ found[-1])
        late = [np.interp(trial.time - delay, trial.time, one) for one in rough.T]
        simulator = spec.simulator(replace(trial, emg=np.stack(late, axis=1)), OPTIONS)
        others.append(np.sum((simulator.torque(p) - trial.torque) ** 2))
    step = delays[1] - delays[0]
    # The slope is the sum's own: Simpson's rule over it gives the sum back.
    middle = (np.array(sums[2:]) - sums[:-2]) / (2 * step)
    simpson = (np.array(slopes[:-2]) + 4 * np.array(slopes[1:-1]) + slopes[2:]) / 6
    np.testing.assert_allclose(middle, simpson, rtol=0, atol=2e-4 * np.abs(slopes).max())

    def jump(values):  # of the curvature from one step to the next, against its mean
        curvature = np.diff(values, 2)
        return np.abs(np.diff(curvature)).max() / curvature.mean()

    assert jump(sums) < 0.01
    assert jump(others) > 0.5  # EMG interpolated at the delayed instants, then filtered


def test_gains_are_solved_not_searched():
    trial = recorded(stretches(), **REFLEX)
    fixed = {n: v for n, v in true_values().items() if n not in ("m", "x0_tri", "x0_tib")}
    problem = make_problem([trial], free=["reflex"], fixed=fixed, start={"reflex_delay": 0.061})
    rows = Residuals(problem).data_rows
    solved, sse = solve_linear(problem, rows, problem.start)
    found = dict(zip(problem.free, solved.tolist(), strict=True))
    assert found["reflex_tri"] == pytest.approx(REFLEX["reflex_tri"], rel=0.01)
    assert found["reflex_tib"] == pytest.approx(REFLEX["reflex_tib"], rel=0.01)
    assert found["reflex_delay"] == 0.061
    left = rows(solved)[-1]
    assert sse == pytest.approx(left @ left, rel=1e-6)


@pytest.mark.parametrize("model", ["muscle", "muscle-tendon"])
def test_a_reflex_is_found_in_passive_stretches(model):
    known = ("g1", "g2", "g3", "g4", "l0_tri", "l0_tib", "f0", "beta")
    truth = true_values(model)
    trial = recorded(stretches(), model, noise=0.05, **REFLEX)
    problem = make_problem(
        [trial], model, free=["reflex"], fixed={name: truth[name] for name in known}
    )
    found = assess(fit_problem(problem, starts=2))
    for name, value in REFLEX.items():
        p = found.parameters[name]
        assert p.sem is not None
        assert abs(p.value - value) < 3.5 * p.sem + 0.01 * value, name
        assert p.repeatable
        assert (p.verdict.value == "identified") is (name == "reflex_delay")  # gains rest on arms


def test_without_a_reflex_its_gains_are_near_zero_and_its_delay_unknown():
    truth = true_values()
    known = ("g1", "g2", "g3", "g4", "l0_tri", "l0_tib", "f0", "beta")
    problem = make_problem(
        [recorded(stretches(), noise=0.05)],
        free=["reflex"],
        fixed={name: truth[name] for name in known},
    )
    found = assess(fit_problem(problem, starts=2))
    for name in ("reflex_tri", "reflex_tib"):
        p = found.parameters[name]
        assert p.value < 0.05 * REFLEX[name]
        assert p.verdict.value in ("undetermined", "at-bound")
    assert found.parameters["reflex_delay"].verdict.value in ("undetermined", "at-bound")


def test_the_delay_is_told_apart_from_the_filter_as_what_it_is():
    found = assess(
        fit_problem(make_problem([recorded(active(), noise=0.05, emd=0.037)], free=["emd"]))
    )
    names = found.covariance.names
    partner = found.covariance.correlation[names.index("emd"), names.index("f0")]
    assert partner > 0.9
    emd = found.parameters["emd"]
    assert emd.verdict.value == "weak"
    assert "f0" in emd.note


@pytest.mark.slow
def test_standard_errors_of_the_delay_hold_over_subjects():
    errors, covered = [], []
    for seed in range(30):
        emd = 1e-3 * float(np.random.default_rng([seed, 5]).integers(20, 101))
        trial = recorded(active(seed), noise=0.05, seed=seed, emd=emd)
        p = assess(fit_problem(make_problem([trial], free=["emd"]), starts=2)).parameters["emd"]
        assert p.trusted_sem is not None
        assert p.ci95 is not None
        errors.append((p.value - emd) / p.trusted_sem)
        covered.append(p.ci95[0] <= emd <= p.ci95[1])
    # Of 30: the root mean square of as many standard normals lies within these in 99.9 %.
    assert 0.6 < np.sqrt(np.mean(np.square(errors))) < 1.45
    assert np.mean(covered) >= 0.83


@pytest.mark.slow
def test_standard_errors_of_the_reflex_hold_over_subjects():
    known = ("g1", "g2", "g3", "g4", "l0_tri", "l0_tib", "f0", "beta")
    errors: dict[str, list[float]] = {name: [] for name in REFLEX}
    for seed in range(30):
        rng = np.random.default_rng([seed, 6])
        reflex = {
            "reflex_tri": rng.uniform(1e3, 4e3),
            "reflex_tib": rng.uniform(5e2, 2e3),
            "reflex_delay": 1e-3 * float(rng.integers(35, 91)),
        }
        trial = recorded(stretches(), noise=0.05, seed=seed, **reflex)
        truth = true_values(seed=seed)
        problem = make_problem(
            [trial], free=["reflex"], fixed={name: truth[name] for name in known}
        )
        with arms_known():  # a reflex per metre of muscle rests on them
            found = assess(fit_problem(problem, starts=2))
        for name, value in reflex.items():
            p = found.parameters[name]
            assert p.trusted_sem is not None
            errors[name].append((p.value - value) / p.trusted_sem)
    for name, own in errors.items():
        assert 0.6 < np.sqrt(np.mean(np.square(own))) < 1.45, name


def test_the_walking_trial_of_2010_gains_by_a_delay(shared):
    from surae.recording import read
    from surae.signals import prepare

    walk = prepare(read(shared / "gait" / "walk36.toml"))
    plain, late = (
        assess(fit_problem(make_problem([walk], "muscle-2010", free=free), starts=2))
        for free in ((), ("emd",))
    )
    assert late.vaf > plain.vaf + 0.5
    emd = late.parameters["emd"]
    assert emd.ci95 is not None
    assert 0.05 < emd.ci95[0] < emd.ci95[1] < 0.12
