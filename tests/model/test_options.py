"""The switches of the models: defaults, allowed values, refusals."""

import re

import pytest

from surae.base.errors import InputError
from surae.model import ModelOptions


def test_defaults_are_the_thesis() -> None:
    options = ModelOptions()
    assert options.geometry == "thesis"
    assert options.tendon_strain == "thesis"
    assert options.integrator == "implicit"
    assert options.vmax_factor == 8.0
    assert options.theta_foot == 0.0


@pytest.mark.parametrize(
    ("given", "message"),
    [
        (
            {"geometry": "cylinder"},
            "geometry is 'cylinder'; use one of: thesis, virtual-work, or a file's path",
        ),
        (
            {"geometry": None},
            "geometry is None; use one of: thesis, virtual-work, or a file's path",
        ),
        (
            {"tendon_strain": "metres"},
            "tendon_strain is 'metres'; use one of: thesis, slack-length",
        ),
        (
            {"integrator": "rk4"},
            "integrator is 'rk4'; use one of: implicit, explicit-euler, explicit-damped",
        ),
        ({"theta_foot": "0"}, "theta_foot is '0'; give a number"),
        ({"theta_foot": float("inf")}, "theta_foot is inf; give a number"),
        ({"vmax_factor": float("nan")}, "vmax_factor is nan; give a number"),
        ({"vmax_factor": True}, "vmax_factor is True; give a number"),
        ({"vmax_factor": 0}, "vmax_factor is 0; give more than 0"),
        ({"x_ref_tri": -0.1}, "x_ref_tri is -0.1; give more than 0"),
        ({"x_ref_tib": 0.0}, "x_ref_tib is 0.0; give more than 0"),
        (
            {"gravity": 9.81},
            "option 'gravity' is not known; use one of: geometry, tendon_strain, integrator, "
            "theta_foot, vmax_factor, x_ref_tri, x_ref_tib, emg_ref, joint, tissue",
        ),
        ({"tissue": "stiff"}, "tissue is 'stiff'; give a TissueCurve"),
        ({"tissue": "stiff.csv"}, "tissue is 'stiff.csv'; give a TissueCurve"),
    ],
)
def test_refusals(given, message) -> None:
    with pytest.raises(InputError, match=f"^{re.escape(message)}$"):
        ModelOptions.of(**given)


def test_as_plain_data_and_back() -> None:
    options = ModelOptions(geometry="virtual-work", theta_foot=0.3)
    assert ModelOptions.of(**options.as_dict()) == options
