"""Files that no reader takes, commanded profiles, and the command."""

import json

import numpy as np
import pytest

import surae
from surae.base.errors import InputError
from surae.protocol import Protocol, generate, write_protocol_csv
from surae.quality import recording_of
from surae.recording import csv_columns
from surae.recording import write_csv as write_recording


@pytest.fixture
def table(noisy) -> dict[str, np.ndarray]:
    return {name: np.array(values) for name, values in csv_columns(recording_of(noisy)).items()}


def write(path, table) -> None:
    rows = np.column_stack(list(table.values()))
    header = f"# emg: envelope\n{','.join(table)}"
    np.savetxt(path, rows, delimiter=",", header=header, comments="", fmt="%.10g")


def codes(quality) -> list[str]:
    return [finding.code for finding in quality.findings]


def test_a_time_that_goes_back_is_a_finding(tmp_path, table) -> None:
    table["time_s"][500:510] = table["time_s"][500:510][::-1]
    write(tmp_path / "back.csv", table)
    with pytest.raises(InputError):
        surae.read(tmp_path / "back.csv")
    quality = surae.check(tmp_path / "back.csv")
    assert quality.findings[0].code == "time-jitter"
    assert quality.findings[0].severity == "error"
    assert quality.findings[0].value == 9


def test_missing_samples_are_a_finding_and_the_rest_is_checked(tmp_path, table) -> None:
    table["torque_Nm"] *= -1.0
    table["torque_Nm"][300:310] = np.nan
    write(tmp_path / "nan.csv", table)
    quality = surae.check(tmp_path / "nan.csv")
    assert {"samples-missing", "torque-sign"} <= set(codes(quality))
    assert "time-gap" not in codes(quality)
    assert "row 303" in quality.findings[0].message + quality.findings[1].message


@pytest.mark.parametrize("text", ["", "time_s,angle_rad\n0,x\n", "a,b\n1,2\n"])
def test_what_cannot_be_read_at_all_is_refused(tmp_path, text) -> None:
    (tmp_path / "bad.csv").write_text(text)
    with pytest.raises(InputError):
        surae.check(tmp_path / "bad.csv")


def test_a_commanded_profile_from_a_file_or_a_column(tmp_path, table) -> None:
    asked = Protocol(profile="multiple-holds", chirp_amplitude=0.2, chirp_rate=0.5, rate_hz=125.0)
    write_protocol_csv(generate(asked), tmp_path / "p.csv")
    commanded = table["angle_rad"].copy()
    away = (table["time_s"] > 15.0) & (table["time_s"] < 15.5)
    table["angle_rad"][away] += 0.1 * np.sin(np.pi * (table["time_s"][away] - 15.0) / 0.5)
    write(tmp_path / "trial.csv", table)
    by_file = surae.check(tmp_path / "trial.csv", commanded=tmp_path / "p.csv")
    write(tmp_path / "both.csv", {**table, "commanded_angle_rad": commanded})
    by_column = surae.check(tmp_path / "both.csv")
    for quality in (by_file, by_column):
        (overshoot,) = [finding for finding in quality.findings if finding.code == "overshoot"]
        assert "the commanded profile" in overshoot.message
        assert overshoot.value == pytest.approx(0.1, abs=0.02)
        assert (overshoot.start_s, overshoot.end_s) == pytest.approx((15.0, 15.5), abs=0.15)
    with pytest.raises(InputError, match="no column angle_rad"):
        surae.check(tmp_path / "trial.csv", commanded=_without_angle(tmp_path))


def _without_angle(folder):
    (folder / "no.csv").write_text("time_s,x\n0,1\n1,2\n")
    return folder / "no.csv"


@pytest.mark.usefixtures("undrawn")
def test_findings_go_into_the_fit_and_come_back(tmp_path, noisy) -> None:
    wrong = recording_of(noisy)
    table = csv_columns(wrong) | {"torque_Nm": wrong.channels["torque"].values + 15.0}
    write_recording(tmp_path / "offset.csv", table, ["emg: envelope"])
    fit = surae.fit(tmp_path / "offset.csv", "muscle", prepared=True, starts=1)
    assert codes(fit.quality[0]) == ["torque-offset"]
    fit.save(tmp_path / "fit.json")
    (saved,) = json.loads((tmp_path / "fit.json").read_text())["findings"]
    assert saved["findings"][0]["code"] == "torque-offset"
    again = surae.load(tmp_path / "fit.json")
    assert again.quality == fit.quality
    again.report(tmp_path / "report.html")
    page = (tmp_path / "report.html").read_text()
    assert "What was found in the recordings" in page
    assert fit.quality[0].findings[0].message in page


@pytest.mark.usefixtures("undrawn")
def test_a_fit_without_findings_says_so_in_its_report(tmp_path, noisy) -> None:
    fit = surae.fit(noisy, "muscle", starts=1)
    assert fit.quality[0].findings == ()
    fit.report(tmp_path / "report.html")
    assert "Nothing was found." in (tmp_path / "report.html").read_text()


@pytest.mark.parametrize(
    "header",
    [
        "Zeit [ms];Winkel [deg];Drehmoment [Nm];EMG_TA [mV];EMG_SOL [mV]",
        "tijd [ms];hoek enkel [deg];koppel [Nm];EMG TA [mV];EMG SOL [mV]",
        "Temps [ms];Angle cheville [deg];Couple [Nm];EMG tibial antérieur [mV];EMG soléaire [mV]",
    ],
)
def test_a_check_reads_other_languages_columns_and_says_so(tmp_path, header) -> None:
    time = np.arange(3000.0)
    angle = 15.0 * np.sin(2e-3 * np.pi * 0.5 * time)
    emg = np.random.default_rng(0).standard_normal((3000, 2)) * 0.01
    rows = np.column_stack([time, angle, 3.0 + 0.3 * angle, emg])
    lines = [";".join(f"{x:.6g}".replace(".", ",") for x in row) for row in rows]
    (tmp_path / "a.csv").write_text("\n".join([header, *lines]), encoding="utf-8")
    said = [f.message for f in surae.check(tmp_path / "a.csv").findings if f.code == "as-read"]
    assert len(said) == 1
    assert "taken for what its column's name and unit say" in said[0]
    with pytest.raises(InputError, match="surae inspect"):
        surae.read(tmp_path / "a.csv")  # a fit takes nothing that nobody has seen
    without = header.replace(" [deg]", "")  # no unit is guessed
    (tmp_path / "b.csv").write_text("\n".join([without, *lines]), encoding="utf-8")
    with pytest.raises(InputError, match=r"unit of .* is not known"):
        surae.check(tmp_path / "b.csv")
