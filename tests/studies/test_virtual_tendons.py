"""Subjects with tendons of their own."""

import numpy as np
import pytest

from surae.model import ModelOptions
from surae.model.parameters import TENDON_PARAMETERS
from surae.model.tendon import tendon_curve
from surae.protocol import Protocol, generate
from surae.studies import POPULATIONS, virtual_subject, virtual_trial
from surae.studies.populations import TENDONS


@pytest.fixture(scope="module")
def trajectory():
    return generate(Protocol(profile="multiple-holds", rate_hz=64.0))


@pytest.mark.parametrize("population", POPULATIONS)
def test_tendons_lie_within_their_ranges_and_the_bounds_of_a_fit(population):
    bounds = {p.name: (p.lower, p.upper) for p in TENDON_PARAMETERS}
    drawn = [virtual_subject(seed, population, tendons=True).tendons for seed in range(200)]
    for name, (low, high) in TENDONS[population].items():
        values = np.array([tendons[name] for tendons in drawn])
        assert bounds[name][0] < low <= values.min() < values.max() <= high < bounds[name][1]
        assert values.mean() == pytest.approx((low + high) / 2, abs=0.1 * (high - low))


def test_stiffness_is_that_of_the_literature():
    def stiffness(population: str, name: str, f_max: float) -> list[float]:
        ends = TENDONS[population][name]
        return [1e-3 * tendon_curve(eps0, 0.3, 4.0, f_max)[3] for eps0 in ends]  # N/mm

    assert stiffness("healthy", "dlt_tri", 8e3) == pytest.approx([549, 308], abs=1)
    assert stiffness("patient", "dlt_tri", 8e3) == pytest.approx([342, 220], abs=1)
    assert stiffness("healthy", "dlt_tib", 1.4e3) == pytest.approx([336, 150], abs=1)


def test_the_other_parameters_stay_the_same():
    for population in POPULATIONS:
        plain = virtual_subject(6, population)
        own = virtual_subject(6, population, tendons=True)
        assert plain.parameters == own.parameters
        assert plain.tendons == {}
        assert own == virtual_subject(6, population, tendons=True)
        assert own.tendons != virtual_subject(7, population, tendons=True).tendons


def test_the_truth_of_a_model_has_what_the_model_knows():
    subject = virtual_subject(6, tendons=True)
    assert subject.truth("muscle") == subject.parameters
    assert subject.truth("muscle-tendon") == {**subject.parameters, **subject.tendons}
    strain = subject.truth("muscle-tendon", ModelOptions(tendon_strain="slack-length"))
    assert strain["dlt_tri"] == pytest.approx(subject.tendons["dlt_tri"] / 0.415)
    assert strain["dlt_tib"] == pytest.approx(subject.tendons["dlt_tib"] / 0.216)
    assert strain["pt_tri"] == subject.tendons["pt_tri"]
    assert virtual_subject(6).truth("muscle-tendon") == virtual_subject(6).parameters


def test_tendons_matter_to_compliant_models_only(trajectory):
    plain, own = virtual_subject(6), virtual_subject(6, tendons=True)

    def torque(subject, model, options=None):
        return virtual_trial(subject, trajectory, model=model, options=options, noise=0.0).torque

    np.testing.assert_array_equal(torque(plain, "muscle"), torque(own, "muscle"))
    in_metres = torque(own, "muscle-tendon")
    assert np.abs(in_metres - torque(plain, "muscle-tendon")).max() > 0.5
    strain = torque(own, "muscle-tendon", ModelOptions(tendon_strain="slack-length"))
    np.testing.assert_allclose(strain, in_metres, atol=1e-9)  # one tendon, told in two ways
