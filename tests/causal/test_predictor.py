"""A fit's predictor: as `predict` gives it, at which cost, how sure, how fast; and when not."""

import subprocess
import time
from dataclasses import replace

import numpy as np
import pytest
from made_signals import signals

from surae import InputError, example, fit, load
from surae.base.errors import ComputationError
from surae.causal.predictor import Predictor
from surae.cli import main
from surae.inference import Grade
from surae.studies import virtual_trial


@pytest.fixture(params=["fitted", "family"])
def any_fit(request):
    return request.getfixturevalue(request.param)


def test_it_is_what_predict_gives_of_the_same_signals(any_fit) -> None:
    p = any_fit.predictor(500)
    angle, emg = signals()
    made = p.run(angle, emg, np.ones(len(angle)))
    predicted = any_fit.predict(made.inputs)
    np.testing.assert_allclose(made.torque, predicted.torque, rtol=0.0, atol=1e-9)
    assert made.vaf == pytest.approx(predicted.vaf)
    steps = [p.step(a, e) for a, e in zip(angle[:300], emg[:300], strict=True)]
    np.testing.assert_array_equal(steps, made.torque[:300])
    assert sum(p.parts.values()) == pytest.approx(steps[-1])
    p.reset()
    assert p.step(angle[0], emg[0]) == steps[0]


def test_a_step_knows_nothing_of_what_comes(any_fit) -> None:
    p = any_fit.predictor(500)
    angle, emg = signals()
    other = angle.copy()
    other[1500:] += 0.1
    later = emg.copy()
    later[1500:] *= 2.0
    one, two = p.run(angle, emg).torque, p.run(other, later).torque
    np.testing.assert_array_equal(one[:1500], two[:1500])
    assert np.abs(one - two)[1500:].max() > 1.0


def test_it_says_what_causality_costs_and_what_is_at_its_mean(fitted, family) -> None:
    p = fitted.predictor(500)
    assert 0.0 < p.causality.cost < 3.0
    assert "look ahead" in repr(p)
    assert p.at_means == ()
    assert "at its mean" in family.predictor(500).account


def test_its_interval_holds_another_trial_of_the_leg(fitted, subject, slower) -> None:
    trial = virtual_trial(subject, slower, seed=7)
    p = fitted.predictor(trial.rate_hz)
    made = p.run(trial.angle, trial.emg, trial.torque)
    held = np.abs(trial.torque - made.torque) <= 1.96 * made.sd
    assert 0.90 <= held.mean() <= 1.0
    assert p.doubt.error < 0.2
    doubt = fitted.predict(trial).doubt
    assert doubt is not None
    ratio = made.sd.mean() / (doubt.half_width.mean() / 1.96)
    assert 0.8 < ratio < 1.5


def test_raw_emg_is_followed_at_its_own_rate() -> None:
    recording = example()
    of = fit(recording, "muscle", starts=1)
    p = of.predictor(2048)
    assert p.emg == "raw"
    made = p.follow(example(trial=2))
    assert made.vaf is not None
    assert made.vaf > of.predict(example(trial=2)).vaf - 1.0
    with pytest.raises(InputError, match="the predictor takes envelope"):
        of.predictor(2048, emg="envelope").follow(recording)


def test_a_fit_that_is_not_adequate_has_none_unless_it_is_asked_for(fitted) -> None:
    doubtful = replace(fitted.assessment.adequacy, grade=Grade.DOUBTFUL)
    other = replace(fitted, assessment=replace(fitted.assessment, adequacy=doubtful))
    with pytest.raises(InputError, match="even-if-doubtful"):
        other.predictor(500)
    assert isinstance(other.predictor(500, even_if_doubtful=True), Predictor)


@pytest.mark.parametrize(
    ("angle", "emg", "words"),
    [
        (float("nan"), [0.0] * 4, "not finite"),
        (0.0, [0.0, float("inf"), 0.0, 0.0], "not finite"),
        (0.0, [0.0] * 3, "four numbers"),
        (0.0, 1.0, "four numbers"),
    ],
)
def test_what_is_no_sample_is_refused_and_changes_nothing(fitted, angle, emg, words) -> None:
    p = fitted.predictor(500)
    p.step(0.1, [1e-4] * 4)
    before = p.step(0.1, [1e-4] * 4)
    other = fitted.predictor(500)
    other.step(0.1, [1e-4] * 4)
    with pytest.raises(InputError, match=words):
        other.step(angle, emg)
    assert other.step(0.1, [1e-4] * 4) == before


def test_a_wild_angle_is_a_failure_that_says_so(fitted) -> None:
    p = fitted.predictor(500)
    with pytest.raises(ComputationError, match="reset"):
        p.step(1e6, [1e-4] * 4)


def test_a_step_takes_microseconds(any_fit) -> None:
    """The figure is the median of 10 µs, on an idle computer; three times that on a busy one."""
    p = any_fit.predictor(1000)
    angle, emg = signals()
    taken = []
    for a, e in zip(angle, emg, strict=True):
        begun = time.perf_counter_ns()
        p.step(a, e)
        taken.append(time.perf_counter_ns() - begun)
    assert np.median(taken[100:]) < 30_000


@pytest.mark.parametrize("precision", ["double", "float"])
def test_the_c_file_gives_the_same_torque(any_fit, gcc, tmp_path, precision) -> None:
    """Compiled without a warning; its own test passes, and signals that it has not seen agree."""
    p = any_fit.predictor(500)
    source = p.to_c("leg", precision=precision)
    source.save(tmp_path)
    assert "malloc" not in source.c
    flags = ["-std=c99", "-Wall", "-Wextra", "-pedantic", "-Werror", "-O2"]
    call = [gcc, *flags, "-DSURAE_TEST", "leg.c", "-lm", "-o", "test"]
    subprocess.run(call, cwd=tmp_path, check=True, timeout=120)
    done = subprocess.run(
        ["./test"], cwd=tmp_path, check=False, capture_output=True, text=True, timeout=120
    )
    assert done.returncode == 0, done.stdout
    angle, emg = signals()
    np.savetxt(tmp_path / "signals", np.column_stack([angle, emg]), fmt="%.17g")
    done = subprocess.run(
        ["./test", "signals"],
        cwd=tmp_path,
        check=False,
        capture_output=True,
        text=True,
        timeout=120,
    )
    torque, sd = np.array(done.stdout.split(), dtype=float).reshape(-1, 2).T
    made = p.run(angle, emg)
    allowed = 1e-9 if precision == "double" else 1e-4 * np.abs(made.torque).max()
    np.testing.assert_allclose(torque, made.torque, rtol=0.0, atol=allowed)
    np.testing.assert_allclose(sd, made.sd, rtol=0.0, atol=allowed)


def test_names_and_precisions_of_c_are_checked(fitted) -> None:
    p = fitted.predictor(500)
    with pytest.raises(InputError, match="no name in C"):
        p.to_c("2legs")
    with pytest.raises(InputError, match="precision"):
        p.to_c(precision="half")


def test_the_command_writes_it(fitted, tmp_path, monkeypatch, capsys) -> None:
    def run(*arguments: str) -> int:
        monkeypatch.setattr("sys.argv", ["surae", *arguments])
        with pytest.raises(SystemExit) as ended:
            main()
        return int(ended.value.code or 0)

    path = tmp_path / "fit.json"
    fitted.save(path)
    again = load(path).predictor(500)
    assert run("export", str(path), "--to", "predictor", "--rate", "500") == 0
    assert (tmp_path / "fit.c").read_text() == again.to_c("fit").c
    assert "surae_step" in (tmp_path / "fit.h").read_text()
    assert "variance" in capsys.readouterr().out
    assert run("export", str(path), "--to", "osim", "--rate", "500") == 2
    assert "--rate has no effect" in capsys.readouterr().err
