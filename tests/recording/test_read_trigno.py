"""Delsys Trigno exports, and CSV in its other shapes."""

import numpy as np
import pytest
from reader_seeds import csv_file, trigno_file, tsv_file

from surae.base.errors import InputError
from surae.recording import read
from surae.recording.table import load_each, sampling_of


def test_every_signal_has_its_own_times_and_unit(table):
    contents = table(trigno_file())
    assert contents.format == "Trigno"
    columns = contents.load(["ACC.X 1", "EMG 1"])
    np.testing.assert_allclose(columns["EMG 1"].time, np.arange(8) / 100)
    np.testing.assert_allclose(columns["EMG 1"].values, np.arange(8) * 1e-6)
    np.testing.assert_allclose(columns["ACC.X 1"].time, np.arange(4) / 50)
    assert columns["ACC.X 1"].position(2) == "row 8"
    rates = {
        name: (contents.units.get(name), sampling_of(column.time).rate_hz)
        for name, column in contents.load(contents.names).items()
    }
    assert rates["EMG 1"] == ("V", pytest.approx(100))
    assert rates["ACC.X 1"] == ("g", pytest.approx(50))


def test_an_export_without_the_header_is_read_but_states_no_units(table):
    columns = table(trigno_file().split(b"\n\n")[1])
    assert (columns.names, dict(columns.units)) == (("EMG 1", "ACC.X 1"), {})


def test_a_row_that_was_cut_off_is_left_out_and_said(table):
    columns = table(trigno_file()[:-4])
    assert len(columns.load(["EMG 1"])["EMG 1"].values) == 7
    assert columns.remarks == {
        "EMG 1": "cut short: the header states 8 samples, the file has 7 rows"
    }


@pytest.mark.parametrize(
    ("change", "says"),
    [
        ((b"0.03,3e-6", b",3e-6"), r"column 'EMG 1', row 9: the cell is blank"),
        ((b"0.03,3e-6", b","), r"column 'EMG 1', row 10: samples follow after blank cells"),
        ((b"3e-6", b"x"), r"row 9: 'x' is not a number"),
        ((b'X[s],"ACC.X 1"', b'"ACC.X 1"'), r"expected a column X\[s\] of times"),
        ((b"V Domain Unit: s", b"V Domain Unit: Hz"), "a function of 'Hz', not of time"),
    ],
)
def test_errors(table, change, says):
    with pytest.raises(InputError, match=says):
        table(trigno_file().replace(*change)).load(["EMG 1"])


def test_tabs_and_semicolons_separate_and_decimals_may_have_a_comma(tmp_path):
    path = tmp_path / "data"
    values = []
    for data in (csv_file(), tsv_file(), csv_file().replace(b",", b";")):
        path.write_bytes(data)
        values.append(read(path).channels["torque"].values)
    np.testing.assert_array_equal(values[0], values[1])
    np.testing.assert_array_equal(values[0], values[2])
    path.write_bytes(csv_file().replace(b",", b";").replace(b".", b","))
    np.testing.assert_array_equal(values[0], read(path).channels["torque"].values)


def test_what_a_text_table_holds_is_found_from_its_samples(table):
    data = csv_file().replace(b",note", b",note,jitter").replace(b"e-6,", b"e-6,word,")
    text = table(data)
    columns = load_each(text, text.names)
    sampling = sampling_of(columns["angle_rad"].time)
    assert (sampling.rate_hz, sampling.start_s) == (pytest.approx(1.0), 0.5)
    assert text.units["angle_rad"] == "rad"
    assert np.isnan(columns["note"].values).all()
    assert columns["note"].reason(2) == "'word' is not a number"
