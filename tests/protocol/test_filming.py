"""What a film is expected to add, and where it adds nothing."""

import numpy as np
import pytest

import surae
from surae.base.errors import InputError
from surae.planning.information import filmed, information
from surae.planning.legs import population_legs
from surae.protocol import Protocol, generate


@pytest.fixture(scope="module")
def trial():
    return generate(Protocol(profile="multiple-holds", task="active", duration=20.0, rate_hz=64.0))


@pytest.fixture(scope="module")
def known(trial):
    """Half-widths of two legs by what is filmed."""
    each = {film: surae.expect(trial, film=film, legs=2) for film in ("", "tib", "gm")}
    return {film: {n: p.half_width for n, p in e.parameters.items()} for film, e in each.items()}


def test_a_film_tells_the_tendon_of_its_own_muscle(known) -> None:
    assert known["tib"]["dlt_tib"] < 0.6 * known[""]["dlt_tib"]
    assert known["gm"]["dlt_tri"] < 0.8 * known[""]["dlt_tri"]
    assert known["tib"]["dlt_tri"] > 0.8 * known[""]["dlt_tri"]
    for film in ("tib", "gm"):
        assert all(known[film][n] <= 1.001 * half for n, half in known[""].items())


def test_the_fascicle_seen_is_no_ruler_of_the_whole_muscle(trial) -> None:
    legs = filmed(population_legs("auto", None, 1), ("tib",))
    assert legs.free[-2:] == ("film_scale_tib", "film_zero_tib")
    assert {"film_scale_tib", "film_zero_tib"} <= legs.priors.keys()
    (matrix,) = information(trial, legs, 0.5).matrices
    scale, zero, length = (
        legs.free.index(n) for n in ("film_scale_tib", "film_zero_tib", "length_zero_tib")
    )
    assert matrix[zero, zero] > 0.0
    # a longer fascicle and a longer muscle look alike
    alike = matrix[zero, scale] / np.sqrt(matrix[zero, zero] * matrix[scale, scale])
    assert alike > 0.7
    assert matrix[zero, length] > 0.0


def test_what_no_film_can_tell_is_refused(trial) -> None:
    with pytest.raises(InputError, match="rigid tendons"):
        surae.design(12.0, model="muscle", rate_hz=32.0, film="tib")
    with pytest.raises(InputError, match="rigid tendons"):
        surae.expect(trial, model="muscle", film="tib", legs=1)
    with pytest.raises(InputError, match="no muscle 'ta'"):
        surae.expect(trial, film="ta", legs=1)
