"""A zero of the angle that is wrongly stated: the second reader says so, and claims know of it."""

import pytest

import surae

laboratory = pytest.importorskip("ankle_legs.laboratory")
MEASURED_AT = pytest.importorskip("ankle_legs.measures").MEASURED_AT


@pytest.mark.slow
@pytest.mark.parametrize("wrong", [None, "zero"])
def test_a_zero_six_degrees_off_makes_no_false_claim(wrong, tmp_path) -> None:
    made = laboratory.measure("h", 812, laboratory.STEPS, wrong=wrong, active=2)
    fit = surae.session(laboratory.write(made, tmp_path)).fit()
    told = fit.settings.knowledge.statements["angle_zero"]
    assert told.agrees is (wrong is None)
    assert any("zero of the angle contradict each other" in r for r in fit.adequacy.reasons) is (
        wrong is not None
    )
    truth, claims = made.truth["measures"], []
    for name, m in fit.measures(angles=MEASURED_AT).items():
        if m.verdict == "identified" and truth.get(name) is not None:
            claims.append(m.ci95[0] <= truth[name] <= m.ci95[1])
    # of what is claimed 95 % is true, so that of a right session one may not be
    assert claims.count(False) <= (wrong is None)
