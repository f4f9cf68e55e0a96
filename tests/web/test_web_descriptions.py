"""Recordings described anew after their import: what changes, what stays, and the way back."""

import numpy as np
import pandas
import pytest

from surae_workbench.web.remap import proposals
from surae_workbench.web.routes import descriptions
from surae_workbench.web.upkeep import check


@pytest.fixture
def browser(serve):
    """Of a project of its own: names and files of others would be met."""
    return serve().browser()


def signal(browser, id_, role):
    window = browser.get(f"/api/recordings/{id_}/window", params={"signals": role}).json()
    return np.array(window["signals"][0]["v"])


def described(browser, id_):
    answer = browser.get(f"/api/recordings/{id_}/description")
    assert answer.status_code == 200, answer.text
    return answer.json()


def test_units_signs_and_zeros_are_mended_and_undo_brings_back_what_was(browser, trial) -> None:
    id_ = browser.recording(trial)
    before = {role: signal(browser, id_, role) for role in ("angle", "torque", "emg_sol")}
    mapping = described(browser, id_)["mapping"]
    mapping["channels"]["angle"] |= {"unit": "deg", "sign": -1}
    mapping["channels"]["torque"] |= {"offset": -12.0, "scale": 2.0}
    mapping["channels"]["emg_sol"]["unit"] = "mV"
    mapping["fixed"] = {"m": 0.0}
    body = {"recordings": [id_], "mapping": mapping}
    seen = browser.post("/api/descriptions/preview", json=body).json()
    ranges = {channel["role"]: (channel["low"], channel["high"]) for channel in seen["channels"]}
    assert ranges["torque"] == pytest.approx(
        (2 * before["torque"].min() - 12, 2 * before["torque"].max() - 12)
    )
    assert signal(browser, id_, "angle") == pytest.approx(before["angle"])  # only looked at
    (row,) = browser.post("/api/descriptions", json=body).json()["recordings"]
    assert (row["version"], row["fixed"]) == (1, {"m": 0.0})
    assert signal(browser, id_, "angle") == pytest.approx(-before["angle"] * np.pi / 180)
    assert signal(browser, id_, "torque") == pytest.approx(2 * before["torque"] - 12)
    assert signal(browser, id_, "emg_sol") == pytest.approx(before["emg_sol"] / 1e3)
    assert described(browser, id_)["mapping"] == mapping
    for role in ("angle", "torque"):  # of what was imported, not of what it was made
        mapping["channels"][role] |= {"scale": 1.0, "offset": 0.0, "sign": 1, "unit": None}
    browser.post("/api/draft/undo", json={})
    assert browser.get(f"/api/recordings/{id_}").json()["version"] == 0
    for role, values in before.items():
        assert (signal(browser, id_, role) == values).all()
    browser.post("/api/draft/redo", json={})
    assert signal(browser, id_, "torque") == pytest.approx(2 * before["torque"] - 12)


def test_a_fit_made_before_is_marked_until_undo(browser, trial) -> None:
    id_ = browser.recording(trial)
    browser.change(recordings=[id_], starts=1, prepared=True)
    fit = browser.job(browser.post("/api/fits", json={}))["result"]
    (summary,) = browser.get("/api/fits").json()["fits"]
    assert summary["older"] == []
    mapping = described(browser, id_)["mapping"]
    mapping["channels"]["torque"]["sign"] *= -1
    browser.post("/api/descriptions", json={"recordings": [id_], "mapping": mapping})
    (summary,) = browser.get("/api/fits").json()["fits"]
    assert summary["older"] == [summary["names"][0]]
    assert browser.get(f"/api/fits/{fit}").json()["summary"]["older"] == summary["older"]
    browser.post("/api/draft/undo", json={})
    (summary,) = browser.get("/api/fits").json()["fits"]
    assert summary["older"] == []


def test_two_who_describe_at_once_write_two_files(browser, trial, monkeypatch) -> None:
    """The one that comes second is refused; what the first made stays as it was written."""
    id_ = browser.recording(trial)
    mapping = described(browser, id_)["mapping"]
    mapping["channels"]["torque"]["scale"] = 2.0
    body = {"recordings": [id_], "mapping": mapping}
    made, numbers = descriptions._made, []

    def overtaken(*given):
        result = made(*given)
        numbers.append(given[-1])
        if len(numbers) == 1:  # somebody else is quicker
            mapping["channels"]["torque"]["scale"] = 3.0
            assert browser.post("/api/descriptions", json=body).status_code == 200
        return result

    before = signal(browser, id_, "torque")
    monkeypatch.setattr(descriptions, "_made", overtaken)
    answer = browser.post("/api/descriptions", json=body)
    assert answer.status_code == 409
    assert len(set(numbers)) == 2
    assert signal(browser, id_, "torque") == pytest.approx(3 * before)


def test_several_are_mended_at_once_and_undone_at_once(browser, trial, tmp_path) -> None:
    again = tmp_path / "other.csv"
    text = trial.read_text().splitlines()
    again.write_text("\n".join([*text[:2], *text[12:]]))
    ids = [browser.recording(trial), browser.recording(again)]
    before = [signal(browser, id_, "torque") for id_ in ids]
    told = described(browser, ids[0])
    assert [other["id"] for other in told["alike"]] == [ids[1]]
    told["mapping"]["channels"]["torque"]["sign"] = -1
    browser.post("/api/descriptions", json={"recordings": ids, "mapping": told["mapping"]})
    for id_, values in zip(ids, before, strict=True):
        assert signal(browser, id_, "torque") == pytest.approx(-values)
        assert browser.get(f"/api/recordings/{id_}").json()["version"] == 1
    browser.post("/api/draft/undo", json={})
    for id_, values in zip(ids, before, strict=True):
        assert (signal(browser, id_, "torque") == values).all()


def test_columns_can_be_exchanged_and_others_need_the_file(browser, trial) -> None:
    id_ = browser.recording(trial)
    soleus, tibialis = signal(browser, id_, "emg_sol"), signal(browser, id_, "emg_ta")
    mapping = described(browser, id_)["mapping"]
    channels = mapping["channels"]
    channels["emg_sol"], channels["emg_ta"] = channels["emg_ta"], channels["emg_sol"]
    browser.post("/api/descriptions", json={"recordings": [id_], "mapping": mapping})
    assert signal(browser, id_, "emg_ta") == pytest.approx(soleus)
    assert signal(browser, id_, "emg_sol") == pytest.approx(tibialis)
    kept = described(browser, id_)
    assert {column["name"] for file in kept["files"] for column in file["columns"]} == {
        channel["column"] for channel in channels.values()
    }
    channels["torque"] = {**channels["torque"], "column": "elsewhere"}
    answer = browser.post("/api/descriptions", json={"recordings": [id_], "mapping": mapping})
    assert answer.status_code == 400
    assert "'elsewhere' was not imported" in answer.json()["error"]


def test_what_the_check_is_sure_of_is_one_click_and_nothing_else_is(browser, shared) -> None:
    """A measured trial whose torque's zero is off, and the same with a turned angle."""
    upload = browser.upload(shared / "dynamometer" / "PL_50_01.mat")
    mapping = browser.get(f"/api/uploads/{upload}/inspect").json()["mapping"]
    units = {"Angle": "deg", "Torque": "Nm", "EMG_TA": "V"}
    roles = {"Angle": "angle", "Torque": "torque", "EMG_TA": "emg_ta"}
    mapping |= {
        "emg": "raw",
        "fixed": {"g2": 0.0, "g3": 0.0, "g4": 0.0},
        "channels": {
            role: {
                "upload": upload,
                "column": column,
                "unit": units[column],
                "sign": -1 if column == "Torque" else 1,
            }
            for column, role in roles.items()
        },
    }
    id_ = browser.post("/api/imports", json={"mapping": mapping}).json()["id"]
    clicks = []
    for _ in range(4):
        findings = browser.get(f"/api/recordings/{id_}/quality").json()["findings"]
        assert {f["code"] for f in findings if f["mend"]} <= {"angle-sign", "torque-offset"}
        mends = [finding["mend"] for finding in findings if finding["mend"]]
        if not mends:
            break
        clicks.append(mends[0]["label"])
        told = described(browser, id_)["mapping"]
        for role, change in mends[0]["channels"].items():
            told["channels"][role] |= change
        browser.post("/api/descriptions", json={"recordings": [id_], "mapping": told})
    assert [click.split()[0] for click in clicks] == ["Turn", "Take"]
    assert not {"angle-sign", "torque-sign"} & {f["code"] for f in findings}
    assert all("zero is off" not in f["message"] for f in findings)


UNITS = {
    "angle in degrees": (("angle_rad",), 180 / np.pi, "It is deg"),
    "angle in radians, named degrees": (("angle_rad",), 1.0, "It is rad"),
    "torque in mNm": (("torque_Nm",), 1e3, "It is mNm"),
    "one EMG in µV": (("emg_sol_V",), 1e6, "It is µV"),
    "all EMG in µV": (("emg_ta_V", "emg_gl_V", "emg_sol_V", "emg_gm_V"), 1e6, "It is µV"),
}


def test_a_scale_that_is_certain_and_no_unit_is_offered_as_a_scale() -> None:
    finding = {
        "code": "torque-unit",
        "channel": "torque",
        "value": 0.0,
        "advice": "",
        "advised": {"message": "advice/write", "given": {"lines": "scale = 72 for the torque"}},
    }
    channels = {"torque": {"unit": "Nm", "sign": 1, "scale": 2.0, "offset": 0.0}}
    (offered,) = proposals([finding], channels)
    assert offered["mend"]["label"] == "Scale by {factor}"
    assert offered["mend"]["given"] == {"factor": "72"}
    assert offered["mend"]["channels"] == {"torque": {"scale": 144.0}}
    (none,) = proposals([finding | {"advised": {"message": "advice/torque-unit"}}], channels)
    assert none["mend"] is None


@pytest.mark.parametrize("how", UNITS)
def test_a_wrong_unit_is_mended_by_one_click(browser, trial, tmp_path, how) -> None:
    """The values are then those that were recorded; where units are right nothing is offered."""
    columns, factor, label = UNITS[how]
    frame = pandas.read_csv(trial, comment="#")
    right = browser.recording(written(tmp_path / "right.csv", frame))
    findings = browser.get(f"/api/recordings/{right}/quality").json()["findings"]
    assert not [f["mend"] for f in findings if f["mend"]]
    for column in columns:
        frame[column] *= factor
    if label == "It is rad":  # said to be degrees
        frame = frame.rename(columns={"angle_rad": "angle_deg"})
    wrong = browser.recording(written(tmp_path / "wrong.csv", frame))
    findings = browser.get(f"/api/recordings/{wrong}/quality").json()["findings"]
    (mend,) = [f["mend"] for f in findings if f["mend"] and f["mend"]["label"].startswith("It is")]
    assert mend["label"].format(**mend["given"]) == label
    told = described(browser, wrong)["mapping"]
    for role, change in mend["channels"].items():
        told["channels"][role] |= change
    assert browser.post(
        "/api/descriptions", json={"recordings": [wrong], "mapping": told}
    ).is_success
    for role in ("angle", "torque", "emg_sol", "emg_ta"):
        expected = signal(browser, right, role)
        np.testing.assert_allclose(signal(browser, wrong, role), expected, rtol=1e-6, atol=1e-12)


def written(path, frame):
    path.write_text("# emg: raw\n" + frame.to_csv(index=False))
    return path


def test_a_file_that_was_imported_is_recognised_and_names_are_unique(browser, trial) -> None:
    first = browser.get(f"/api/recordings/{browser.recording(trial)}").json()
    upload = browser.upload(trial)
    mapping = browser.get(f"/api/uploads/{upload}/inspect").json()["mapping"]
    preview = browser.post("/api/imports/preview", json={"mapping": mapping}).json()
    assert preview["twin"] == {"id": first["id"], "name": first["name"]}
    second = browser.post("/api/imports", json={"mapping": mapping}).json()
    assert second["name"] == f"{first['name']} (2)"
    answer = browser.patch(f"/api/recordings/{second['id']}", json={"name": first["name"]})
    assert answer.status_code == 409
    assert "already" in answer.json()["error"]


def test_a_project_with_versions_is_whole_and_a_changed_version_is_seen(serve, trial) -> None:
    server = serve()
    browser = server.browser()
    id_ = browser.recording(trial)
    mapping = described(browser, id_)["mapping"]
    mapping["channels"]["torque"]["sign"] = -1
    browser.post("/api/descriptions", json={"recordings": [id_], "mapping": mapping})
    folder = server.bench.project.folder
    seen = check(folder)
    assert (seen.problems, seen.orphans, seen.unsealed) == ((), (), ())
    version = folder / "recordings" / f"{id_}.v1.h5"
    version.chmod(0o600)
    version.write_bytes(version.read_bytes()[:-1])
    (problem,) = check(folder).problems
    assert "v1.h5 is not as it was kept" in problem
