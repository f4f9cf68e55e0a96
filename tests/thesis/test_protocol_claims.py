"""The movements section: rules that can go either way, figures that show what they say."""

import numpy as np
import pytest

from surae_thesis import movements
from surae_thesis.movements import (
    CHOSEN,
    basic,
    chirped,
    drawings,
    for_achilles,
    highest_factor,
    run,
)
from surae_thesis.section import Context


@pytest.fixture(scope="module")
def verdicts(tmp_path_factory: pytest.TempPathFactory) -> dict[str, str]:
    result = run(Context(folder=tmp_path_factory.mktemp("out")))
    return {f.id: f.verdict for f in result.findings}


def test_what_the_device_does_to_the_motions_is_seen(verdicts: dict[str, str]) -> None:
    assert verdicts["below-overshoot"] == "holds"
    for name in CHOSEN:
        assert np.abs(chirped(name).velocity).max() > 1.5
        assert np.abs(for_achilles(name).velocity).max() < 1.5 + 1e-6


def test_the_chirp_stays_within_the_axes_of_figure_38(verdicts: dict[str, str]) -> None:
    assert verdicts["within-axes"] == "holds"
    assert verdicts["highest-chirp-factor"] == "holds"
    for name in CHOSEN:
        assert 7.0 < np.abs(chirped(name).velocity).max() < 10.0


def test_the_highest_factor_is_that_of_muscles_that_approach_their_limit(monkeypatch) -> None:
    assert highest_factor(None, 0.9).holds
    for fastest in (0.5, 1.5):
        monkeypatch.setattr(movements, "_peak", lambda *_, v=fastest: v * 6.0)
        assert not highest_factor(None, 0.9).holds


def test_the_sine_has_the_thesis_frequency() -> None:
    motion = basic("sine")
    middle = motion.angle - motion.angle.mean()
    crossings = np.count_nonzero(np.diff(np.sign(middle)) != 0)
    assert crossings / 2 / motion.time[-1] == pytest.approx(0.2, abs=0.02)


def test_every_figure_of_the_section_is_there_with_its_axes_named() -> None:
    names = [drawing.name for drawing in drawings()]
    assert names == [f"figure-{n}" for n in (2, 3, 6, 7, 8, 9, 36, 37, 38)]
    for drawing in drawings():
        assert drawing.alt
        assert drawing.caption
        lowest = drawing.figure.axes[-1]
        assert "[" in lowest.get_xlabel()
        assert "[" in lowest.get_ylabel()
