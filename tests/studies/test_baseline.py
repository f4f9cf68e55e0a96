"""Mean standard errors of virtual subjects."""

import numpy as np
import pytest

from surae.assessment import assess
from surae.errors import InputError
from surae.estimation import fit_problem, make_problem
from surae.model import ModelOptions
from surae.protocol import Protocol, generate
from surae.studies import virtual_subject, virtual_trial
from surae.studies.baseline import make_baseline

PROTOCOL = Protocol(profile="multiple-holds", chirp_amplitude=0.2, chirp_rate=0.1, rate_hz=64.0)


def test_it_is_the_mean_over_the_subjects() -> None:
    done = []
    told = make_baseline(PROTOCOL, n=2, seed=4, progress=lambda *at: done.append(at))
    baseline = told.sem
    assert done == [(1, 2), (2, 2)]
    each = []
    for seed in (4, 5):
        subject = virtual_subject(seed)
        trial = virtual_trial(subject, generate(PROTOCOL))
        problem = make_problem([trial], start=subject.parameters)
        each.append(assess(fit_problem(problem, starts=1)).parameters)
    for name in ("m", "l0_tri", "f0", "g3"):
        assert baseline[name] == pytest.approx(np.mean([p[name].sem for p in each])), name
    assert list(baseline) == [p for p in each[0] if p in baseline]


def test_a_subject_of_the_same_kind_has_an_snsem_around_1() -> None:
    baseline = make_baseline(PROTOCOL, n=4, seed=10)
    assert baseline.about.startswith("4 healthy virtual subjects from seed 10, multiple-holds, ")
    trial = virtual_trial(virtual_subject(1), generate(PROTOCOL))
    ratios = assess(fit_problem(make_problem([trial]), starts=2), baseline).snsem
    assert 0.4 < np.median([ratio for ratio in ratios.values() if ratio is not None]) < 2.5


def test_more_noise_gives_larger_errors() -> None:
    quiet, loud = (make_baseline(PROTOCOL, n=1, noise=noise).sem for noise in (0.02, 0.04))
    assert loud["l0_tri"] / quiet["l0_tri"] == pytest.approx(2.0, rel=0.2)


def test_options_go_along() -> None:
    options = ModelOptions(vmax_factor=10.0)
    assert make_baseline(PROTOCOL, n=1, options=options).options == options


def test_subjects_have_tendons_of_their_own_where_the_model_frees_them() -> None:
    baseline = make_baseline(PROTOCOL, "muscle-tendon-strain", n=1).sem
    assert 0 < baseline["dlt_tri"] < 0.01


def test_no_subjects() -> None:
    with pytest.raises(InputError, match="0 subjects"):
        make_baseline(PROTOCOL, n=0)
