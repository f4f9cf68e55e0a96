"""Units as laboratories spell them."""

import math

import pytest

from surae.base.units import FACTORS, spelled, stated


@pytest.mark.parametrize(
    ("text", "unit"),
    [
        *((text, "Nm") for text in ("Nm", "N m", "N.m", "N·m", "N-m", "N*m", "Newton-Meters")),
        *((text, "Nm") for text in ("newton metre", "NEWTON METERS", "n·M")),
        *((text, "deg") for text in ("°", "Degrees", "deg", "degree", "Grad", "grad", "graden")),
        ("Grad/s", "deg/s"),
        *((text, "uV") for text in ("µV", "μV", "uV", "microvolts")),
        *((text, "s") for text in ("sec", "Seconds", "s")),
        *((text, None) for text in ("", "N", "counts", "left", "9**9**9", "m" * 100, "%")),
    ],
)
def test_spellings(text, unit):
    assert spelled(text) == unit


@pytest.mark.parametrize(
    ("text", "kind", "si"),
    [
        ("ft-lbs", "torque", 0.3048 * 0.45359237 * 9.80665),
        ("foot-pounds", "torque", 0.3048 * 0.45359237 * 9.80665),
        ("in·lbf", "torque", 0.0254 * 0.45359237 * 9.80665),
        ("kgf*cm", "torque", 0.0980665),
        ("kN m", "torque", 1000.0),
        ("Ncm", "torque", 0.01),
        ("ftlb", "torque", 0.3048 * 0.45359237 * 9.80665),
        ("N cm", "torque", 0.01),
        ("mrad", "angle", 1e-3),
        ("rev", "angle", 2 * math.pi),
        ("gon", "angle", math.pi / 200),
        ("rpm", "angular_velocity", 2 * math.pi / 60),
        ("nV", "emg", 1e-9),
        ("inches", "length", 0.0254),
        ("min", "time", 60.0),
        ("% MVC", "emg", 0.01),
    ],
)
def test_units_of_other_systems_are_read_by_pint(text, kind, si):
    read = stated(text)
    assert read.kind == kind
    assert read.scale * FACTORS[kind][read.unit] == pytest.approx(si, rel=1e-9)
    assert not read.per_kg


@pytest.mark.parametrize("text", ["Nm/kg", "N.m/kg", "Nm kg^-1", "Nm per kg", "Nm·kg⁻¹"])
def test_a_torque_per_body_mass_says_so(text):
    assert (stated(text).kind, stated(text).unit, stated(text).per_kg) == ("torque", "Nm", True)


@pytest.mark.parametrize("text", ["N", "g", "lb", "N/m", "Hz", "m/s²"])
def test_what_no_channel_has_is_another_kind(text):
    assert stated(text).kind == "other"


@pytest.mark.parametrize(
    "text", [None, "", "left", "counts", "9**9**9", "ft-lb " * 999, "lb-" * 40]
)
def test_what_is_no_unit_says_nothing(text):
    assert stated(text) is None
