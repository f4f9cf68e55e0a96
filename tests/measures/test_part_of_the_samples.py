"""How recordings change with a leg is told by part of their samples."""

import numpy as np
import pytest

import surae
from surae.measures.fitted_leg import leg_of, thinned_leg
from surae.measures.points import evaluate, points
from surae.protocol import Protocol, generate
from surae.studies import virtual_subject, virtual_trial

#: By how much a standard deviation may differ, as a part of it.
ALIKE = 0.02


@pytest.fixture(scope="module")
def fast() -> surae.Fit:
    """A fit of a recording at 256 Hz."""
    motion = generate(Protocol(profile="multiple-holds", duration=20.0, rate_hz=256.0))
    trial = virtual_trial(virtual_subject(2), motion, seed=1)
    return surae.fit(trial, "muscle", starts=1, quality=())


def test_the_leg_is_read_at_a_quarter_of_the_rate(fast) -> None:
    (recording,) = fast.result.problem.inputs
    leg = thinned_leg(leg_of(fast.result))
    (thin,) = leg.summed
    assert recording.rate_hz == 256.0
    assert thin.rate_hz == 64.0
    assert [len(parts.neural) for parts, *_ in leg.split_whole] == [recording.n]
    assert [states.shape[1] for states in leg.active_states] == [recording.n]


def test_part_of_the_samples_tells_the_same_derivatives(fast, monkeypatch) -> None:
    known = fast.assessment.uncertainty
    wanted = [point for point in points() if point.definition.of_recordings]
    thin = evaluate(fast.result, known, wanted)
    monkeypatch.setattr("surae.measures.points.thinned_leg", lambda leg: leg)
    whole = evaluate(fast.result, known, wanted)
    told = [
        (a, b) for a, b in zip(thin, whole, strict=True) if b.value is not None and not b.missing
    ]
    assert len(told) >= 4
    for a, b in told:
        assert a.value == b.value  # which is of all samples
        apart = known.sd(a.gradient - b.gradient)
        assert apart <= ALIKE * known.sd(b.gradient), b.point.name
        assert np.isfinite(a.gradient).all()
