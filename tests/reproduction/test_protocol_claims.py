"""The movements section: rules that can go either way, figures that show what they say."""

import numpy as np
import pytest

from surae.reproduction.protocols import SECTION
from surae.reproduction.protocols.figures import drawings
from surae.reproduction.protocols.motions import CHOSEN, basic, chirped, for_achilles


@pytest.fixture(scope="module")
def verdicts(tmp_path_factory: pytest.TempPathFactory) -> dict[str, str]:
    from surae.reproduction.chapter import Context

    result = SECTION.run(Context(folder=tmp_path_factory.mktemp("out")))
    return {f.claim.name: f.verdict for f in result.findings}


def test_what_the_device_does_to_the_motions_is_seen(verdicts: dict[str, str]) -> None:
    assert verdicts["below-overshoot"] == "holds"
    for name in CHOSEN:
        assert np.abs(chirped(name).velocity).max() > 1.5
        assert np.abs(for_achilles(name).velocity).max() < 1.5 + 1e-6


def test_a_chirp_rate_of_0_6_is_beyond_the_muscles_speed(verdicts: dict[str, str]) -> None:
    assert verdicts["highest-chirp-rate"] == "differs"


def test_the_sine_has_the_thesis_frequency() -> None:
    one = basic("sine")
    middle = one.angle - one.angle.mean()
    crossings = np.count_nonzero(np.diff(np.sign(middle)) != 0)
    assert crossings / 2 / one.time[-1] == pytest.approx(0.2, abs=0.02)


def test_every_figure_of_the_section_is_there_with_its_axes_named() -> None:
    names = [one.name for one in drawings()]
    assert names == [f"figure-{n}" for n in (2, 3, 6, 7, 8, 9, 36, 37, 38)]
    for one in drawings():
        assert one.alt
        assert one.caption
        lowest = one.figure.axes[-1]
        assert "[" in lowest.get_xlabel()
        assert "[" in lowest.get_ylabel()
