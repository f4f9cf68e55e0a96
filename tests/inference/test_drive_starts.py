"""A freed drive never makes a fit worse, and its best minimum is found from every start."""

from dataclasses import replace

import numpy as np
import pytest

from surae.inference import fit_problem, make_problem
from surae.inference.least_squares.drive_starts import delay_valleys, drives_off, held_off
from surae.inference.least_squares.residuals import Residuals
from surae.model import ModelOptions, get_model
from surae.protocol import Protocol, generate
from surae.recording import read
from surae.signals import ModelInputs, prepare
from surae.studies import virtual_subject, virtual_trial

RATE, EMD = 125, 0.06


def holds(emd: float, noise: float = 0.05) -> ModelInputs:
    """Multiple holds with a chirp, simulated at 1000 Hz with EMG shifted by whole samples."""
    subject, spec, options = virtual_subject(3), get_model("muscle"), ModelOptions()
    protocol = Protocol(
        profile="multiple-holds", chirp_amplitude=0.2, chirp_rate=0.5, rate_hz=1000.0
    )
    fine = virtual_trial(subject, generate(protocol), noise=0.0)
    shift = round(1e3 * emd)
    late = np.concatenate([np.repeat(fine.emg[:1], shift, axis=0), fine.emg])[: fine.n]
    p = spec.vector(dict(subject.truth("muscle", options)), options)
    every = slice(None, None, 1000 // RATE)
    torque = spec.simulator(replace(fine, emg=late), options).torque(p)[every]
    error = noise * np.abs(torque).mean() * np.random.default_rng(3).standard_normal(len(torque))
    sampled = {
        name: np.ascontiguousarray(getattr(fine, name)[every])
        for name in ("time", "angle", "velocity", "acceleration", "emg")
    }
    return replace(fine, rate_hz=float(RATE), torque=torque + error, **sampled)


@pytest.fixture(scope="module")
def late() -> ModelInputs:
    return holds(EMD)


@pytest.mark.slow
def test_a_delay_is_found_from_all_starts(late) -> None:
    result = fit_problem(make_problem([holds(EMD, noise=0.0)], free=["emd"]))
    assert len(result.solution.starts) == 8
    for start in result.solution.starts:
        assert start.values["emd"] == pytest.approx(EMD, abs=0.0008)
    noisy = fit_problem(make_problem([late], free=["emd"]))
    assert noisy.solution.agreeing == 8


@pytest.mark.parametrize(
    ("model", "free"),
    [
        ("muscle", ("emd",)),
        ("muscle", ("emd", "reflex")),
        pytest.param("muscle-2010", ("emd", "reflex"), marks=pytest.mark.slow),
        pytest.param("muscle-tendon", ("emd",), marks=pytest.mark.slow),
    ],
)
def test_a_freed_drive_never_ends_above_the_fit_without(late, model, free) -> None:
    without, freed = (
        fit_problem(make_problem([late], model, free=names), starts=2, seed=1)
        for names in ((), free)
    )
    assert freed.sse <= without.sse * (1 + 1e-9)


def test_nor_with_priors(late) -> None:
    priors = {"f0": (2.0, 0.05), "g3": (1e6, 0.1)}
    given = {"starts": 2, "noise": 2.0}
    problem = make_problem([late], priors=priors)
    freed = make_problem([late], priors=priors, free=["emd"])
    fits = [fit_problem(one, **given).solution for one in (problem, freed)]
    sums = [min(start.sse for start in fit.starts) for fit in fits]
    assert sums[1] <= sums[0] * (1 + 1e-9)


def test_each_start_but_for_its_drives_is_that_of_the_fit_without(late) -> None:
    without, freed = (
        fit_problem(make_problem([late], free=names), starts=3) for names in ((), ("emd", "reflex"))
    )
    for one, other in zip(without.solution.starts, freed.solution.starts, strict=True):
        assert one.initial.items() <= other.initial.items()


def test_the_problem_without_its_drives_is_the_ordinary_one(late) -> None:
    off = drives_off(make_problem([late], free=["emd", "reflex"]))
    plain = make_problem([late])
    assert off.spec is plain.spec
    assert off.free == plain.free
    np.testing.assert_array_equal(off.base, plain.base)
    np.testing.assert_array_equal(off.lower, plain.lower)


@pytest.mark.parametrize(
    ("given", "kept"),
    [
        (
            {"free": ["emd"], "fixed": {"reflex_tri": 500.0}},
            {"reflex_tri": 500.0, "reflex_tib": 0.0, "reflex_delay": 0.05},
        ),
        ({"free": ["reflex_tri", "reflex_delay"], "fixed": {"reflex_tib": 0.0}}, {}),
        ({"free": ["reflex"], "fixed": {"emd": 0.04}}, {"emd": 0.04}),
        ({"free": ["emd"], "bounds": {"emd": (0.01, 0.1)}, "start": {"emd": 0.05}}, {"emd": 0.01}),
        (
            {
                "free": ["reflex_delay"],
                "fixed": {"reflex_tri": 500.0},
                "start": {"reflex_delay": 0.07},
            },
            {"reflex_tri": 500.0, "reflex_tib": 0.0, "reflex_delay": 0.07},
        ),
    ],
)
def test_what_is_fixed_or_cannot_be_off_stays(late, given, kept) -> None:
    problem = make_problem([late], **given)
    off = drives_off(problem)
    values = dict(zip(off.spec.names, off.base.tolist(), strict=True))
    assert {name: values[name] for name in off.spec.optional} == kept
    assert not set(off.free) & set(off.spec.optional)
    x = held_off(problem, off.start)
    np.testing.assert_allclose(
        problem.spec.simulator(late, problem.options).torque(problem.values(x)),
        off.spec.simulator(late, off.options).torque(off.base),
        rtol=1e-9,
        atol=1e-9,
    )


def test_delays_are_tried_where_bounds_and_start_say(late) -> None:
    def tried(**given) -> list[float]:
        problem = make_problem([late], free=["emd"], **given)
        x = held_off(problem, drives_off(problem).start)
        points = delay_valleys(problem, Residuals(problem).data_rows, x)
        return [float(one[-1]) for one in points]

    assert tried() == [0.0, 0.06, 0.09]
    assert tried(start={"emd": 0.03}) == [0.0, 0.03, 0.06, 0.09]
    assert tried(bounds={"emd": (0.0, 0.08)}) == [0.0, 0.06]
    assert tried(fixed={"f0": 2.0}) == [0.0, 0.06, 0.09]


@pytest.mark.parametrize("free", [("emd",), ("reflex",)])
def test_whoever_follows_is_told_the_end(late, free) -> None:
    told = []
    problem = make_problem([late], free=free)
    followed = fit_problem(problem, starts=1, follow=lambda *point: told.append(point))
    spec, values, sse = told[-1]
    assert spec is problem.spec
    assert dict(zip(spec.names, values.tolist(), strict=True)) == followed.values
    assert sse == pytest.approx(followed.sse)
    assert followed.values == fit_problem(problem, starts=1).values


def test_with_drives_alone_to_estimate(late) -> None:
    truth = dict(virtual_subject(3).truth("muscle", ModelOptions()))
    result = fit_problem(make_problem([late], free=["emd"], fixed=truth), starts=2)
    assert result.values["emd"] == pytest.approx(EMD, abs=0.003)
    assert result.solution.agreeing == 2


@pytest.mark.slow
@pytest.mark.parametrize("trial", ["walk36", "run81"])
def test_a_delay_makes_no_measured_trial_worse(shared, trial) -> None:
    inputs = prepare(read(shared / "gait" / f"{trial}.toml"))
    starts = 8 if trial == "walk36" else 3
    without, freed = (
        fit_problem(make_problem([inputs], free=names), starts=starts) for names in ((), ("emd",))
    )
    assert freed.sse <= without.sse * (1 + 1e-9)
    if trial == "walk36":  # of its two valleys every start finds the lower one
        assert freed.solution.agreeing == len(freed.solution.starts) == 8


@pytest.mark.parametrize("model", ["muscle", "muscle-tendon"])
@pytest.mark.parametrize("after", [2, 20, 45])
def test_an_interruption_keeps_the_best_so_far(late, monkeypatch, model, after) -> None:
    # After so many evaluations: without the drives, and on the way with them.
    count, evaluate = 0, Residuals.data_rows

    def interrupted(self: Residuals, x: np.ndarray, *wanted: object) -> np.ndarray:
        nonlocal count
        count += 1
        if count == after:
            raise KeyboardInterrupt
        return evaluate(self, x, *wanted)

    problem = make_problem([late], model, free=["emd"])
    monkeypatch.setattr(Residuals, "data_rows", interrupted)
    result = fit_problem(problem, starts=2)
    assert "stopped by the user in start 1 of 2" in result.message
    assert np.isfinite(result.sse)
