"""One request: made from keywords, kept, given whole."""

import json
import math

import numpy as np
import pytest

from surae.base.errors import InputError
from surae.base.records import from_plain
from surae.inference import make_problem, solve
from surae.model import ModelOptions
from surae.protocol import Protocol, generate
from surae.settings import FitSettings
from surae.signals import Weighting
from surae.studies import virtual_subject, virtual_trial

FULL = FitSettings.of(
    "muscle-tendon-strain",
    fixed={"beta": 1.0},
    free=["emd", "reflex"],
    start={"m": 2.1},
    bounds={"k_tri": [30, 500.0]},
    priors=("healthy", {"tau_rel": (2.0, 0.5)}),
    weights=[Weighting(((-math.inf, 3.0, 0.0), (4.0, math.inf, 2.0)), 9.0, "emg"), Weighting()],
    loss="huber",
    normalise="session",
    prepared=True,
    preparation={"bessel_hz": 10.0, "emg_lowpass_hz": False},
    starts=3,
    seed=np.int64(7),
    tendon_strain="slack-length",
)


OF_AUTO = FitSettings.of(nuisances={"zero": [0.0, 1.0]}, free="reflex", seed=2)


@pytest.fixture(scope="module")
def trial():
    motion = generate(Protocol(profile="multiple-holds", rate_hz=32.0))
    return virtual_trial(virtual_subject(1), motion)


@pytest.mark.parametrize(
    "settings", [FULL, OF_AUTO, FitSettings(), FitSettings.of(weights=Weighting())]
)
def test_settings_survive_a_file(settings):
    plain = json.loads(json.dumps(settings.as_dict(), allow_nan=False))
    assert from_plain(FitSettings, plain) == settings
    assert hash(from_plain(FitSettings, plain)) == hash(settings)


def test_keywords_stand_for_fields():
    assert FULL.population == "healthy"
    assert dict(FULL.priors) == {"tau_rel": (2.0, 0.5)}
    assert FULL.options == ModelOptions(tendon_strain="slack-length")
    assert FULL.free == ("emd", "reflex")
    assert FitSettings.of(free="emd").free == ("emd",)
    assert FitSettings.of(priors="patient").population == "patient"
    assert FitSettings.of(loss=None, starts=None) == FitSettings()
    assert dict(OF_AUTO.nuisances) == {"zero": (0.0, 1.0)}


def test_settings_given_whole_yield_to_keywords():
    other = FitSettings.of(FULL, starts=5, vmax_factor=10.0)
    assert other.starts == 5
    assert other.options == ModelOptions(tendon_strain="slack-length", vmax_factor=10.0)
    assert FitSettings.of(other, starts=3, vmax_factor=8.0) == FULL


@pytest.mark.parametrize(
    ("asked", "says"),
    [
        ({"geometri": 1}, "option 'geometri' is not known"),
        ({"fixed": ["beta"]}, "give a mapping"),
        ({"model": "muscle", "starts": 0}, "starts is 0; give at least 1"),
        ({"model": "muscle", "starts": 2.5}, "whole number"),
        ({"nuisances": "some"}, "use one of: all, none, or a mapping"),
        ({"nuisances": {"magic": (0, 1)}}, "no 'magic'"),
        ({"nuisances": {"zero": 3.0}}, "give mean and sd"),
        ({"seed": -1}, "at least 0"),
        ({"model": "muscle", "loss": "square"}, "loss is .square."),
        ({"normalise": "max"}, "normalise is 'max'"),
        ({"priors": "giants"}, "population is .giants."),
        ({"preparation": {"cutoff": 3}}, "setting 'cutoff' is not known"),
    ],
)
def test_what_no_model_could_mean_is_refused(asked, says):
    with pytest.raises(InputError, match=says):
        FitSettings.of(**asked)


def test_a_problem_keeps_its_settings_and_is_solved_by_them(trial):
    settings = FitSettings.of("muscle", fixed={"beta": 1.0}, loss="huber", starts=2, seed=5)
    (inputs,) = settings.inputs([trial])
    problem = make_problem([inputs], settings)
    assert problem.settings == settings
    result = solve(problem)
    assert (len(result.solution.starts), result.seed) == (2, 5)
    assert result.solution.outliers is not None
    assert result.values["beta"] == 1.0
    assert len(solve(problem, starts=1).solution.starts) == 1
