"""p-values of several claims, against numbers worked out by hand."""

import numpy as np
import pytest

from surae.measures.claims import false_discovery, holm

P = {"a": 0.01, "b": 0.04, "c": 0.03, "d": 0.8}


def test_holm() -> None:
    assert holm(P) == pytest.approx({"a": 0.04, "b": 0.09, "c": 0.09, "d": 0.8})


def test_benjamini_and_hochberg() -> None:
    wanted = {"a": 0.04, "b": 4 / 3 * 0.04, "c": 4 / 3 * 0.04, "d": 0.8}
    assert false_discovery(P) == pytest.approx(wanted)
    assert list(false_discovery(P)) == list(P)
    assert false_discovery({}) == holm({}) == {}


def test_where_nothing_is_true_few_sets_have_a_claim() -> None:
    rng = np.random.default_rng(3)
    sets = rng.uniform(size=(2000, 20))
    for method in (holm, false_discovery):
        any_claim = [
            min(method({str(i): float(p) for i, p in enumerate(row)}).values()) < 0.05
            for row in sets
        ]
        assert 0.03 < np.mean(any_claim) < 0.065
