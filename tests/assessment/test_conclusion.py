from dataclasses import replace

import pytest

from surae.assessment import Adequacy, Grade, TendonEvidence
from surae.assessment.comparison.conclusion import cautions, conclude
from surae.assessment.comparison.finding import ModelScore
from surae.assessment.comparison.held_out import HeldOut


def score(model: str, aicc: float | None, gain: float = 0.0, error: float = 0.1) -> ModelScore:
    return ModelScore(
        model=model,
        title=model,
        rigid=model == "muscle",
        status="failed" if aicc is None else "converged",
        message="no minimum reached",
        at_bound=(),
        n_free=15,
        vaf=99.0,
        rmse=1.0,
        aicc=aicc,
        aicc_plain=aicc,
        delta=0.0,
        delta_plain=0.0,
        held_out=HeldOut(99.0, 0.5, (99.0, 98.5), gain, error),
        held_out_note="",
        values={},
        adequacy=Adequacy(Grade.ADEQUATE, (), 99.0),
    )


RIGID = score("muscle", 1000.0)


@pytest.mark.parametrize(
    ("aicc", "gain", "finding"),
    [
        (989.0, 0.2, TendonEvidence.COMPLIANT),
        (991.0, 0.2, TendonEvidence.OPEN),  # not by enough
        (989.0, 0.05, TendonEvidence.OPEN),  # within the error
        (989.0, -0.5, TendonEvidence.OPEN),  # contradictory
        (999.0, 0.05, TendonEvidence.OPEN),  # no worse than rigid: the data do not see the tendon
        (1011.0, 0.05, TendonEvidence.RIGID),
        (1011.0, -0.5, TendonEvidence.RIGID),
        (1011.0, 0.2, TendonEvidence.OPEN),  # contradictory
        (1009.0, -0.5, TendonEvidence.OPEN),  # not worse by enough
    ],
)
def test_both_criteria_must_agree(aicc, gain, finding) -> None:
    found, text = conclude([RIGID, score("muscle-tendon", aicc, gain)])
    assert found is finding
    assert text.startswith(
        {
            TendonEvidence.COMPLIANT: "Compliance is supported: ",
            TendonEvidence.RIGID: "A rigid tendon suffices: ",
            TendonEvidence.OPEN: "The data cannot tell: ",
        }[finding]
    )
    assert f"{abs(1000 - aicc):.1f} {'lower' if aicc < 1000 else 'higher'}" in text


def test_the_best_compliant_model_decides() -> None:
    worse, better = score("muscle-tendon", 1500.0, -2.0), score("muscle-tendon-toe", 900.0, 1.0)
    found, text = conclude([worse, RIGID, better])
    assert found is TendonEvidence.COMPLIANT
    assert "muscle-tendon-toe" in text


def test_a_free_tendon_as_good_as_rigid_and_a_fixed_one_that_is_worse() -> None:
    fixed, free = score("muscle-tendon", 1500.0, -2.0), score("muscle-tendon-strain", 1003.0, -0.01)
    assert conclude([RIGID, fixed, free])[0] is TendonEvidence.RIGID
    assert conclude([RIGID, free])[0] is TendonEvidence.OPEN


def test_fits_that_failed_decide_nothing() -> None:
    good, bad = score("muscle-tendon", 900.0, 1.0), score("muscle-tendon-toe", None)
    assert conclude([RIGID, good, bad])[0] is TendonEvidence.COMPLIANT
    found, text = conclude([RIGID, bad])
    assert found is None
    assert "every muscle-tendon model" in text
    found, text = conclude([score("muscle", None), good])
    assert found is None
    assert "the rigid model" in text


def test_too_few_independent_samples() -> None:
    few = [replace(s, aicc=None) for s in (RIGID, score("muscle-tendon", 900.0))]
    found, text = conclude(few)
    assert found is TendonEvidence.OPEN
    assert "too few independent samples" in text


def test_without_a_prediction_nothing_is_supported() -> None:
    blind = replace(score("muscle-tendon", 900.0), held_out=None, held_out_note="it overflows")
    found, text = conclude([RIGID, blind])
    assert found is TendonEvidence.OPEN
    assert "it overflows" in text


def test_what_weakens_a_conclusion_is_said() -> None:
    assert cautions([RIGID]) == ()
    held = replace(RIGID, at_bound=("x0_tri", "g3"), status="at-bounds")
    (bound,) = cautions([held])
    assert "muscle is held back by the bounds of x0_tri, g3" in bound
    (moderate,) = cautions([replace(RIGID, vaf=71.2)])
    assert "only 71.2 %" in moderate
    (failed,) = cautions([RIGID, score("muscle-tendon", None)])
    assert "muscle-tendon: the fit failed" in failed


BAD = Adequacy(Grade.INADEQUATE, ("the ankle hardly moves",), 99.0)


@pytest.mark.parametrize(
    ("aicc", "gain", "rigid", "compliant", "finding"),
    [
        (989.0, 0.2, {}, {"adequacy": BAD}, TendonEvidence.OPEN),
        (989.0, 0.2, {"adequacy": BAD}, {}, TendonEvidence.COMPLIANT),
        (1011.0, -0.5, {"adequacy": BAD}, {}, TendonEvidence.OPEN),
        (1011.0, -0.5, {}, {"adequacy": BAD}, TendonEvidence.RIGID),
        (989.0, 0.2, {"at_bound": ("m",)}, {"at_bound": ("k_tri",)}, TendonEvidence.OPEN),
        (989.0, 0.2, {"at_bound": ("m",)}, {}, TendonEvidence.COMPLIANT),
        (1011.0, -0.5, {"at_bound": ("m",)}, {"at_bound": ("k_tri",)}, TendonEvidence.OPEN),
    ],
)
def test_models_that_mean_nothing_support_nothing(aicc, gain, rigid, compliant, finding) -> None:
    models = [replace(RIGID, **rigid), replace(score("muscle-tendon", aicc, gain), **compliant)]
    found, text = conclude(models)
    assert found is finding
    assert text.startswith("The data cannot tell: ") is (finding is TendonEvidence.OPEN)
    assert ("hardly moves" in text or "held back by bounds" in text) is (
        finding is TendonEvidence.OPEN
    )
