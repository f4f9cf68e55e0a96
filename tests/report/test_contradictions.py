"""When trials of one leg are said to contradict each other, and when they must not be."""

from types import SimpleNamespace

import numpy as np
import pytest

from surae.base.words import Message
from surae.inference import Verdict
from surae.quality import Quality
from surae.quality.finding import worded_finding
from surae.report.trials import contradictions, findings_section


def fit(**values):
    """A fit that knows parameters: mean and standard deviation each, or what else it says."""
    made = {}
    for name, (mean, sd, *more) in values.items():
        said = {
            "name": name,
            "free": True,
            "at_bound": False,
            "verdict": Verdict.IDENTIFIED,
            "ci95": (mean - 1.96 * sd, mean + 1.96 * sd),
            "lower": -1e3,
            "upper": 1e3,
        }
        made[name] = SimpleNamespace(**said | (more[0] if more else {}))
    return SimpleNamespace(parameters=made)


def test_values_far_apart_contradict_each_other():
    alone = {"a": fit(k=(1.0, 0.1)), "b": fit(k=(3.0, 0.1))}
    assert contradictions(alone, fit(k=(1.0, 0.1))) == {"k": ["b"]}


@pytest.mark.parametrize(
    "untold",
    [{"at_bound": True}, {"verdict": Verdict.UNDETERMINED}, {"free": False}, {"upper": 3.1}],
)
def test_what_a_trial_does_not_tell_contradicts_nothing(untold):
    """A passive trial ran the gain of a muscle that rested to the end of the search."""
    alone = {"a": fit(k=(1.0, 0.1)), "passive": fit(k=(3.0, 0.1, untold))}
    assert contradictions(alone, fit(k=(1.0, 0.1))) == {}


def test_chance_alone_is_said_of_at_most_one_leg_in_twenty():
    """Right intervals of fifteen values and eight trials, five hundred legs."""
    rng, legs = np.random.default_rng(4), 500
    said = 0
    for _ in range(legs):
        of_trial = rng.standard_normal((8, 15))
        alone = {
            str(i): fit(**{f"p{j}": (x, 1.0) for j, x in enumerate(row)})
            for i, row in enumerate(of_trial)
        }
        joint = {f"p{j}": (x, 8**-0.5) for j, x in enumerate(of_trial.mean(axis=0))}
        said += bool(contradictions(alone, fit(**joint)))
    assert said <= 0.05 * legs


def test_a_session_has_one_zero_of_the_torque() -> None:
    """Each trial's own check finds another; the page says one, which it subtracts."""

    def checked(name: str, off: float) -> Quality:
        told = Message(f"It is off by {off} Nm.")
        advice = Message("advice/torque-offset")
        found = worded_finding("torque-offset", "torque", (0.0, 9.0), off, told, advice)
        return Quality(name, (found,))

    quality = {"a": checked("a", 13.1), "b": checked("b", 16.1), "c": checked("c", 19.3)}
    for zero, said in ((14.2, "14.2 Nm"), (0.0, "16.1 Nm")):
        text = str(findings_section(quality, zero))
        assert said in text
        assert text.count(" Nm") == 1
    assert "off by 13.1 Nm" in str(findings_section({"a": quality["a"]}))
