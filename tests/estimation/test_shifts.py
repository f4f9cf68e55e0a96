"""What moves all estimates together: directions are kept, sizes are those that are asked."""

from dataclasses import replace

import numpy as np
import pytest

from surae.assessment.saved.fit_json import family_of
from surae.estimation.mode import Mode, Target, white_noise
from surae.estimation.problem import make_problem
from surae.estimation.shifts import along, root, sized, unheard
from surae.protocol import Protocol, generate
from surae.records import decode, encode
from surae.settings import FitSettings
from surae.studies import virtual_subject, virtual_trial

VALLEY = np.array([[1.0, -0.9], [-0.9, 1.0]])


def test_a_root_is_one() -> None:
    assert root(VALLEY).T @ root(VALLEY) == pytest.approx(VALLEY)


def test_shifts_get_a_size_and_keep_how_they_go_together() -> None:
    made = sized(np.array([[1.0, -2.0, 0.0]]), np.array([3.0, 4.0, 5.0]))
    assert made == pytest.approx(np.array([[3.0, -4.0, 0.0]]))  # what nothing moves stays


def test_deviations_along_a_valley_cancel_where_its_parameters_do() -> None:
    made = along(np.array([0.5, 0.5]), 4.0 * VALLEY)
    assert np.sqrt((made**2).sum(axis=0)) == pytest.approx([0.5, 0.5])
    assert np.linalg.norm(made @ [1.0, 1.0]) == pytest.approx(0.5 * np.sqrt(0.2))


def test_files_of_shifts_and_of_former_deviations_are_read() -> None:
    rows = encode(np.arange(6.0).reshape(2, 3))
    read = family_of({"spread": {"a": rows, "b": {"a": 1.0, "c": 2.0}}}, ("a", "b", "c"))["spread"]
    assert read["a"] == rows
    assert np.array_equal(decode(read["b"]), np.diag([1.0, 0.0, 2.0]))


@pytest.mark.parametrize(("missing", "count"), [((), 0), (("gl", "gm"), 2)])
def test_muscles_without_an_electrode_leave_the_filter_unsure(missing, count) -> None:
    motion = generate(Protocol(profile="multiple-holds", chirp_amplitude=0.2, rate_hz=40.0))
    trial = replace(virtual_trial(virtual_subject(1), motion), missing_emg=missing)
    fixed = {"g2": 0.0, "g4": 0.0}
    problem = make_problem((trial,), FitSettings.of(model="muscle", fixed=fixed))
    target = Target(problem, {}, white_noise(problem, 0.05))
    mode = Mode(target.start(dict(virtual_subject(1).parameters)), 0.0)
    shifts = unheard(target, mode, target.quadratic(mode))
    assert shifts.shape == (count, len(mode.z))
    if count:
        where = [target.names.index(name) for name in ("f0", "beta")]
        assert np.diag(shifts[:, where]) == pytest.approx([0.10, 0.10])
