"""Sessions: apart from each other, undone step by step, there again after a restart."""

import pytest


def test_two_browsers_know_nothing_of_each_other(server, trial, recorded) -> None:
    first, other = server.browser(), server.browser()
    first.change(recordings=[recorded], model="muscle-tendon", sliders={"k_tri": 123.0})
    upload = first.upload(trial)
    assert other.get("/api/draft").json()["draft"]["recordings"] == []
    assert other.get("/api/draft").json()["draft"]["model"] == "auto"
    assert other.get("/api/uploads").json() == {"uploads": []}
    assert other.get(f"/api/uploads/{upload}/inspect").status_code == 404
    assert other.delete(f"/api/uploads/{upload}").status_code == 404
    mapping = {"name": "x", "channels": {"angle": {"upload": upload, "column": "angle_rad"}}}
    assert other.post("/api/imports", json={"mapping": mapping}).status_code == 404
    assert other.post("/api/draft/undo").status_code == 409
    assert first.delete(f"/api/uploads/{upload}").status_code == 204


def test_undo_and_redo(browser, recorded) -> None:
    browser.change(recordings=[recorded])
    browser.change(model="muscle-tendon")
    browser.change(exclusions={recorded: [[1.0, 2.0]]})
    state = browser.post("/api/draft/undo").json()
    assert state["draft"]["exclusions"] == {}
    assert state["draft"]["model"] == "muscle-tendon"
    state = browser.post("/api/draft/undo").json()
    assert state["draft"]["model"] == "muscle"
    assert state["redo"] == "test"
    state = browser.post("/api/draft/redo").json()
    assert state["draft"]["model"] == "muscle-tendon"
    browser.change(seed=5)
    assert browser.get("/api/draft").json()["redo"] is None  # a new step forgets the other way
    assert browser.post("/api/draft/redo").status_code == 409


def test_a_drag_is_one_step(browser) -> None:
    for value in (100.0, 120.0, 140.0):
        change = {"change": {"sliders": {"k_tri": value}}, "label": "k_tri", "merge": True}
        state = browser.patch("/api/draft", json=change).json()
    assert state["draft"]["sliders"] == {"k_tri": 140.0}
    assert browser.post("/api/draft/undo").json()["draft"]["sliders"] == {}


def test_maps_are_changed_key_by_key(browser) -> None:
    browser.change(parameters={"m": {"free": False, "value": 2.0}, "beta": {"lower": 0.5}})
    state = browser.change(parameters={"m": None})
    assert list(state["draft"]["parameters"]) == ["beta"]
    state = browser.change(options={"geometry": "virtual-work"})
    assert state["draft"]["options"]["geometry"] == "virtual-work"
    assert state["draft"]["options"]["vmax_factor"] == 8.0


@pytest.mark.parametrize(
    "change",
    [
        {"model": "other"},
        {"starts": 0},
        {"unknown": 1},
        {"recordings": ["../../x"]},
        {"sliders": {"k_tri": "high"}},
        {"exclusions": {"0" * 16: [[1.0]]}},
        {"parameters": {"m": {"prior": {"median": -1, "spread": 1}}}},
    ],
)
def test_what_makes_no_sense_is_refused_in_a_line(browser, change) -> None:
    before = browser.get("/api/draft").json()
    answer = browser.patch("/api/draft", json={"change": change})
    assert answer.status_code == 422
    assert "\n" not in answer.json()["error"]
    assert browser.get("/api/draft").json() == before


def test_deleted_things_come_back_with_undo(server, trial) -> None:
    browser = server.browser()
    id_ = browser.recording(trial)
    name = browser.get(f"/api/recordings/{id_}").json()["name"]
    browser.change(recordings=[id_])
    assert browser.delete(f"/api/recordings/{id_}").status_code == 204
    assert browser.get(f"/api/recordings/{id_}").status_code == 404
    assert browser.get("/api/draft").json()["draft"]["recordings"] == []
    assert browser.get("/api/draft").json()["undo"] == f"delete recording {name}"
    browser.post("/api/draft/undo")
    assert browser.get(f"/api/recordings/{id_}").status_code == 200
    browser.post("/api/draft/redo")
    assert browser.get(f"/api/recordings/{id_}").status_code == 404


def test_undo_does_not_bring_back_what_somebody_else_deleted(server) -> None:
    first, other = server.browser(), server.browser()
    id_ = first.post("/api/subjects", json={"code": "mine and yours"}).json()["id"]

    def there() -> bool:
        return id_ in [p["id"] for p in first.get("/api/subjects").json()["subjects"]]

    first.delete(f"/api/subjects/{id_}")
    first.post("/api/draft/undo")
    first.post("/api/draft/redo")
    first.post("/api/draft/undo")
    assert there()
    other.delete(f"/api/subjects/{id_}")
    for step in ("redo", "undo"):  # neither is its to take
        answer = first.post(f"/api/draft/{step}")
        assert answer.status_code == 409
        assert not there()
    other.post("/api/draft/undo")
    assert there()
