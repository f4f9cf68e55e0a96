"""Advice goes with every parameter of every model."""

import re

import pytest

from surae.inference.identifiability.advice import TRADE_OFFS, trade_off
from surae.model import MODELS
from surae.model.registry import PARAMETERS


def test_every_parameter_has_advice_and_trade_offs_are_of_parameters():
    names = {"f", "b_tri", "F0", "e1", "e2", "e3", "e4", *PARAMETERS}
    assert all(p.advice for p in PARAMETERS.values())
    assert all(p.advice for spec in MODELS.values() for p in spec.parameters)
    for known in TRADE_OFFS:
        assert known.names | known.beside <= names
        assert not known.names & known.beside


def test_advice_is_part_of_a_sentence():
    every = [*(p.advice for p in PARAMETERS.values()), *(t.advice for t in TRADE_OFFS)]
    assert [text for text in every if not re.fullmatch(r"(EMG |[a-z])(.*[^.\s])?", text)] == []


@pytest.mark.parametrize(
    ("name", "partner", "says"),
    [
        ("k_tib", "x0_tib", "more plantarflexion"),
        ("x0_tri", "k_tri", "more dorsiflexion"),
        ("tau_rel", "k_rel", "passive part"),
        ("g2", "g4", "vary apart"),
        ("e2", "e3", "vary apart"),
        ("dlt_tib", "pt_tib", "past the toe"),
        ("pt_tri", "dlt_tri", "past the toe"),
        ("g3", "l0_tri", "range of motion while the triceps"),
        ("l0_tib", "g1", "range of motion while the tibialis"),
        ("f0", "beta", "faster bursts"),
        ("k_rel", "x0_tri", "hold longer"),
    ],
)
def test_it_is_specific_to_the_pair(name, partner, says):
    for one, other in ((name, partner), (partner, name)):
        known = trade_off(one, (other,))
        assert known is not None
        assert says in known.advice


def test_rigid_tendons_are_not_told_of_compliance():
    tendons = {"dlt_tri", "pt_tri", "kt_tri", "fmax_tri", "dlt_tib", "pt_tib", "kt_tib", "fmax_tib"}
    names = MODELS["muscle"].names
    for name in names:
        for partner in names:
            known = trade_off(name, (partner,)) if name != partner else None
            assert known is None or not (known.names & tendons)


def test_the_strongest_known_partner_decides():
    assert trade_off("k_tib", ("m", "x0_tib")) is trade_off("k_tib", ("x0_tib",))
    assert trade_off("k_tib", ("m", "f0")) is None
    assert trade_off("k_tib", ()) is None
