import json
import math
from dataclasses import replace

import numpy as np
import pytest

from surae.assessment import TendonEvidence
from surae.assessment.comparison import compare as comparing
from surae.assessment.comparison.compare import COMPARED, FEW_STARTS
from surae.assessment.comparison.held_out import prediction_error
from surae.errors import InputError
from surae.estimation import FitSettings, fit_problem, make_problem, solve
from surae.model import ModelOptions
from surae.protocol import Protocol, generate
from surae.signals import Weighting
from surae.studies import virtual_subject, virtual_trial

OPTIONS = ModelOptions(tendon_strain="slack-length")


def compare_models(inputs, models=COMPARED, progress=None, **asked):
    settings = FitSettings.of(FitSettings(starts=FEW_STARTS), **asked)
    return comparing.compare_models(inputs, models, settings, progress)


def trial(model: str, seed: int = 1, profile: str = "multiple-holds", noise_seed: int = 0,
          rate_hz: float = 64.0):  # fmt: skip
    settings = Protocol(profile=profile, chirp_amplitude=0.2, chirp_rate=0.5, rate_hz=rate_hz)
    return virtual_trial(
        virtual_subject(seed), generate(settings), model=model, options=OPTIONS, seed=noise_seed
    )


@pytest.fixture(scope="module")
def rigid():
    return compare_models([trial("muscle")], options=OPTIONS, starts=1)


@pytest.fixture(scope="module")
def compliant():
    return compare_models([trial("muscle-tendon")], options=OPTIONS, starts=1)


def test_a_rigid_subject(rigid) -> None:
    assert rigid.finding is TendonEvidence.RIGID
    assert rigid.scores["muscle"].delta == 0
    assert rigid.scores["muscle-tendon"].delta > 100
    assert rigid.scores["muscle-tendon"].held_out.gain < 0


def test_a_compliant_subject(compliant) -> None:
    assert compliant.finding is TendonEvidence.COMPLIANT
    assert "Compliance is supported" in compliant.conclusion
    assert compliant.scores["muscle"].delta > 100
    assert compliant.compliant is compliant.scores[compliant.compliant.model]
    assert compliant.compliant.delta == 0


def test_the_figures_are_those_of_the_fits(compliant) -> None:
    assert tuple(compliant.scores) == COMPARED
    inputs = trial("muscle-tendon")
    found = fit_problem(make_problem([inputs], "muscle", options=OPTIONS), starts=1)
    score = compliant.scores["muscle"]
    assert dict(score.values) == dict(found.values)
    assert score.n_free == 15
    assert score.rmse == pytest.approx(math.sqrt(found.sse / inputs.n))
    n = inputs.n
    plain = n * math.log(found.sse / n) + 32 + 2 * 16 * 17 / (n - 17)
    assert score.aicc_plain == pytest.approx(plain)
    assert compliant.n == n
    assert 0.5 * n < compliant.n_effective <= n
    share = compliant.n_effective / n
    assert score.aicc == pytest.approx(share * n * math.log(found.sse / n) + 32, abs=1)
    assert [s.n_free for s in compliant.models] == [15, 15, 17, 17]


def test_held_out_vaf_is_worse_than_fitted(rigid, compliant) -> None:
    for truth, comparison in (("muscle", rigid), ("muscle-tendon", compliant)):
        score = comparison.scores[truth]
        assert score.vaf - 0.5 < score.held_out.vaf < score.vaf
        assert len(score.held_out.folds) == len(comparison.folds) == 4
    reference = compliant.scores["muscle"].held_out
    assert reference.gain == 0
    for score in compliant.models:
        assert score.held_out.gain == pytest.approx(score.held_out.vaf - reference.vaf)


def test_parameters_that_tendons_change(compliant) -> None:
    changes = [c for c in compliant.changes if c.model == "muscle-tendon"]
    truth = virtual_subject(1).parameters
    before, after = (compliant.scores[m].values for m in ("muscle", "muscle-tendon"))
    by_name = {c.parameter: c for c in changes}
    assert "l0_tri" in by_name
    for name, change in by_name.items():
        assert (change.rigid, change.compliant) == (before[name], after[name])
        assert abs(change.compliant - change.rigid) > change.half_width
        assert change.percent == pytest.approx(100 * (after[name] / before[name] - 1))
    assert abs(after["l0_tri"] / truth["l0_tri"] - 1) < abs(before["l0_tri"] / truth["l0_tri"] - 1)
    sizes = [abs(c.percent) for c in compliant.changes if c.percent is not None]
    assert sizes == sorted(sizes, reverse=True)


def test_correlated_residuals_count_for_less() -> None:
    one = trial("muscle")
    rng = np.random.default_rng(5)
    slow = np.convolve(rng.standard_normal(one.n + 63), np.ones(64) / 8, mode="valid")
    found = compare_models(
        [replace(one, torque=one.torque + slow)], ["muscle", "muscle-tendon"], options=OPTIONS,
        starts=1,
    )  # fmt: skip
    assert found.n_effective < 0.1 * found.n
    worse = found.scores["muscle-tendon"]
    assert worse.delta < 0.2 * worse.delta_plain


def test_several_recordings() -> None:
    inputs = [trial("muscle"), replace(trial("muscle", profile="ramp-and-hold"), name="second")]
    found = compare_models(inputs, ["muscle", "muscle-tendon"], options=OPTIONS, starts=1)
    assert found.folds == found.recordings == (inputs[0].name, "second")
    assert found.n == inputs[0].n + inputs[1].n
    assert found.finding is TendonEvidence.RIGID


def test_saved_and_read_again(compliant, tmp_path) -> None:
    compliant.save(tmp_path / "c.json")
    text = (tmp_path / "c.json").read_text(encoding="utf-8")
    again = json.loads(text, parse_constant=pytest.fail)
    assert again == json.loads(json.dumps(compliant.as_dict()))
    assert again["finding"] == "compliance-supported"
    assert again["models"][0]["values"] == dict(compliant.scores["muscle"].values)
    assert again["models"][0]["held_out"]["folds"] == list(
        compliant.scores["muscle"].held_out.folds
    )
    assert again["n_effective"] == compliant.n_effective


def test_the_same_seed_gives_the_same() -> None:
    one = trial("muscle", rate_hz=40.0)

    def again():
        found = compare_models(
            [one], ["muscle", "muscle-tendon"], options=OPTIONS, starts=2, seed=4
        )
        return replace(found, seconds=0.0)

    assert again() == again()


def test_fixed_parameters_are_fixed_where_a_model_has_them() -> None:
    found = compare_models(
        [trial("muscle-tendon", rate_hz=40.0)],
        ["muscle", "muscle-tendon-strain"],
        fixed={"beta": 1.0, "dlt_tib": 0.035},
        options=OPTIONS,
        starts=1,
    )
    assert [s.n_free for s in found.models] == [14, 15]
    assert all(s.values["beta"] == 1 for s in found.models)
    assert found.scores["muscle-tendon-strain"].values["dlt_tib"] == 0.035


@pytest.mark.parametrize(
    ("models", "fixed", "says"),
    [
        (["muscle"], {}, "without tendons and one with"),
        (["muscle-tendon", "muscle-tendon-toe"], {}, "without tendons and one with"),
        (["muscle", "muscle-tendon", "muscle"], {}, "'muscle' is given twice"),
        (["muscle", "elastic"], {}, "unknown model 'elastic'"),
        (["muscle", "muscle-tendon"], {"k": 1.0}, "none of the models has a parameter 'k'"),
    ],
)
def test_what_cannot_be_compared(models, fixed, says) -> None:
    with pytest.raises(InputError, match=says):
        compare_models([trial("muscle")], models, fixed=fixed)


def stopping_after(fits: int):
    def told(what: str, done: int, total: int) -> None:
        if done == fits:
            raise KeyboardInterrupt

    return told


def test_stopped_between_the_folds() -> None:
    found = compare_models(
        [trial("muscle-tendon", rate_hz=40.0)],
        ["muscle", "muscle-tendon"], options=OPTIONS, starts=1,
        progress=stopping_after(7),
    )  # fmt: skip
    assert found.finding is None
    assert [name.partition(" (")[0] for name in found.missing] == [
        "muscle-tendon without block 2 of 4",
        "muscle-tendon without block 3 of 4",
        "muscle-tendon without block 4 of 4",
    ]
    assert "muscle-tendon without block 2" in found.conclusion
    assert found.scores["muscle"].held_out is not None
    rest = found.scores["muscle-tendon"]
    assert (rest.held_out, rest.held_out_note) == (None, "stopped by the user")
    assert rest.delta == 0


def test_stopped_within_the_fits_to_all_data() -> None:
    found = compare_models(
        [trial("muscle", rate_hz=40.0)], options=OPTIONS, starts=1, progress=stopping_after(1)
    )
    assert list(found.scores) == ["muscle"]
    assert found.missing[:3] == COMPARED[1:]
    assert found.changes == ()


def test_stopped_before_anything_is_known() -> None:
    with pytest.raises(KeyboardInterrupt):
        compare_models([trial("muscle")], options=OPTIONS, progress=stopping_after(0))


def test_stopped_within_a_fit(monkeypatch) -> None:
    """A fit that was stopped and kept its best so far is no result to compare."""
    real, calls = solve, []

    def stopped(problem, *, starts):
        found = real(problem, starts=starts)
        calls.append(problem)
        if len(calls) < 3:
            return found
        last = replace(found.starts[-1], outcome="interrupted")
        return replace(found, status="failed", starts=(*found.starts[:-1], last))

    monkeypatch.setattr("surae.assessment.comparison.compare.solve", stopped)
    found = compare_models([trial("muscle", rate_hz=40.0)], ["muscle", "muscle-tendon"], starts=1)
    assert len(calls) == 3
    assert len(found.missing) == 8


def test_a_prediction_that_overflows(monkeypatch) -> None:
    def far(found, fold):
        error = prediction_error(found, fold)
        return error if found.problem.spec.name == "muscle" else np.full_like(error, 1e200)

    monkeypatch.setattr("surae.assessment.comparison.compare.prediction_error", far)
    found = compare_models(
        [trial("muscle-tendon", rate_hz=40.0)],
        ["muscle", "muscle-tendon"],
        options=OPTIONS,
        starts=1,
    )
    assert found.finding is TendonEvidence.OPEN
    assert "could not be predicted (a prediction overflows" in found.conclusion
    assert found.scores["muscle"].held_out is not None


def test_every_fit_is_announced() -> None:
    told: list[tuple[str, int, int]] = []
    compare_models(
        [trial("muscle", rate_hz=40.0)], ["muscle", "muscle-tendon"], options=OPTIONS, starts=1,
        progress=lambda *what: told.append(what),
    )  # fmt: skip
    assert [done for _, done, _ in told] == list(range(10))
    assert {total for _, _, total in told} == {10}
    assert [what for what, _, _ in told[:2]] == ["muscle", "muscle-tendon"]


@pytest.mark.slow
@pytest.mark.parametrize(
    ("truth", "expected"),
    [("muscle", TendonEvidence.RIGID), ("muscle-tendon", TendonEvidence.COMPLIANT)],
)
def test_error_rates_over_virtual_subjects(truth, expected) -> None:
    """No subject is judged the opposite of what it is, and hardly one is left open."""
    wrong = {TendonEvidence.RIGID, TendonEvidence.COMPLIANT} - {expected}
    profiles = ("multiple-holds", "multi-sine-holds", "ramp-and-hold", "multi-sine")
    found = []
    for seed in range(20):
        settings = Protocol(
            profile=profiles[seed % 4], chirp_amplitude=0.2, chirp_rate=0.5, rate_hz=125.0
        )
        subject = virtual_subject(seed, ("healthy", "patient")[seed % 2])
        one = virtual_trial(subject, generate(settings), model=truth, options=OPTIONS)
        found.append(compare_models([one], options=OPTIONS, starts=1).finding)
    assert not wrong & set(found)
    assert found.count(expected) >= 18


@pytest.mark.slow
def test_everything_that_is_asked_reaches_every_fit() -> None:
    """Freed parameters, bounds, starts, priors, loss and weights; each model has its own share."""
    settings = FitSettings.of(
        free=("emd",),
        bounds={"dlt_tri": (0.02, 0.3), "m": (1.0, 4.0)},
        start={"beta": 1.1},
        priors={"tau_rel": (2.5, 0.5)},
        loss="huber",
        weights=Weighting(((0.0, 2.0, 0.0),)),
        starts=1,
        tendon_strain="slack-length",
    )
    inputs = settings.inputs([trial("muscle")])
    spoiled = inputs[0].torque.copy()
    spoiled[1000:1010] += 40.0
    inputs = [replace(inputs[0], torque=spoiled)]
    models = ["muscle", "muscle-tendon-strain"]
    comparison = comparing.compare_models(inputs, models, settings)
    for model in models:
        result = solve(make_problem(inputs, settings.for_model(model)))
        assert dict(comparison.scores[model].values) == dict(result.values)
        assert result.problem.priors.keys() == {"tau_rel"}
        assert result.outliers is not None
    assert [s.n_free for s in comparison.models] == [16, 18]
    assert comparison.n < trial("muscle").n
    assert any("AICc counts outliers" in said for said in comparison.cautions)
    assert comparison.finding is not TendonEvidence.COMPLIANT
    assert comparison.as_dict()["settings"] == settings.as_dict()
