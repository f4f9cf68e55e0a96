"""Delay and reflex from outside: simulate, fit, file, profile, report."""

from dataclasses import replace

import numpy as np
import pytest

import surae
from surae.model import MODELS
from surae.report.figures.torque import torque_figure
from surae.report.traces import traces_of

DRIVES = {"emd": 0.037, "reflex_tri": 1500.0, "reflex_tib": 600.0, "reflex_delay": 0.061}


def starts(model):
    spec = MODELS[model]
    return {p.name: p.start for p in spec.parameters if p.name in spec.free}


@pytest.fixture(scope="module")
def fitted(clean, subject):
    torque = surae.simulate("muscle", dict(subject.parameters) | DRIVES, clean)
    rng = np.random.default_rng(2)
    trial = replace(clean, torque=torque + rng.normal(0.0, 1.0, clean.n))
    return surae.fit(trial, "muscle", free=["emd", "reflex"], starts=1, prepared=True)


def test_the_jacobian_ends_with_the_drives_that_are_given(clean):
    model = "muscle-tendon"
    spec, given = MODELS[model], starts(model)
    _, plain = surae.simulate(model, given, clean, jacobian=True)
    assert plain.shape == (clean.n, len(spec.free))
    some = {"reflex_delay": 0.06, "emd": 0.02}
    _, jac = surae.simulate(model, given | some, clean, jacobian=True)
    assert jac.shape == (clean.n, len(spec.free) + 2)
    assert jac[:, -2].any()  # emd, in the order of the model
    assert not jac[:, -1].any()  # the delay of a reflex that is off
    torque, jac = surae.simulate(model, given | DRIVES, clean, jacobian=True)
    assert jac.shape == (clean.n, len(spec.free) + 4)
    step = 1e-6
    moved = surae.simulate(model, given | DRIVES | {"emd": DRIVES["emd"] + step}, clean)
    slope = (moved - torque) / step
    assert np.abs(jac[:, -4] - slope).max() < 1e-3 * np.abs(slope).max()


def test_parts_show_the_reflex_where_there_is_one(clean):
    given = starts("muscle")
    assert surae.simulate_parts("muscle", given, clean).reflex is None
    assert "reflex_Nm" not in surae.simulate_parts("muscle", given | {"emd": 0.1}, clean).columns()
    parts = surae.simulate_parts("muscle", given | DRIVES, clean)
    assert parts.reflex is not None
    assert np.abs(parts.reflex).max() > 1.0
    np.testing.assert_allclose(parts.total, surae.simulate("muscle", given | DRIVES, clean))


def test_all_are_found_together(fitted):
    for name, value in DRIVES.items():
        p = fitted.parameters[name]
        assert p.free
        assert p.sem is not None
        assert abs(p.value - value) < 3.5 * p.sem, name
    assert fitted.status == "converged"


def test_the_profile_of_the_delay(fitted):
    line = surae.profile(fitted, "emd").profiles["emd"]
    low, high = line.interval
    assert low is not None
    assert high is not None
    assert low < DRIVES["emd"] < high
    # One valley: the sum of squares falls to the minimum and rises from it.
    lowest = int(np.argmin(line.sse))
    assert (np.diff(line.sse[: lowest + 1]) < 0).all()
    assert (np.diff(line.sse[lowest:]) > 0).all()


def test_the_figure_of_the_torque_has_the_reflex_as_a_line_of_its_own(fitted):
    (traces,) = traces_of(fitted.result)
    assert traces.parts.reflex is not None
    figure = torque_figure(traces)
    labels = [text.get_text() for axes in figure.axes for text in _legend(axes)]
    assert "reflex" in labels


def _legend(axes):
    legend = axes.get_legend()
    return legend.get_texts() if legend is not None else []
