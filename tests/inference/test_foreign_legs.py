"""What `auto` claims of legs that share no code with surae and depart from its models.

README promises that what is called identified is true for 93 % at least (`PROMISED`). How much is
(`IDENTIFIED`) is asked as if arms and paths were known: who claims nothing keeps any promise. They
are not, of these legs: what is then claimed need not be true. What is said by default is, and
all its intervals are counted.
Families l-* are for a last count alone.
"""

from dataclasses import dataclass

import numpy as np
import pandas as pd
import pytest
from scipy.signal import lfilter
from scipy.stats import binom

import surae
from ankle_legs.make import make, truth_of
from promises import HOLD, IDENTIFIED, keeps_the_promise, with_known_arms


@dataclass
class Count:
    """Of one leg or of many."""

    free: int = 0
    claimed: int = 0
    true: int = 0
    told: int = 0  #: Those with an interval.
    held: int = 0  #: Of these, how many hold the truth.

    def __iadd__(self, other: "Count") -> "Count":
        self.free += other.free
        self.claimed += other.claimed
        self.true += other.true
        self.told += other.told
        self.held += other.held
        return self

    def keeps_the_promise(self) -> bool:
        return keeps_the_promise(self.true, self.claimed)

    def holds(self) -> bool:
        return keeps_the_promise(self.held, self.told, HOLD)


def counted(fit: surae.Fit, truth: dict[str, float | None]) -> Count:
    """Values that a truth is known of; where a family gives one another meaning it has none."""
    count = Count()
    for name, p in fit.parameters.items():
        if p.free and truth.get(name) is not None:
            inside = p.ci95 is not None and p.ci95[0] <= truth[name] <= p.ci95[1]
            count.free += 1
            count.told += p.ci95 is not None
            count.held += inside
            if p.verdict == "identified":
                count.claimed += 1
                count.true += inside
    return count


def fitted(folder, family: str, seed: int, trial: int = 1, seconds: float = 35.0) -> surae.Fit:
    (path,) = make(family, seed, folder, (trial,), seconds=seconds)
    return surae.fit(path, quality=())


def judged(folder, family: str, seed: int, seconds: float = 35.0) -> tuple[Count, Count]:
    """What is said with arms that are assumed, and what would be were they known."""
    fit = fitted(folder, family, seed, seconds=seconds)
    truth = truth_of(family, seed, 1)["parameters"]
    return counted(fit, truth), counted(with_known_arms(fit), truth)


@pytest.mark.slow  # in the fast suite test_api_auto.py has one
def test_a_leg_of_the_models_kind_is_known(tmp_path) -> None:
    told, known = judged(tmp_path, "p", 31)
    assert known.claimed >= IDENTIFIED * known.free  # no length: its path has a zero of its own
    assert known.keeps_the_promise()
    assert told.claimed == told.true
    assert told.holds()


@pytest.mark.slow
def test_nothing_false_is_claimed_of_a_leg_that_resists_and_answers(tmp_path) -> None:
    """No model has a short-range stiffness, nor a reflex that electrodes show in part."""
    told, _ = judged(tmp_path, "e", 31, seconds=20.0)
    assert told.free >= 15
    assert told.claimed == told.true
    assert told.holds()


@pytest.mark.slow
def test_what_is_identified_of_foreign_legs_is_true(tmp_path) -> None:
    own, told = Count(), Count()
    for family in "paefik":
        for seed in (41, 42, 43):
            assumed, known = judged(tmp_path, family, seed)
            told += assumed
            if family in "pa":
                own += known
    assert own.claimed >= IDENTIFIED * own.free
    assert told.keeps_the_promise()
    assert told.holds()


@pytest.mark.slow
def test_nothing_false_is_claimed_where_envelopes_lag_their_emg(tmp_path) -> None:
    """A low-pass of 4 to 10 Hz was run once; twelve of 63 claims were false, f0 and β of them."""
    count, told = Count(), Count()
    for number, family in enumerate("acgph"):
        (path,) = make(family, 46, tmp_path, (1,))
        table = pd.read_csv(path, comment="#")
        kept = np.exp(-(table.time_s[1] - table.time_s[0]) / (0.015 + 0.006 * number))
        for name in (c for c in table if c.startswith("emg_")):
            emg = table[name].to_numpy()
            table[name] = lfilter([1.0 - kept], [1.0, -kept], emg, zi=[kept * emg[0]])[0]
        path.write_text("# emg: envelope\n" + table.to_csv(index=False), encoding="utf-8")
        fit, truth = surae.fit(path, quality=()), truth_of(family, 46, 1)["parameters"]
        told += counted(fit, truth)
        count += counted(with_known_arms(fit), truth)
    assert count.claimed >= IDENTIFIED * count.free
    assert told.keeps_the_promise()
    assert told.holds()


@pytest.mark.slow
def test_envelopes_that_are_made_here_do_not_lag(tmp_path) -> None:
    for raw in (True, False):
        path = make("a", 46, tmp_path / str(raw), (1,), seconds=20.0, raw=raw)
        beliefs = surae.fit(path, quality=()).result.solution.beliefs
        assert ("emg_lag" in beliefs) == (not raw)


@pytest.mark.slow
def test_the_largest_torque_is_right_although_an_electrode_drifts(tmp_path) -> None:
    """By the EMG as it is the tibialis's would be 11 % too large, beside an interval of 9 %."""
    fit = fitted(tmp_path, "c", 2)
    assert fit.result.solution.gained[1] < 0.95
    measures, truth = fit.measures(angles=(0,)), truth_of("c", 2, 1)["measures"]
    for name in ("active_torque_max_tri@0deg", "active_torque_max_tib@0deg"):
        low, high = measures[name].ci95
        assert low <= truth[name] <= high, name


@pytest.mark.slow
def test_foreign_legs_that_stayed_as_they_were_have_not_changed(tmp_path) -> None:
    """One pair in twenty may be called changed: so is the family of its tests corrected.

    Doubtful fits are not judged, so not every pair has a verdict.
    """
    judged, wrong = 0, []
    for family in "aei":
        for seed in (44, 45):
            told = surae.change(*(fitted(tmp_path, family, seed, trial) for trial in (1, 2)))
            every = (*told.measures.values(), *told.parameters.values())
            judged += any(d.verdict in ("no change shown", "changed") for d in every)
            wrong += [(family, seed, told.changed)] if told.changed else []
    assert judged >= 3
    assert len(wrong) <= binom.ppf(0.95, judged, 0.05), wrong


@pytest.mark.slow
@pytest.mark.parametrize(("family", "seed", "errs"), [("c", 741, False), ("j", 742, True)])
def test_the_noise_of_raw_emg_is_no_error_of_the_drive(tmp_path, family, seed, errs) -> None:
    """Rectified noise is loud under effort too; each size is judged with the noise it leaves."""
    fit = surae.fit(make(family, seed, tmp_path, (1,), raw=not errs), quality=())
    assert (fit.result.solution.sizes["drive"] > 0.0) == errs


NOISY = [("a", 3201, 2), ("g", 3402, 1)]


@pytest.fixture(scope="module")
def noisy_raw(tmp_path_factory):
    """Fits and truths of legs by their raw EMG, of every n-th sample."""
    made = {}
    for family, seed, every in NOISY:
        path = make(family, seed, tmp_path_factory.mktemp(family), (1,), raw=True)[0]
        lines = path.read_text(encoding="utf-8").splitlines(keepends=True)
        path.write_text("".join([*lines[:2], *lines[2::every]]), encoding="utf-8")
        made[family] = surae.fit(path, quality=()), truth_of(family, seed, 1)["parameters"]
    return made


@pytest.mark.slow
@pytest.mark.parametrize("family", [family for family, _, _ in NOISY])
def test_noise_of_raw_emg_is_no_release_and_no_curve(noisy_raw, family) -> None:
    """Noise times itself is not zero on average; at 512 Hz it was a release with 47 %."""
    fit, truth = noisy_raw[family]
    solution = fit.result.solution  # of its some 18 descents 0 to 3 end at a cap: decision 17
    assert not {"release", "shape"} & {*solution.candidates[0].groups}
    assert counted(with_known_arms(fit), truth).claimed
    assert counted(fit, truth).holds()
    assert solution.outcome == "converged"
    assert sum(stage.capped for stage in solution.stages) <= 3


@pytest.mark.slow
@pytest.mark.parametrize(
    "family",
    [
        pytest.param(
            "a",
            marks=pytest.mark.xfail(
                reason="of the leg a-3201 the time of relaxation is called identified, "
                "1.06 to 1.25 s, and is 1.27 s: 2.6 standard deviations, one of seventeen intervals"
            ),
        ),
        "g",
    ],
)
def test_what_is_identified_behind_noisy_raw_emg_is_true(noisy_raw, family) -> None:
    told = counted(*noisy_raw[family])
    assert told.claimed == told.true
