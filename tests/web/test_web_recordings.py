"""Files in, curves out: import, subjects, windows, quality."""

import threading
from concurrent.futures import ThreadPoolExecutor

import numpy as np
import pytest

import surae
from perturbed_ankle import ramps
from surae.recording import MUSCLES, write_csv
from surae_workbench.web.curves import window
from surae_workbench.web.routes.recordings import in_order

from .conftest import PATIENCE, LentChild


def test_an_upload_is_looked_into_and_imported(browser, trial) -> None:
    upload = browser.upload(trial)
    answer = browser.get(f"/api/uploads/{upload}/inspect").json()
    columns = {column["name"]: column for column in answer["columns"]}
    assert columns["angle_rad"]["role"] == "angle"
    assert columns["emg_ta_V"]["unit"] == "V"
    assert len(columns["torque_Nm"]["preview"]["t"]) <= 200
    assert answer["mapping"]["emg"] == "envelope"
    mapping = answer["mapping"]
    mapping["channels"]["torque"]["sign"] = -1
    preview = browser.post("/api/imports/preview", json={"mapping": mapping}).json()
    ours = surae.read(trial)
    torque = next(channel for channel in preview["channels"] if channel["role"] == "torque")
    assert torque["low"] == pytest.approx(-ours.channels["torque"].values.max())
    mapping["channels"]["torque"]["sign"] = 1
    body = {"mapping": mapping, "trial": "T1"}
    recording = browser.post("/api/imports", json=body).json()
    assert recording["files"] == [{"name": "trial.csv", "sha256": ours.files[0].sha256}]
    assert recording["trial"] == "T1"
    assert recording["mapping"]["channels"]["angle"]["column"] == "angle_rad"


def test_pages_do_not_wait_behind_inspections(server, browser, trial, monkeypatch) -> None:
    """Of 40 at once 26 were once refused."""
    go_on, call = threading.Event(), LentChild.call

    def held(self, *asked, **more):
        assert go_on.wait(PATIENCE)
        return call(self, *asked, **more)

    path = f"/api/uploads/{browser.upload(trial)}/inspect"
    monkeypatch.setattr(LentChild, "call", held)
    with ThreadPoolExecutor(40) as threads:
        answers = [threads.submit(browser.get, path) for _ in range(40)]
        assert server.browser().get("/api/draft").status_code == 200
        assert not any(answer.done() for answer in answers)
        go_on.set()
        assert [answer.result().status_code for answer in answers] == [200] * 40


@pytest.mark.parametrize(
    ("data", "says"),
    [(b"\x00\x01\x02binary", "binary"), (b"time_s,angle_rad\n0,1\n0,nan\n", "row"), (b"hello", "")],
)
def test_unreadable_files_are_refused_by_their_users_name(browser, data, says) -> None:
    answer = browser.post("/api/uploads", params={"name": "mine.csv"}, content=data)
    id_ = answer.json()["id"]
    answer = browser.get(f"/api/uploads/{id_}/inspect")
    if answer.status_code == 200:  # columns are told, but it cannot be imported
        column = {"upload": id_, "column": "angle_rad", "unit": "rad"}
        body = {"mapping": {"name": "x", "channels": {"angle": column}}}
        answer = browser.post("/api/imports", json=body)
    assert answer.status_code == 400
    error = answer.json()["error"]
    assert "mine.csv" in error
    assert says in error
    assert "uploads" not in error  # not where we keep it


def test_a_mapping_reaches_no_file_but_uploads(browser, tmp_path, trial) -> None:
    toml = '[channels.angle]\nfile = "../../project.db"\ncolumn = "x"\nunit = "rad"\n'
    id_ = browser.post("/api/uploads", params={"name": "map.toml"}, content=toml).json()["id"]
    answer = browser.get(f"/api/uploads/{id_}/inspect").json()
    assert answer["ready"] is False
    assert "project.db" in answer["notes"][0]
    browser.upload(trial)
    good = toml.replace("../../project.db", "trial.csv").replace('"x"', '"angle_rad"')
    id_ = browser.post("/api/uploads", params={"name": "map2.toml"}, content=good).json()["id"]
    assert browser.get(f"/api/uploads/{id_}/inspect").json()["ready"] is True


@pytest.mark.parametrize(
    ("line", "says"),
    [
        ('zero = "rest.csv"', r"channels.angle.zero: upload rest.csv too"),
        ('zero = "../../project.db"', r"channels.angle.zero: upload project.db too"),
        ('[trials]\na.side = "left"', r"[trials] says what differs"),
    ],
)
def test_a_mapping_whose_lines_would_be_lost_is_refused(browser, trial, line, says) -> None:
    browser.upload(trial)
    toml = '[channels.angle]\nfile = "trial.csv"\ncolumn = "angle_rad"\nunit = "rad"\n' + line
    id_ = browser.post("/api/uploads", params={"name": "map.toml"}, content=toml).json()["id"]
    answer = browser.get(f"/api/uploads/{id_}/inspect")
    assert answer.status_code == 400
    assert says in answer.json()["error"]


@pytest.mark.parametrize("zero", ["[2.0, 4.0]", '"rest.csv"'])
def test_a_zero_becomes_the_offset_that_it_means(serve, trial, tmp_path, zero) -> None:
    browser = serve().browser()
    rest, time = tmp_path / "rest.csv", np.arange(100) / 32.0
    write_csv(rest, {"time_s": time, "angle_rad": 0 * time, "torque_Nm": 0 * time + 3.0})
    for path in (trial, rest):
        browser.upload(path)
    column = f'file = "{trial.name}"\ncolumn = '
    toml = f'emg = "envelope"\n[channels.angle]\n{column}"angle_rad"\nunit = "rad"\n'
    toml += f'[channels.torque]\n{column}"torque_Nm"\nunit = "Nm"\n'
    toml += f"scale = 0.5\nsign = -1\nzero = {zero}\n"
    id_ = browser.post("/api/uploads", params={"name": "map.toml"}, content=toml).json()["id"]
    told = browser.get(f"/api/uploads/{id_}/inspect").json()
    (tmp_path / trial.name).write_bytes(trial.read_bytes())
    (tmp_path / "map.toml").write_text(toml)
    meant = surae.read(tmp_path / "map.toml").channels["torque"].values
    made = browser.post("/api/imports", json={"mapping": told["mapping"]}).json()["id"]
    url = f"/api/recordings/{made}/window"
    shown = browser.get(url, params={"signals": "torque", "points": 2000}).json()
    assert shown["signals"][0]["v"] == pytest.approx(meant.tolist(), abs=1e-9)
    assert any("its zero is that of" in note for note in told["notes"])


@pytest.mark.parametrize("clock", ["", "start_s = 0.5\nrate_hz = 30.0\n"])
def test_a_film_comes_with_its_trial(browser, trial, tmp_path, clock) -> None:
    film, frames = tmp_path / "film.csv", np.arange(90)
    stamps = {"frame": frames} if clock else {"time_s": 0.5 + frames / 30.0}
    write_csv(film, {**stamps, "fascicle_tib_mm": 60.0 + np.sin(0.1 * frames)})
    ids = [browser.upload(path) for path in (trial, film)]
    if clock:
        toml = 'emg = "envelope"\n[channels.fascicle_tib]\nfile = "film.csv"\nunit = "mm"\n'
        toml += f'column = "fascicle_tib_mm"\n{clock}'
        for role, unit in (("angle", "rad"), ("torque", "Nm")):
            toml += f'[channels.{role}]\nfile = "{trial.name}"\ncolumn = "{role}_{unit}"\n'
            toml += f'unit = "{unit}"\n'
        ids = [browser.post("/api/uploads", params={"name": "map.toml"}, content=toml).json()["id"]]
    told = browser.get(f"/api/uploads/{ids[0]}/inspect", params={"also": ids[-1]}).json()
    assert "fascicle_tib" in told["mapping"]["channels"]
    told["mapping"]["emg"] = "envelope"
    made = browser.post("/api/imports", json={"mapping": told["mapping"]}).json()
    (seen,) = (c for c in made["channels"] if c["role"] == "fascicle_tib")
    assert (seen["n"], round(seen["rate_hz"], 6)) == (90, 30.0)
    told["mapping"]["channels"]["fascicle_tib"] |= {"start_s": 1.5, "rate_hz": 25.0}
    again = {"recordings": [made["id"]], "mapping": told["mapping"]}
    (row,) = browser.post("/api/descriptions", json=again).json()["recordings"]
    url = f"/api/recordings/{row['id']}/window"
    (film,) = browser.get(url, params={"signals": "fascicle_tib"}).json()["signals"]
    assert film["t"] == pytest.approx((1.5 + frames / 25.0).tolist())


def test_subjects(serve, trial) -> None:
    browser = serve().browser()
    made = browser.post("/api/subjects", json={"code": "S01", "group": "patient"}).json()
    again = browser.post("/api/subjects", json={"code": "S01"})
    assert again.status_code == 409
    recording = browser.recording(trial, subject=made["id"])
    assert browser.get("/api/subjects").json()["subjects"][0]["recordings"] == 1
    assert browser.delete(f"/api/subjects/{made['id']}").status_code == 409
    browser.patch(f"/api/recordings/{recording}", json={"subject": None, "side": "left"})
    assert browser.get(f"/api/recordings/{recording}").json()["side"] == "left"
    assert browser.delete(f"/api/subjects/{made['id']}").status_code == 204
    browser.post("/api/draft/undo")
    assert browser.get("/api/subjects").json()["subjects"][0]["code"] == "S01"


def test_windows(browser, recorded, trial) -> None:
    ours = surae.read(trial).channels
    url = f"/api/recordings/{recorded}/window"
    answer = browser.get(url, params={"signals": "angle", "points": 2000}).json()
    assert answer["signals"][0]["v"] == ours["angle"].values.tolist()
    part = browser.get(url, params={"signals": "torque", "start": 10, "end": 12}).json()
    time = np.array(part["signals"][0]["t"])
    assert time[0] < 10.0 <= time[1]
    assert time[-2] <= 12.0 < time[-1]
    few = browser.get(url, params={"signals": "torque", "points": 100}).json()["signals"][0]
    assert len(few["t"]) <= 102
    assert max(few["v"]) == ours["torque"].values.max()
    assert min(few["v"]) == ours["torque"].values.min()
    assert browser.get(url, params={"signals": "nothing"}).status_code == 400
    assert browser.get(url, params={"start": 3, "end": 2}).status_code == 400


def test_quality_is_marked_in_time(browser, recorded) -> None:
    finding = browser.get(f"/api/recordings/{recorded}/quality").json()["findings"]
    assert all(finding["severity"] in ("info", "warning", "error") for finding in finding)
    assert all(finding["start_s"] <= finding["end_s"] for finding in finding)


def test_a_window_loses_no_peak() -> None:
    n = 300_000
    time = np.arange(n) / 1000.0
    values = np.random.default_rng(3).standard_normal(n)
    values[123_456], values[200_001] = 50.0, -50.0
    t, v = window(time, values, None, None, 2000)
    assert len(t) <= 2002
    assert (v.max(), v.min()) == (50.0, -50.0)
    assert np.all(np.diff(t) > 0)
    t, v = window(time, values, 123.0, 124.0, 2000)
    assert v.max() == 50.0
    for start, end in ((0.0, 37.3), (12.34, 290.1), (299.0, 400.0), (400.0, 500.0)):
        t, v = window(time, values, start, end, 500)
        inside = values[(time >= start) & (time <= end)]
        assert len(t) <= 502
        if len(inside):
            assert v.max() >= inside.max()
            assert v.min() <= inside.min()


def test_what_the_samples_do_not_say_is_asked(browser, tmp_path) -> None:
    time = np.arange(2000) / 500.0
    noise = np.abs(np.random.default_rng(0).standard_normal(time.size))
    table = {"time_s": time, "Angle (deg)": np.sin(time), "Torque": time, "SOL (uV)": noise}
    write_csv(tmp_path / "lab.csv", table)
    content = browser.get(f"/api/uploads/{browser.upload(tmp_path / 'lab.csv')}/inspect").json()
    mapping = content["mapping"]
    assert (mapping["emg"], content["ready"]) == (None, False)
    assert {role: channel["unit"] for role, channel in mapping["channels"].items()} == {
        "angle": "deg",
        "torque": None,
        "emg_sol": "uV",
    }
    for change, says in (
        ({}, "choose which"),
        ({"emg": "raw"}, "channels.torque: unit is missing"),
    ):
        answer = browser.post("/api/imports", json={"mapping": mapping | change})
        assert answer.status_code == 400
        assert says in answer.json()["error"]
        assert "mapping.toml" not in answer.json()["error"]
    mapping["channels"]["torque"]["unit"] = "Nm"
    answer = browser.post("/api/imports", json={"mapping": mapping | {"emg": "envelope"}})
    assert answer.status_code == 201, answer.text


def test_a_recordings_page_tells_how_much_is_nerve(browser, tmp_path) -> None:
    stretched = ramps((10.0, 10.0, 120.0, 120.0), neural=6.0)
    names = {
        "angle": "angle_rad",
        "torque": "torque_Nm",
        **{f"emg_{m}": f"emg_{m}_V" for m in MUSCLES},
    }
    columns = {names[role]: channel.values for role, channel in stretched.channels.items()}
    time = stretched.channels["angle"].time
    write_csv(tmp_path / "ramps.csv", {"time_s": time, **columns}, ["emg: envelope"])
    id_ = browser.recording(tmp_path / "ramps.csv")
    assert "How much is nerve?" in browser.get(f"/nerve/{id_}").text
    asked = {"recordings": id_, "by": "stretches"}
    told = browser.get("/api/nerve", params=asked).json()["html"]
    assert "with EMG" in told
    assert told.count("<img") == 2
    kept = browser.get("/api/nerve/report.html", params=asked)
    assert "with EMG" in kept.text
    assert 'filename="stretches-' in kept.headers["content-disposition"]
    refused = browser.get("/api/nerve", params={**asked, "by": "perturbations"})
    assert refused.status_code == 400
    assert "surae stretches" in refused.json()["error"]


def test_trials_stand_as_they_are_counted_the_newest_visit_first() -> None:
    def row(name: str, visit: str | None = "2026-03-04", subject: str = "a") -> dict:
        return {"name": name, "visit": visit, "side": "left", "subject": subject}

    came = [
        row("trial 10"),
        row("Trial 2"),
        row("x", None),
        row("trial 1"),
        row("old", "2025-01-01"),
    ]
    names = [one["name"] for one in in_order(came)]
    assert names == ["old", "trial 1", "Trial 2", "trial 10", "x"]


def test_a_preview_has_its_pictures_and_an_import_keeps_none(browser, trial) -> None:
    told = browser.get(f"/api/uploads/{browser.upload(trial)}/inspect").json()
    seen = browser.post("/api/imports/preview", json={"mapping": told["mapping"]}).json()
    over = seen["pictures"]["over"]
    assert len(over["angle"]) == len(over["torque"]) == 400
    angle = next(c for c in seen["channels"] if c["role"] == "angle")
    assert min(over["angle"]) == pytest.approx(np.degrees(angle["low"]), abs=1.0)
    turned = {**told["mapping"]["channels"]["torque"], "sign": -1}
    channels = {**told["mapping"]["channels"], "torque": turned}
    after = browser.post(
        "/api/imports/preview", json={"mapping": {**told["mapping"], "channels": channels}}
    ).json()
    np.testing.assert_allclose(after["pictures"]["over"]["torque"], np.negative(over["torque"]))
    made = browser.post("/api/imports", json={"mapping": told["mapping"]}).json()
    assert "pictures" not in made
