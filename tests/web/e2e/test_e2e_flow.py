"""From a file to a report, as someone does it who does not program."""

import re
from pathlib import Path
from typing import Any

import numpy as np
import pytest

from surae.recording import write_csv

from .conftest import DAY, MUSCLES, WHOLE, Desk, Server, expect

PARAMETERS = 15


def start_fit(desk: Desk, recording: str, starts: int) -> Any:
    """The bench with a recording chosen and a fit begun."""
    change = {"recordings": [recording], "model": "muscle", "starts": starts}
    desk.api("PATCH", "/api/draft", {"change": change, "label": "choose"})
    page = desk.go("/fit")
    page.get_by_role("button", name="Fit", exact=True).click()
    page.get_by_role("progressbar").wait_for()
    return page


def test_a_csv_becomes_a_report(desk: Desk, csv: Path) -> None:
    desk.add(csv)
    desk.api("PATCH", "/api/draft", {"change": {"model": "muscle"}, "label": "choose"})
    page = desk.page
    # A unit is told with the data: then there is something to drag over.
    page.get_by_role("heading", name="Torque, triceps positive [Nm]").wait_for()
    page.get_by_text("The check found").or_(page.get_by_text("of the check")).wait_for()

    page.get_by_label("From [s]").fill("4")
    page.get_by_label("To [s]").fill("5.5")
    page.get_by_role("button", name="Exclude", exact=True).click()
    page.get_by_role("button", name="Include 4.00 to 5.50 s again").wait_for()

    page.get_by_role("button", name="Drag to exclude").click()
    over = page.locator(".u-over").last
    over.scroll_into_view_if_needed()
    box = over.bounding_box()
    middle = box["y"] + box["height"] / 2
    page.mouse.move(box["x"] + 0.5 * box["width"], middle)
    page.mouse.down()
    page.mouse.move(box["x"] + 0.6 * box["width"], middle, steps=5)
    page.mouse.up()
    expect(page.locator("#exclusions button")).to_have_count(2)
    page.get_by_role("button", name=re.compile("Undo: exclude")).click()
    expect(page.locator("#exclusions button")).to_have_count(1)

    page.get_by_role("button", name="Fit this recording").click()
    page.wait_for_url("**/fit")
    page.get_by_text("1.50 s left out").wait_for()
    page.get_by_text("More settings").click()
    page.get_by_label("Starts").fill("2")
    page.get_by_label("Starts").press("Tab")
    page.get_by_role("button", name=re.compile("Undo: Starts 2")).wait_for()
    page.get_by_role("button", name="Fit", exact=True).click()
    page.get_by_role("link", name="Open the result").click()

    page.wait_for_url("**/fits/*")
    rows = page.locator(".report .parameters tbody tr:not(.group, .below)")
    rows.first.wait_for(state="attached")
    assert rows.count() == PARAMETERS
    # what rests on no arm and no path
    assert page.locator(".report .parameters .verdict.identified").count() >= 5
    expect(page.locator("article.report")).to_contain_text("converged")
    with page.expect_download() as report:
        page.get_by_role("button", name="Report (HTML)").click()
    text = Path(report.value.path()).read_text(encoding="utf-8")
    assert text.lstrip().lower().startswith("<!doctype html>")
    assert "walk-in" in text


@pytest.mark.slow  # test_web_recordings.py imports without a browser
def test_the_trials_of_a_leg_come_in_at_once(desk: Desk, csv: Path, tmp_path: Path) -> None:
    """One description, a recording each."""
    for name in ("walk a", "walk b"):
        (tmp_path / f"{name}.csv").write_text(csv.read_text())
    page = desk.go("/import")
    page.set_input_files("#files", sorted(tmp_path.glob("*.csv"), reverse=True))
    page.get_by_text("The settings below apply to all").wait_for()
    page.get_by_label("Day of the visit").fill(DAY)
    page.get_by_role("button", name="Import 2 recordings").click()
    page.get_by_role("link", name="walk a").first.wait_for()
    names = [one["name"] for one in desk.api("GET", "/api/recordings")["recordings"]]
    assert {"walk a", "walk b"} <= set(names)


@pytest.mark.slow
def test_who_was_left_behind_lends_nothing_to_the_next(
    desk: Desk, csv: Path, tmp_path: Path
) -> None:
    """Files of a leg whose import was left, and those of another leg with the same names."""
    legs = {who: tmp_path / f"{who} left 4 maart 2026" for who in ("S21", "S22")}
    for folder in legs.values():
        folder.mkdir()
        for name in ("trial 2", "trial 10"):
            (folder / f"{name}.csv").write_text(csv.read_text())
    page = desk.go("/import")
    page.set_input_files("#folder", legs["S21"])
    page.get_by_text("2 trials found").wait_for()
    assert page.get_by_label("Day of the visit").input_value() == "2026-03-04"
    assert page.get_by_label("Subject").input_value() == "new:S21"
    page.get_by_label("Day of the visit").fill("2026-01-01")
    order = [page.locator("details.of-trial summary strong").nth(i) for i in (0, 1)]
    expect(order[0]).to_have_text("trial 2.csv")  # as they are counted
    expect(order[1]).to_have_text("trial 10.csv")

    page.reload()
    page.get_by_text("2 files are here from before").wait_for()
    assert not page.locator("#uploads-card").is_visible()
    page.set_input_files("#folder", legs["S22"])  # which is an answer, too
    page.get_by_text("2 trials found").wait_for()
    assert page.locator("#uploads li").count() == 2
    assert page.get_by_label("Subject").input_value() == "new:S22"
    assert page.get_by_label("Day of the visit").input_value() == "2026-03-04"

    page.get_by_label("Day of the visit").fill("")
    page.get_by_role("button", name="Import 2 recordings").click()
    page.get_by_text("On which day was this measured?").wait_for()
    page.get_by_role("button", name="It is not known").click()
    page.get_by_role("button", name="Import 2 recordings").click()
    page.get_by_role("link", name="trial 2").first.wait_for()
    every = desk.api("GET", "/api/recordings")["recordings"]
    mine = [one for one in every if one["name"].startswith(("trial 2", "trial 10"))]
    assert [one["name"] for one in mine] == ["trial 2", "trial 10"]
    assert {one["visit"] for one in mine} == {None}
    assert len({one["subject"] for one in mine}) == 1


@pytest.mark.slow  # in the fast suite test_web_recordings.py maps one without a browser
def test_a_mat_file_is_mapped_by_hand(desk: Desk, mat: Path) -> None:
    page = desk.go("/import")
    page.set_input_files("#files", mat)
    columns = {"Angle": "hoek", "Torque": "moment"}
    names = ("tibialis anterior", "gastrocnemius lateralis", "soleus", "gastrocnemius medialis")
    columns |= {f"EMG {name}": f"chan{i + 1}" for i, name in enumerate(names)}
    for role, column in columns.items():
        label = f"of {role}"
        page.get_by_label(f"Column {label}", exact=True).select_option(label=column)
        unit = "deg" if role == "Angle" else "Nm" if role == "Torque" else "mV"
        page.get_by_label(f"Unit {label}", exact=True).select_option(unit)
    page.get_by_role("button", name="Sign of Torque: as in the file").click()
    page.get_by_role("button", name="Sign of Torque: turned").wait_for()
    # A preview of an earlier choice may be shown by now: that of this one is waited for.
    with page.expect_request(lambda asked: '"emg":"envelope"' in (asked.post_data or "")):
        page.get_by_label("EMG is").select_option("envelope")
    page.get_by_text("As it will be imported").wait_for()

    page.reload()  # what was chosen is still there, once somebody says that it is the same leg's
    page.get_by_role("button", name="Go on with them").click()
    page.get_by_role("button", name="Sign of Torque: turned").wait_for()
    assert page.get_by_label("Unit of Angle", exact=True).input_value() == "deg"
    page.get_by_label("Day of the visit").fill(DAY)
    page.get_by_role("button", name="Import this recording").click()
    page.wait_for_url("**/recordings/*")

    recording = desk.api("GET", f"/api/recordings/{page.url.rsplit('/', 1)[-1]}")
    assert recording["emg"] == "envelope"
    window = desk.api("GET", f"/api/recordings/{recording['id']}/window?signals=angle,emg_ta")
    angle, emg = window["signals"]
    assert max(map(abs, angle["v"])) < 1.5  # rad
    assert max(emg["v"]) < 1e-2  # V


@pytest.mark.slow  # in the fast suite test_web_recordings.py has one without a browser
def test_the_clock_of_a_film_is_told_with_its_columns(
    desk: Desk, csv: Path, tmp_path: Path
) -> None:
    film, frames = tmp_path / "film.csv", np.arange(40)
    write_csv(film, {"time_s": frames / 25.0, "fascicle_tib_mm": 60.0 + np.sin(frames)})
    page = desk.go("/import")
    page.set_input_files("#files", [csv, film])
    muscle = "of Fascicle length, tibialis"
    for label, value in (("First frame", "0.5"), ("Frames per second", "30")):
        page.get_by_label(f"{label} {muscle}").fill(value)
        with page.expect_response("**/api/imports/preview"):
            page.get_by_label(f"{label} {muscle}").press("Tab")
    page.get_by_label("Day of the visit").fill(DAY)
    page.get_by_role("button", name="Import this recording").click()
    page.wait_for_url("**/recordings/*")
    id_ = page.url.rsplit("/", 1)[-1]
    window = desk.api("GET", f"/api/recordings/{id_}/window?signals=fascicle_tib&points=2000")
    (seen,) = window["signals"]
    np.testing.assert_allclose(seen["t"], 0.5 + frames / 30.0)


@pytest.mark.slow  # in the fast suite test_e2e_pages.py moves one and sees its undo
def test_sliders_move_the_torque_and_undo_takes_them_back(desk: Desk, csv: Path) -> None:
    recording = desk.add(csv)
    change = {"recordings": [recording], "model": "muscle"}
    desk.api("PATCH", "/api/draft", {"change": change, "label": "choose"})
    page = desk.go("/fit")
    figures = page.locator("#live-figures")
    before = figures.filter(has_text="R²").inner_text()  # read in the moment it is there
    slider = page.get_by_label("Slider of m", exact=True)
    slider.focus()
    slider.press("PageUp")
    expect(figures).not_to_have_text(before)
    page.get_by_role("button", name=re.compile("Undo: slide m")).wait_for()

    page.reload()
    page.get_by_text("R²").wait_for()
    assert "m" in desk.api("GET", "/api/draft")["draft"]["sliders"]
    page.get_by_role("heading", name="Parameters").click()
    page.keyboard.press("Control+z")
    expect(figures).to_have_text(before)
    assert desk.api("GET", "/api/draft")["draft"]["sliders"] == {}


def test_a_file_that_cannot_be_read_says_so(desk: Desk, tmp_path: Path) -> None:
    wrong = tmp_path / "holiday.csv"
    wrong.write_bytes(b"\x89PNG\r\n\x1a\n" + bytes(64))
    page = desk.go("/import")
    page.set_input_files("#files", wrong)
    alert = page.locator("#inspect-error, #upload-error").filter(visible=True)
    alert.wait_for()
    assert alert.get_attribute("role") == "alert"
    assert "holiday.csv" in alert.inner_text()
    assert not page.locator("#mapping-card").is_visible()


@pytest.mark.slow  # in the fast suite test_web_jobs.py stops one without a browser
def test_a_stopped_fit_keeps_the_best_and_a_reload_goes_on(desk: Desk, csv: Path) -> None:
    page = start_fit(desk, desk.add(csv), 1000)
    page.locator("#live-figures").get_by_text(re.compile("R²")).wait_for()
    page.reload()
    page.locator("#job-line").get_by_text(re.compile("start .* of 1000")).wait_for()
    page.get_by_role("button", name="Stop, keep the best").click()
    page.get_by_text("Stopped; the best so far is kept.").wait_for()
    page.get_by_role("link", name="Open the result").click()
    page.wait_for_url("**/fits/*")
    page.locator(".report .parameters tbody tr").first.wait_for(state="attached")


@pytest.mark.slow
def test_two_browsers_see_each_other_and_keep_their_own_work(
    browser: Any, server: Server, desk: Desk, csv: Path
) -> None:
    other = Desk(browser, server)
    watching = other.go("/")
    watching.get_by_role("heading", name="Subjects").wait_for()
    recording = desk.add(csv)
    desk.api("PATCH", f"/api/recordings/{recording}", {"name": "seen by both"})
    watching.get_by_role("link", name="seen by both").first.wait_for()
    desk.api("PATCH", "/api/draft", {"change": {"recordings": [recording]}, "label": "mine"})
    assert other.api("GET", "/api/draft")["draft"]["recordings"] == []
    other.close()


@pytest.mark.slow  # in the fast suite test_web_designer.py does it without a browser
def test_a_protocol_is_designed(desk: Desk) -> None:
    page = desk.go("/plan")
    page.get_by_text("Worked out in").wait_for()
    figures = page.locator("#figures")
    assert page.locator("#prediction tbody tr").count() == PARAMETERS + 2  # auto: the tendons
    before = figures.text_content()
    chirp = page.get_by_label("Chirp amplitude")
    expect(chirp).to_be_disabled()  # what was designed has no chirp
    page.get_by_label("Profile").select_option("multiple-holds")
    expect(chirp).to_be_enabled()
    expect(figures).not_to_have_text(before)
    after = figures.text_content()
    page.reload()
    expect(figures).to_have_text(after)
    page.get_by_label("Reason to export").fill("a test")
    with page.expect_download() as file:
        page.get_by_role("button", name="Export CSV").click()
    assert "angle_rad" in Path(file.value.path()).read_text(encoding="utf-8")[:2000]
    page.get_by_label("Plantarflexion").fill("0.9")
    page.locator("#error").wait_for()


def design_for_long(desk: Desk, first: dict[str, Any] | None = None) -> Any:
    """The page, with a search that takes minutes begun, after another one, which becomes a job."""
    page = desk.go("/plan")
    page.get_by_text("Worked out in").wait_for()
    page.get_by_label("Durations").fill("20")
    page.locator("#evaluations").select_option("long")
    if first is not None:
        first.update(desk.api("POST", "/api/protocols/design", first.copy()))
    page.get_by_role("button", name="Design it").click()
    return page


@pytest.mark.slow
def test_a_design_that_is_stopped_keeps_the_best_so_far(desk: Desk) -> None:
    page = design_for_long(desk)
    said, stop = page.locator("#search-said"), page.get_by_role("button", name="Stop, keep the")
    expect(said).to_have_text(re.compile(r"Plans judged: [1-9]\d* of 12000"))
    stop.click()
    expect(said).to_have_text(
        re.compile(r"^Stopped: largest error [\d.]+ % \(\w+\)\. Kept below under Saved protocols")
    )
    expect(stop).to_be_hidden()
    expect(page.get_by_role("button", name="Design it")).to_be_enabled()
    page.get_by_role("button", name="Open designed 20 s worst").click()
    expect(page.locator("#profile")).to_have_value("designed")
    expect(page.locator("#figures")).to_contain_text("20.0 s")
    expect(page.locator("#limits")).to_be_hidden()  # what is kept keeps the device's limits
    with page.expect_download() as file:
        page.get_by_role("button", name="CSV of designed 20 s worst").click()
    text = Path(file.value.path()).read_text(encoding="utf-8")
    assert text.splitlines()[1].startswith("time_s,angle_rad")  # whose legs stands above
    assert float(text.splitlines()[-1].split(",")[0]) == 20.0
    page.get_by_role("button", name="Delete designed 20 s worst").click()
    expect(page.locator("#saved")).not_to_contain_text("designed 20 s worst")


@pytest.mark.slow
def test_a_design_that_is_stopped_before_it_began_keeps_nothing(desk: Desk) -> None:
    first = {
        "device": "achilles",
        "angle_range": [-0.9, 0.6],
        "durations": [20],
        "evaluations": 12000,
    }
    page = design_for_long(desk, first)
    said = page.locator("#search-said")
    expect(said).to_have_text("Waiting, 1 in line")
    page.get_by_role("button", name="Stop, keep the").click()
    expect(said).to_have_text("Stopped: cancelled before it began. Nothing is kept.")
    desk.api("POST", f"/api/jobs/{first['id']}/cancel")
    desk.wait_for_job(first)
    for kept in desk.api("GET", "/api/protocols")["protocols"]:
        desk.api("DELETE", f"/api/protocols/{kept['id']}")


@pytest.mark.slow
def test_all_survives_a_restart_of_the_server(browser: Any, csv: Path, tmp_path: Path) -> None:
    first = Server(tmp_path / "project")
    port = int(first.address.rsplit(":", 1)[-1])
    desk = Desk(browser, first)
    page = start_fit(desk, desk.add(csv), 1000)
    page.locator("#live-figures").get_by_text(re.compile("R²")).wait_for()
    first.stop()
    second = Server(tmp_path / "project", port)
    page.get_by_text("The server was stopped during the fit.").wait_for()
    page.reload()
    page.get_by_text("R²").first.wait_for()
    expect(page.locator("#recordings input:checked")).to_have_count(1)
    desk.close()
    second.stop()


@pytest.mark.slow
def test_from_files_to_the_leg_are_two_clicks(desk: Desk, shared: Path) -> None:
    """Measured trials whose signs are both turned in their files: turn both, analyse."""
    page = desk.go("/import")
    desk.api("PATCH", "/api/draft", {"change": WHOLE, "label": "quick"})
    names = ("dynamometer/Pas_10", "repeats/Pas_20", "repeats/PL_0_01", "repeats/Pas_-15")
    page.set_input_files("#files", [shared / f"{name}.mat" for name in names])
    page.get_by_text("4 trials found, EMG of 1 muscle, both signs look turned.").wait_for()
    page.get_by_role("button", name="Turn both").click()
    page.get_by_text("4 trials found, EMG of 1 muscle.").wait_for()
    page.get_by_label("Day of the visit").fill(DAY)
    page.get_by_role("button", name="Analyse").click()
    page.wait_for_url("**/sessions/*")
    page.get_by_text("How stiff is it?").wait_for()
    said = page.locator(".report .card").first.text_content()
    assert "Nm/°" in said
    assert "3 held angles" in said
    assert page.evaluate("getComputedStyle(document.querySelector('.leg')).display") == "grid"


@pytest.mark.slow
def test_two_million_samples_are_zoomed_without_a_pause(desk: Desk, tmp_path: Path) -> None:
    from scipy.io import savemat

    time = np.arange(2_000_000) / 8000.0
    angle = 0.3 * np.sin(2.0 * time)
    noise = 1e-4 * np.random.default_rng(0).standard_normal(time.size)
    content = {"time": time, "angle_rad": angle, "torque_Nm": 10.0 * angle}
    path = tmp_path / "long.mat"
    savemat(path, content | {f"emg_{muscle}_V": noise for muscle in MUSCLES})
    page = desk.go("/import")
    page.set_input_files("#files", path)
    page.get_by_label("Unit of Angle", exact=True).select_option("rad")
    page.get_by_label("Unit of Torque", exact=True).select_option("Nm")
    page.get_by_label("Unit of EMG soleus", exact=True).select_option("V")
    page.get_by_text("As it will be imported").wait_for()
    page.get_by_label("Day of the visit").fill(DAY)
    page.get_by_role("button", name="Import this recording").click()
    page.wait_for_url("**/recordings/*")
    page.locator("#plots canvas").first.wait_for()
    page.get_by_text("The check found").or_(page.get_by_text("of the check")).wait_for()
    for _ in range(6):
        with page.expect_response("**/window?*start=*") as answer:
            page.get_by_role("group", name="Signals of long").press("+")
        answer.value.finished()
    took = page.evaluate(
        "performance.getEntriesByType('resource')"
        ".filter(one => one.name.includes('start=')).map(one => one.duration)"
    )
    assert len(took) == 6
    assert max(took) < 1000.0  # milliseconds, on a computer that does other things, too
