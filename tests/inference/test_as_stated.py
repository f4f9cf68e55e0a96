"""A fit of a measured recording that is as its file says is never called "not as stated"."""

from dataclasses import replace
from pathlib import Path

import pytest

import surae
from surae.base.frozen import read_only
from surae.quality.finding import NOT_AS_STATED

#: Recordings with a description that puts their signs right, and those under perturbations.
DESCRIBED = ("dynamometer/PL_50_01.toml", "gait/walk36.toml", "gait/run81.toml")
PERTURBED = ("dorsiflexing", "dorsiflexing_stronger", "plantarflexing")
#: What a dynamometer's files have without a description: plantarflexion is positive in them.
SIGNS = {"angle-sign", "torque-sign"}


def accused(path: Path) -> set[str]:
    """Codes by which a fit is "not as stated"."""
    return {f.code for f in surae.check(path).findings if f.severity == "error"} & NOT_AS_STATED


@pytest.mark.parametrize("name", [*DESCRIBED, *(f"perturbed/{name}.csv" for name in PERTURBED)])
def test_measured_recordings_are_as_stated(shared, name) -> None:
    assert accused(shared / name) == set()


def test_a_dynamometers_files_have_no_other_unit_or_muscle(shared) -> None:
    """Whatever else is wrong with a file without a description, its units are as it says."""
    files = sorted([*shared.glob("dynamometer/*.mat"), *shared.glob("repeats/*.mat")])
    told = {path.stem: accused(path) for path in files}
    assert len(told) >= 8
    assert set().union(*told.values()) <= SIGNS
    turned = {name for name, codes in told.items() if codes}
    assert all(name.startswith("PL_") for name in turned)  # with effort; relaxed ones tell no sign


@pytest.mark.parametrize("name", DESCRIBED)
def test_a_fit_of_a_measured_recording_is_of_what_its_file_says(shared, name) -> None:
    fit = surae.fit(surae.read(shared / name), model="muscle")
    assert len(fit.quality) == 1  # the check was made
    assert "not-as-stated" not in {reason.code for reason in fit.assessment.adequacy.against}


def test_the_same_recording_in_another_unit_is_not_as_stated(shared) -> None:
    """What the tests above look for is there where it is true."""
    right = surae.read(shared / "gait" / "walk36.toml")
    torque = right.channels["torque"]
    wrong = replace(torque, values=read_only(1e3 * torque.values))
    turned = replace(right, channels={**right.channels, "torque": wrong}, fixed={})
    fit = surae.fit(turned, model="muscle")
    assert "not-as-stated" in {reason.code for reason in fit.assessment.adequacy.against}
