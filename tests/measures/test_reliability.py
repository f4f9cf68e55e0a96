"""SDC and ICC against numbers worked out by hand, and where there is none."""

import json

import pytest

import surae
from relaxed_ankle import Ankle, measured
from surae.measures.reliability import reliability_of, smallest_detectable, word_of


def test_the_smallest_detectable_change() -> None:
    assert smallest_detectable(1.0) == pytest.approx(2.7718, abs=1e-4)


def test_reliability_is_that_of_cited_people() -> None:
    r = reliability_of("slow_stiffness@10deg", "Nm/deg", 0.1)
    assert r.icc == pytest.approx(0.8)  # 0.2² over 0.2² + 0.1²
    assert r.people_sd == 0.2
    assert "Chung" in r.source
    assert r.word == "good"
    assert reliability_of("slow_stiffness@10deg", "Nm/rad", 0.1) is None
    assert reliability_of("torque_rise", "Nm", 1.0) is None


@pytest.mark.parametrize(
    ("icc", "word"), [(0.49, "poor"), (0.6, "moderate"), (0.8, "good"), (0.95, "excellent")]
)
def test_words_are_those_of_koo_and_li(icc, word) -> None:
    assert word_of(icc) == word


def test_measures_of_rest_have_both_and_the_file_too(tmp_path) -> None:
    told = surae.relaxed(measured(Ankle()))
    m = told.measures["slow_stiffness@10deg"]
    assert 0.0 < m.sdc < m.value
    assert 0.0 < m.reliability.icc < 1.0
    told.save(tmp_path / "r.json")
    data = json.loads((tmp_path / "r.json").read_text(encoding="utf-8"))["measures"]
    assert data["slow_stiffness@10deg"]["sdc"] == m.sdc
    assert data["torque_rise"]["reliability"] is None
    lacking = data["range_at_torque@15Nm"]
    assert lacking["sdc"] is None
    assert lacking["sdc_note"]


def test_a_change_of_twice_the_smallest_is_found_and_noise_is_not() -> None:
    """What SDC promises: an unchanged second visit differs by less, in this leg."""
    before, same = surae.relaxed(measured(Ankle(), 0)), surae.relaxed(measured(Ankle(zero=-1.0), 1))
    for name in ("torque_rise", "end_stiffness", "slow_stiffness@0deg"):
        first, second = before.measures[name], same.measures[name]
        assert abs(second.value - first.value) < first.sdc
