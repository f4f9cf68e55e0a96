"""Arrays of others: what is no real number is refused, with the way out."""

from decimal import Decimal

import numpy as np
import pytest

import surae
from surae.base.numbers import real_numbers

pandas = pytest.importorskip("pandas")
N = 400
T = np.arange(N) / 100.0


@pytest.mark.parametrize(
    ("values", "what"),
    [
        (np.ma.masked_array([1.0, 2.0], mask=[False, True]), "masked"),
        (np.array([1.0 + 2.0j, 3.0]), "complex"),
        (np.array([True, False]), "True and False"),
        (np.array([1.0, "2"], dtype=object), "but str too"),
        (np.array([1.0, True], dtype=object), "but bool too"),
        (np.array([1.0, 2.0j], dtype=object), "but complex too"),
        (np.array([1.0, object()], dtype=object), "but object too"),
        (np.array(["1", "2"]), "no numbers"),
        (np.array(["2026-01-01"], dtype="M8[s]"), "no numbers"),
        (pandas.Series([1.0, 2.0]).astype("category"), "categories"),
        (pandas.Series([True, False]), "True and False"),
    ],
)
def test_what_is_no_real_number_is_refused(values, what) -> None:
    with pytest.raises(ValueError, match=what):
        real_numbers(values)


@pytest.mark.parametrize(
    "values",
    [
        [1, 2],
        np.array([1, 2], dtype=np.uint16),
        np.ma.masked_array([1.0, 2.0], mask=False),
        np.array([1, 2.0], dtype=object),
        np.array([Decimal(1), 2], dtype=object),
        pandas.Series([1.0, 2.0], dtype="Float64"),
        pandas.Series([1, 2], dtype="Int64"),
    ],
)
def test_numbers_of_every_kind_are_taken(values) -> None:
    taken = real_numbers(values)
    assert taken.tolist() == [1.0, 2.0]
    assert not taken.flags.writeable


def test_a_missing_number_is_none() -> None:
    series = pandas.Series([1.0, pandas.NA], dtype="Float64")
    assert np.isnan(real_numbers(series)).tolist() == [False, True]
    assert np.isnan(real_numbers(np.array([None, 1], dtype=object))).tolist() == [True, False]


def test_arrays_of_a_recording_say_which() -> None:
    with pytest.raises(surae.InputError, match=r"arrays: torque is not an array of .*complex"):
        surae.Recording.from_arrays(T, np.sin(T), np.sin(T) + 1j)
    masked = np.ma.masked_greater(np.sin(T), 0.9)
    with pytest.raises(surae.InputError, match=r"arrays: angle is not an array of .*masked"):
        surae.Recording.from_arrays(T, masked)


def frame(**columns: object):
    base = {"time_s": T, "angle_rad": 0.2 * np.sin(T), "torque_Nm": np.cos(T)}
    return pandas.DataFrame({**base, **columns})


def test_columns_of_a_frame_say_which() -> None:
    with pytest.raises(surae.InputError, match="'torque_Nm' holds categories"):
        surae.check(frame(torque_Nm=pandas.Series(np.cos(T)).astype("category")))
    gaps = pandas.Series(np.cos(T), dtype="Float64")
    gaps[7] = pandas.NA
    with pytest.raises(surae.InputError, match=r"torque_Nm.*row 7|row 7.*torque_Nm|row 8"):
        surae.check(frame(torque_Nm=gaps))


def test_time_stamps_of_a_zone_are_times() -> None:
    index = pandas.date_range("2026-10-25 00:59:58", periods=N, freq="10ms", tz="UTC")
    index = index.tz_convert("Europe/Amsterdam")
    plain = surae.check(frame()).findings
    zoned = frame().drop(columns="time_s").set_index(index)
    assert surae.check(zoned).findings == plain  # across the end of summer time, too
