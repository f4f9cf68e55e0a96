import pytest

from surae.base.errors import InputError
from surae.signals import Preparation


def test_defaults_are_the_thesis_reading() -> None:
    settings = Preparation()
    assert settings.rate_hz == 256.0
    assert (settings.emg_highpass_hz, settings.emg_highpass_order) == (41.0, 3)
    assert settings.emg_lowpass_hz is None
    assert (settings.bessel_hz, settings.bessel_order) == (20.0, 4)


def test_mapping_overrides_only_what_it_names() -> None:
    settings = Preparation().updated({"rate_hz": 125, "emg_lowpass_hz": 3.0})
    assert settings == Preparation(rate_hz=125, emg_lowpass_hz=3.0)
    assert settings.updated({"rate_hz": 100}) == Preparation(rate_hz=100, emg_lowpass_hz=3.0)


@pytest.mark.parametrize("name", ["emg_highpass_hz", "emg_lowpass_hz", "bessel_hz"])
def test_false_switches_a_filter_off(name: str) -> None:
    assert getattr(Preparation().updated({name: False}), name) is None


def test_unknown_setting_lists_the_known_ones() -> None:
    with pytest.raises(InputError, match=r"'cutoff' is not known; use one of: rate_hz, .*bessel"):
        Preparation().updated({"cutoff": 3})


@pytest.mark.parametrize(
    ("name", "value"),
    [
        ("rate_hz", 0),
        ("rate_hz", False),
        ("rate_hz", None),
        ("rate_hz", "256"),
        ("rate_hz", float("inf")),
        ("emg_highpass_hz", -41.0),
        ("bessel_hz", True),
        ("bessel_hz", float("nan")),
        ("bessel_order", 0),
        ("bessel_order", 11),
        ("bessel_order", 4.0),
        ("emg_highpass_order", True),
        ("emg_lowpass_order", False),
    ],
)
def test_value_that_is_not_allowed(name: str, value: object) -> None:
    with pytest.raises(InputError, match=f"prepare: {name} is {value!r}; give ") as error:
        Preparation().updated({name: value})
    assert "\n" not in str(error.value)
