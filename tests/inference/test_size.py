"""A leg whose moment arms are not what its size says: nothing false is claimed of it."""

import pytest

import surae

make = pytest.importorskip("ankle_legs.make")


@pytest.mark.slow
@pytest.mark.parametrize("height", [152.0, 200.0])
def test_arms_that_are_not_what_size_says_make_no_false_claim(height, tmp_path) -> None:
    (path,), truth = make.make("f", 845, tmp_path), make.truth_of("f", 845, 1)
    fit = surae.fit(path, knowledge={"height_cm": height})
    told = {**fit.parameters, **fit.measures()}
    true = {**truth["parameters"], **truth["measures"]}
    claimed = {name for name, one in told.items() if one.verdict == "identified"}
    assert fit.nuisances["arm_scale_tri"].ci95 is not None
    for name in claimed & {name for name, value in true.items() if value is not None}:
        assert told[name].ci95[0] <= true[name] <= told[name].ci95[1], name
