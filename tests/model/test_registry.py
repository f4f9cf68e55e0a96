"""Models by name, parameter tables, and the refusals of parameter values."""

import re

import numpy as np
import pytest

from surae.base.errors import InputError
from surae.base.units import FloatArray
from surae.model import MODELS, ModelOptions, adapted, check_names, check_value, get_model
from surae.model.parameters import MUSCLE_PARAMETERS

#: In the order of the specification.
FIFTEEN = [
    "m",
    "k_tri",
    "k_tib",
    "x0_tri",
    "x0_tib",
    "tau_rel",
    "k_rel",
    "g1",
    "g2",
    "g3",
    "g4",
    "l0_tri",
    "l0_tib",
    "f0",
    "beta",
]
THESIS = ModelOptions()
MUSCLE = get_model("muscle")
GIVEN = {p.name: p.start for p in MUSCLE_PARAMETERS}
every_model = pytest.mark.parametrize("name", MODELS)
VARIANTS = {
    f"{geometry}, {unit}": (ModelOptions(geometry=geometry), unit)
    for geometry in ("thesis", "virtual-work")
    for unit in ("V", "1")
}


def vector(**changes: float) -> FloatArray:
    return MUSCLE.vector({**GIVEN, **changes}, THESIS)


def test_unknown_model() -> None:
    message = f"model 'hill' is not known; use one of: {', '.join(MODELS)}"
    with pytest.raises(InputError, match=f"^{re.escape(message)}$"):
        get_model("hill")


def test_the_muscle_model_has_the_fifteen_parameters_in_order() -> None:
    assert list(MUSCLE.names) == FIFTEEN
    assert list(MUSCLE.free) == FIFTEEN


@every_model
def test_every_model_is_consistent(name) -> None:
    spec = MODELS[name]
    assert spec.name == name
    assert spec.title
    assert len(set(spec.names)) == len(spec.names)
    assert set(spec.free) <= set(spec.names)
    assert [p for p in spec.names if p in spec.free] == list(spec.free)
    assert all(p.meaning and p.unit for p in spec.parameters)
    assert {p.group for p in spec.parameters} <= {"limb", "passive", "active", "tendon"}


@every_model
@pytest.mark.parametrize("variant", VARIANTS)
def test_starts_are_within_bounds_that_are_physical(name, variant) -> None:
    for p in adapted(MODELS[name].parameters, *VARIANTS[variant]).values():
        assert p.lower < p.start < p.upper, p.name
        assert p.lower > 0 if p.positive else p.signed or p.lower >= 0, p.name


def test_bounds_contain_the_plausible_values_of_the_specification() -> None:
    plausible = {
        "m": (1.2, 3.0),
        "k_tri": (200, 220),
        "x0_tri": (0.014, 0.018),
        "tau_rel": (1, 10),
        "k_rel": (0.1, 0.6),
        "l0_tri": (0.038, 0.050),
        "l0_tib": (0.066, 0.09),
        "f0": (2, 2),
        "g2": (0.3e6, 4e6),
    }
    table = adapted(MUSCLE_PARAMETERS, THESIS)
    for name, (low, high) in plausible.items():
        assert table[name].lower <= low <= high <= table[name].upper, name
    assert (table["m"].lower, table["m"].upper) == (1.2, 3.0)  # equation (6)
    assert table["beta"].start == 1.0 or table["beta"].lower < 1.0 < table["beta"].upper


def test_adapted_changes_only_what_geometry_and_unit_touch() -> None:
    plain = adapted(MUSCLE_PARAMETERS, THESIS)
    assert tuple(plain.values()) == MUSCLE_PARAMETERS
    normalised = adapted(MUSCLE_PARAMETERS, THESIS, "1")
    changed = [name for name in plain if plain[name] != normalised[name]]
    assert changed == ["g1", "g2", "g3", "g4"]
    assert {normalised[name].unit for name in changed} == {"N"}
    longer = adapted(MUSCLE_PARAMETERS, ModelOptions(geometry="virtual-work"))
    changed = [name for name in plain if plain[name] != longer[name]]
    assert changed == ["k_tri", "k_tib", "x0_tri", "x0_tib", "l0_tri", "l0_tib"]
    both = adapted(MUSCLE_PARAMETERS, ModelOptions(geometry="virtual-work"), "1")
    assert both == {**longer, **{name: normalised[name] for name in ("g1", "g2", "g3", "g4")}}


@every_model
def test_what_a_model_says_of_its_structure_is_among_its_parameters(name) -> None:
    spec = MODELS[name]
    roles = [*spec.linear, *spec.slack, *spec.scanned, *spec.slack.values()]
    assert set(roles) <= set(spec.names)
    assert len(set(roles)) == len(roles)
    assert [p.name for p in spec.parameters if p.unit == "N/V"] == list(spec.weights)
    if spec.parent is None:  # where its linear parameters are solved
        assert set(spec.weights) < set(spec.linear)


def test_vector_is_in_the_order_of_the_model_not_of_the_mapping() -> None:
    values = {name: float(i + 1) for i, name in enumerate(FIFTEEN)}
    backwards = dict(reversed(values.items()))
    p = MUSCLE.vector(backwards, THESIS)
    assert p.dtype == np.float64
    assert p.tolist() == [float(i + 1) for i in range(15)]


@every_model
def test_vector_fills_in_what_is_not_free(name) -> None:
    spec = MODELS[name]
    for options, _ in VARIANTS.values():
        table = adapted(spec.parameters, options)
        given = {p: 1.5 * table[p].start for p in spec.free}
        expected = [given.get(p, table[p].start) for p in spec.names]
        assert spec.vector(given, options).tolist() == expected


@pytest.mark.parametrize(
    ("changes", "message"),
    [
        ({"mass": 2.0}, f"model 'muscle' has no parameter 'mass'; it has: {', '.join(FIFTEEN)}"),
        ({"m": float("nan")}, "muscle: m is nan; give a finite number"),
        ({"f0": float("inf")}, "muscle: f0 is inf; give a finite number"),
        ({"m": "2"}, "muscle: m is '2'; give a finite number"),
        ({"m": None}, "muscle: m is None; give a finite number"),
        ({"m": True}, "muscle: m is True; give a finite number"),
        ({"m": -1.0}, "muscle: m is -1 kg; it must be zero or more"),
        ({"g3": -1e6}, "muscle: g3 is -1e+06 N/V; it must be zero or more"),
        ({"k_rel": -0.1}, "muscle: k_rel is -0.1; it must be zero or more"),
        ({"beta": 0.0}, "muscle: beta is 0; it must be above zero"),
        ({"tau_rel": 0}, "muscle: tau_rel is 0 s; it must be above zero"),
        ({"l0_tib": -0.01}, "muscle: l0_tib is -0.01 m; it must be above zero"),
    ],
)
def test_refusals(changes, message) -> None:
    with pytest.raises(InputError, match=f"^{re.escape(message)}$"):
        vector(**changes)


def test_missing_parameters_are_listed() -> None:
    given = {name: value for name, value in GIVEN.items() if name not in ("g2", "beta")}
    with pytest.raises(InputError, match=r"^model 'muscle' needs a value for: g2, beta$"):
        MUSCLE.vector(given, THESIS)


def test_a_limit_of_zero_is_allowed_where_the_equations_have_a_meaning() -> None:
    p = vector(m=0.0, k_rel=0.0, g1=0.0)
    assert p[[0, 6, 7]].tolist() == [0.0, 0.0, 0.0]


def test_values_outside_the_bounds_of_a_fit_can_be_simulated() -> None:
    assert vector(m=50.0)[0] == 50.0


def test_names_and_values_can_be_checked_on_their_own() -> None:
    check_names(("m", "beta"), MUSCLE)
    check_value(MUSCLE.parameters[0], 2.0, MUSCLE)
    with pytest.raises(InputError, match="no parameter 'etoe'"):
        check_names({"m": 1, "etoe": 2}, MUSCLE)


@every_model
def test_every_model_simulates_its_starts(name, make_inputs) -> None:
    spec = MODELS[name]
    inputs = make_inputs(0, seconds=1.0)
    p = spec.vector({q.name: q.start for q in spec.parameters}, THESIS)
    simulator = spec.simulator(inputs, THESIS)
    torque = simulator.torque(p)
    assert torque.shape == (inputs.n,)
    assert np.isfinite(torque).all()
    assert np.abs(torque).max() < 300
