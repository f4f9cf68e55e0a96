"""A zero of the angle that is wrongly stated is told by the torque, and claims know of it."""

import pytest

import surae

laboratory = pytest.importorskip("ankle_legs.laboratory")
MEASURED_AT = pytest.importorskip("ankle_legs.measures").MEASURED_AT


@pytest.mark.slow
@pytest.mark.parametrize("wrong", [None, "zero"])
def test_a_zero_six_degrees_off_makes_no_false_claim(wrong, tmp_path) -> None:
    made = laboratory.measure("h", 812, laboratory.STEPS, wrong=wrong, active=2)
    fit = surae.session(laboratory.write(made, tmp_path)).fit()
    wider = fit.result.found.zero_wider
    assert wider > 1.5 if wrong else wider < 1.5
    truth = made.truth["measures"]
    for name, m in fit.measures(angles=MEASURED_AT).items():
        if m.verdict == "identified" and truth.get(name) is not None:
            assert m.ci95[0] <= truth[name] <= m.ci95[1], name
