"""Whole fits: the truth from clean trials, joint fits, seeds, interruption, status and advice."""

from dataclasses import fields, replace

import numpy as np
import pytest

from surae.base.errors import InputError
from surae.inference import assess, fit_problem, make_problem
from surae.inference.least_squares.residuals import Residuals
from surae.inference.result import is_at_bound
from surae.protocol import Protocol, generate, named_device
from surae.signals.resample import thinning_factor
from surae.studies import virtual_subject, virtual_trial


def assert_truth(result, truth, rtol=1e-5):
    for name, value in truth.items():
        assert result.values[name] == pytest.approx(value, rel=rtol), name


@pytest.mark.parametrize("seed", [0, 3])
def test_a_clean_trial_gives_the_truth(seed, trajectory):
    subject = virtual_subject(seed)
    result = fit_problem(make_problem([virtual_trial(subject, trajectory, noise=0.0)]), starts=1)
    assert result.status == "converged"
    assert_truth(result, subject.parameters)
    assert assess(result).vaf == pytest.approx(100.0, abs=1e-9)


def test_random_starts_find_the_truth(clean, subject):
    # Without the default start: the scan and the projection have to do it.
    problem = make_problem([clean])
    rng = np.random.default_rng(1)
    far = {
        name: float(low + (high - low) * rng.uniform(0.05, 0.95))
        for name, low, high in zip(problem.free, problem.lower, problem.upper, strict=True)
    }
    result = fit_problem(make_problem([clean], start=far), starts=4, seed=1)
    assert_truth(result, subject.parameters)


def test_all_linear_parameters_fixed(clean, subject):
    linear = ("m", "g1", "g2", "g3", "g4", "x0_tri", "x0_tib")
    fixed = {name: subject.parameters[name] for name in linear}
    result = fit_problem(make_problem([clean], fixed=fixed), starts=2)
    assert_truth(result, subject.parameters)


def test_what_the_result_says_belongs_together(noisy):
    result = fit_problem(make_problem([noisy]), starts=2)
    problem = result.problem
    x = np.array([result.values[name] for name in problem.free])
    rows = Residuals(problem).rows(x)
    np.testing.assert_allclose(result.residuals[0], -rows[-1], atol=1e-10)
    assert result.sse == pytest.approx(float(rows[-1] @ rows[-1]), rel=1e-12)
    np.testing.assert_allclose(result.R.T @ result.R, rows[:-1] @ rows[:-1].T, rtol=1e-6, atol=1e-9)
    assert len(result.solution.starts) == 2
    assert result.sse == pytest.approx(min(s.sse for s in result.solution.starts), rel=1e-12)
    assert tuple(result.solution.starts[0].initial.values()) == tuple(problem.start.tolist())
    assert result.seconds > 0
    assert "surae" in result.versions


def test_it_says_how_it_was_found(noisy, monkeypatch):
    calls, own = [], Residuals.data_rows

    def counted(self, x, wanted=None):
        calls.append(len(self._measured[0]))
        return own(self, x, wanted)

    monkeypatch.setattr(Residuals, "data_rows", counted)
    result = fit_problem(make_problem([noisy], "muscle-tendon"), starts=2)
    solution = result.solution
    assert solution.evaluations == len(calls) > sum(start.iterations for start in solution.starts)
    assert {stage.name.split()[0] for stage in solution.stages} == {"muscle", "muscle-tendon"}
    assert {noisy.n, *calls} == {*calls}
    assert min(stage.cost for stage in solution.stages) <= result.sse * (1 + 1e-9)
    assert (solution.outcome, solution.is_interrupted) == ("converged", False)
    assert not result.R.flags.writeable
    assert not result.residuals[0].flags.writeable


def test_twice_the_same_recording_halves_the_variance(noisy):
    once = fit_problem(make_problem([noisy]), starts=1)
    twice = fit_problem(make_problem([noisy, noisy]), starts=1)
    one, two = assess(once), assess(twice)
    dof = (noisy.n - 15) / (noisy.n - 7.5)  # σ² = 2·sse/(2n − p)
    for name, p in one.parameters.items():
        q = two.parameters[name]
        assert q.value == pytest.approx(p.value, abs=0.2 * p.sem), name
        assert q.sem == pytest.approx(p.sem * np.sqrt(dof / 2), rel=0.03), name
    assert two.vaf == pytest.approx(one.vaf, abs=1e-4)
    np.testing.assert_array_equal(twice.residuals[0], twice.residuals[1])


def test_recordings_of_different_rates_and_lengths(subject, trajectory):
    slow = generate(Protocol(profile="sine", chirp_amplitude=0.1, rate_hz=64.0))
    trials = [
        virtual_trial(subject, trajectory, noise=0.0),
        virtual_trial(subject, slow, noise=0.0),
    ]
    result = fit_problem(make_problem(trials), starts=1)
    assert_truth(result, subject.parameters)
    assert [len(r) for r in result.residuals] == [one.n for one in trials]


def assert_same_bits(one, other):
    for field in fields(one):
        if field.name in ("seconds", "problem", "versions"):
            continue
        a, b = getattr(one, field.name), getattr(other, field.name)
        if field.name == "residuals":
            for x, y in zip(a, b, strict=True):
                np.testing.assert_array_equal(x, y)
        elif field.name == "R":
            np.testing.assert_array_equal(a, b)
        else:
            assert a == b, field.name


def test_the_same_seed_gives_the_same_bits(noisy):
    problem = make_problem([noisy])
    once, again = (fit_problem(problem, starts=3, seed=7) for _ in range(2))
    assert_same_bits(once, again)
    other = fit_problem(problem, starts=3, seed=8)
    assert other.solution.starts[0] == once.solution.starts[0]
    assert other.solution.starts[1].initial != once.solution.starts[1].initial


def test_more_starts_keep_the_first_ones(noisy):
    problem = make_problem([noisy])
    few, many = (fit_problem(problem, starts=n, seed=1) for n in (2, 4))
    assert many.solution.starts[:2] == few.solution.starts


def test_six_starts_stay_within_the_bounds_and_most_agree(noisy):
    result = fit_problem(make_problem([noisy]), starts=6)
    problem = result.problem
    for start in result.solution.starts:
        for values in (start.initial, start.values):
            x = np.array(list(values.values()))
            assert np.all((x >= problem.lower) & (x <= problem.upper))

    # Within one variance of the noise: no data could tell them apart.
    sigma2 = result.sse / (noisy.n - 15)
    solution = result.solution
    assert solution.agreeing == sum(s.sse <= result.sse + sigma2 for s in solution.starts)
    assert solution.agreeing >= 4
    assert f"{solution.agreeing} of 6 starts reach the best minimum" in result.message


def test_a_valley_on_the_way_is_not_where_a_start_ends():
    """The default start loses the passive tibialis: others passed by there and were ended."""
    motion = generate(
        Protocol(
            profile="multi-sine-holds",
            chirp_amplitude=0.1,
            duration=35.0,
            rate_hz=64.0,
            device=named_device("achilles"),
        )
    )
    trial = virtual_trial(virtual_subject(118), motion, noise=0.0)
    noise = 0.5 * np.random.default_rng(118).standard_normal(trial.n)
    noisy = replace(trial, torque=trial.torque + noise)
    truth = virtual_subject(118).parameters
    best = fit_problem(make_problem([noisy], start=dict(truth)), starts=1)
    found = fit_problem(make_problem([noisy]), starts=10)
    assert found.sse == pytest.approx(best.sse, rel=1e-4)
    assert found.solution.starts[0].sse > 1.01 * best.sse
    assert found.solution.agreeing >= 5


def test_too_few_starts(noisy):
    with pytest.raises(InputError, match="give at least 1"):
        fit_problem(make_problem([noisy]), starts=0)


def test_progress_is_told_after_every_start(noisy):
    seen = []
    result = fit_problem(
        make_problem([noisy]), starts=3, progress=lambda *given: seen.append(given)
    )
    assert [given[:2] for given in seen] == [(1, 3), (2, 3), (3, 3)]
    assert [given[2] for given in seen] == [
        min(s.sse for s in result.solution.starts[: i + 1]) for i in range(3)
    ]


def interrupting(monkeypatch, call):
    """Press Ctrl-C in evaluation number `call`; gives the sums seen before."""
    original, sums = Residuals.data_rows, []

    def rows(self, x, *wanted):
        if len(sums) + 1 == call:
            sums.append(np.inf)
            raise KeyboardInterrupt
        out = original(self, x, *wanted)
        sums.append(float(out[-1] @ out[-1]))
        return out

    monkeypatch.setattr(Residuals, "data_rows", rows)
    return sums


@pytest.mark.parametrize("call", [2, 8])
def test_interrupted_within_the_first_start(call, noisy, monkeypatch):
    sums = interrupting(monkeypatch, call)
    result = fit_problem(make_problem([noisy]), starts=4)
    assert result.status == "failed"
    assert "interrupted" in result.message
    assert "stopped by the user in start 1 of 4" in result.message
    assert len(result.solution.starts) == 1
    assert result.sse <= min(sums[1:call]) * (1 + 1e-12)


def test_interrupted_in_the_very_first_evaluation(noisy, monkeypatch):
    interrupting(monkeypatch, 1)
    result = fit_problem(make_problem([noisy]), starts=4)
    assert result.status == "failed"
    assert np.isfinite(result.sse)


def test_interrupted_in_a_later_start_keeps_the_best(noisy, monkeypatch):
    whole = fit_problem(make_problem([noisy]), starts=1)
    calls = whole.solution.starts[0].iterations
    # Within the scan of the second start, and later within its iteration.
    for later in (8, 20):
        with monkeypatch.context() as patched:
            interrupting(patched, calls + later)
            result = fit_problem(make_problem([noisy]), starts=4)
        assert result.sse == whole.sse
        assert result.values == whole.values
        assert result.status == whole.status
        assert "stopped by the user in start 2 of 4" in result.message
        assert len(result.solution.starts) == 2


@pytest.mark.parametrize("after", [1, 2])
def test_interrupted_between_starts(after, noisy):
    def progress(done, starts, best):
        if done == after:
            raise KeyboardInterrupt

    result = fit_problem(make_problem([noisy]), starts=2, progress=progress)
    whole = fit_problem(make_problem([noisy]), starts=after)
    assert result.sse == whole.sse
    assert result.status == whole.status
    assert result.solution.starts == whole.solution.starts
    assert ("stopped by the user after start 1 of 2" in result.message) == (after == 1)
    assert ("stopped" in result.message) == (after == 1)


def test_at_bounds_names_the_parameters(noisy):
    result = fit_problem(make_problem([noisy], bounds={"m": (2.9, 3.0)}), starts=1)
    assert result.status == "at-bounds"
    assert "m" in result.at_bound
    assert "at a bound: m" in result.message
    assert result.values["m"] == 2.9


@pytest.mark.parametrize(
    ("value", "expected"),
    [(1.0, True), (1.0 + 9e-7, True), (1.0 + 2e-6, False), (1.5, False), (2.0, True)],
)
def test_at_a_bound_is_a_millionth_of_the_range(value, expected):
    assert is_at_bound(value, 1.0, 2.0) is expected


def test_one_start_that_overflows_among_others(clean, subject):
    # Only the default start is out of reach of the numbers.
    problem = make_problem(
        [clean],
        fixed={"x0_tri": subject.parameters["x0_tri"]},
        start={"k_tri": 1e6},
        bounds={"k_tri": (20.0, 1e6)},
    )
    result = fit_problem(problem, starts=1)
    assert result.status == "failed"
    narrow = make_problem([clean], fixed={"x0_tri": subject.parameters["x0_tri"]})
    result = fit_problem(replace(problem, upper=narrow.upper), starts=4)
    assert result.status == "converged"
    assert_truth(result, subject.parameters)


def test_a_lone_best_minimum_is_told(noisy, monkeypatch):
    # The second start is stopped at once: the best minimum was reached a single time.
    calls = fit_problem(make_problem([noisy]), starts=1).solution.starts[0].iterations
    interrupting(monkeypatch, calls + 2)
    result = fit_problem(make_problem([noisy]), starts=2)
    assert result.solution.agreeing == 1
    assert "1 of 2 starts reach the best minimum: it may not be the global one" in result.message


def test_a_muscle_tendon_fit_gives_the_truth(trajectory, subject):
    trial = virtual_trial(subject, trajectory, model="muscle-tendon", noise=0.0)
    result = fit_problem(make_problem([trial], "muscle-tendon"), starts=1)
    assert result.status == "converged"
    assert_truth(result, subject.parameters, rtol=1e-4)


def test_weights_between_the_samples_that_thinning_keeps(trajectory, subject):
    trial = virtual_trial(subject, trajectory, model="muscle-tendon", noise=0.0)
    factor = thinning_factor(trial, 60.0, 500)
    assert factor > 1
    weight = np.ones(trial.n)
    weight[factor // 2 :: factor] = 0.0
    others = {name: subject.parameters[name] for name in subject.parameters if name != "f0"}
    problem = make_problem([replace(trial, weight=weight)], "muscle-tendon", fixed=others)
    result = fit_problem(problem, starts=1)
    assert result.values["f0"] == pytest.approx(subject.parameters["f0"], rel=1e-4)


def test_interrupted_before_the_priors(noisy, monkeypatch):
    interrupting(monkeypatch, 4)
    result = fit_problem(make_problem([noisy], priors={"tau_rel": (3.0, 0.2)}), starts=3)
    assert result.status == "failed"
    assert result.message.endswith("before the priors")
    assert dict(result.problem.priors)
