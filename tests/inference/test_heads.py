"""Heads of the triceps have lengths of their own: each weight's interval has what that makes."""

from dataclasses import dataclass, replace

import numpy as np
import pytest

import surae
from ankle_legs.leg import Departure
from ankle_legs.make import leg, write_csv
from richer_legs import richer_leg
from surae.inference import make_problem
from surae.inference.posterior.empirical_bayes import BEGIN
from surae.inference.posterior.family import Family
from surae.inference.posterior.laplace import HEADS, between_heads
from surae.inference.posterior.valleys import white_noise

WEIGHTS = ("g2", "g3", "g4")
#: Where each head has its optimum beside the group's [deg], and the width of its curve [deg].
APART, WIDE = (9.0, -7.0, 8.0), 22.0


def test_heads_share_a_force_that_stays() -> None:
    inputs = richer_leg(0, rate_hz=64.0, duration=15.0).inputs
    family = Family(make_problem([inputs], "auto"))
    post = family.posterior((), 64.0, white_noise(family.original, 0.05), BEGIN)
    values = post.by_name(post.start({}))
    rows = between_heads(post, values)
    at = [post.names.index(name) for name in WEIGHTS]
    assert not np.delete(rows, at, axis=1).any()
    force = np.sqrt(np.mean(inputs.emg[:, 1:] ** 2, axis=0)) * [values[n] for n in WEIGHTS]
    assert rows[:, at] @ force == pytest.approx(np.zeros(3), abs=1e-9 * force.sum())
    # the heads that make little of the force are as unsure as is said, one that makes all is not
    variance = np.diag(rows.T @ rows)[at]
    share = force / np.linalg.norm(force)
    assert variance == pytest.approx(HEADS**2 * (1.0 - share**2))


def test_one_head_alone_has_no_share() -> None:
    inputs = richer_leg(0, rate_hz=64.0, duration=15.0).inputs
    family = Family(make_problem([inputs], "auto", fixed={"g2": 1e4, "g4": 1e4}))
    post = family.posterior((), 64.0, white_noise(family.original, 0.05), BEGIN)
    assert not between_heads(post, post.by_name(post.start({}))).any()


@dataclass(frozen=True)
class Heads(Departure):
    """Each head pulls along a curve of its own."""

    def excite(self, run) -> None:
        degrees = np.degrees(run.ankle)
        for head, apart in enumerate(APART, 1):
            own = np.exp((degrees**2 - (degrees - apart) ** 2) / WIDE**2)
            run.excitation[head] *= own / np.sqrt(np.mean(own**2))


@pytest.mark.slow
@pytest.mark.parametrize("seed", [3451, 3452])
def test_intervals_of_weights_hold_where_heads_have_other_optima(seed, tmp_path) -> None:
    own = replace(leg("ve", seed), departures=(Heads(),))
    write_csv(tmp_path / "trial.csv", own.columns(own.record(1), 1), "# emg: envelope\n")
    fit = surae.fit(tmp_path / "trial.csv", quality=())
    for name in WEIGHTS:
        low, high = fit[name].ci95
        assert low <= own.subject.values[name] <= high, name
        assert fit[name].verdict != "identified"
        assert fit[name].budget["heads"] > 0.1
