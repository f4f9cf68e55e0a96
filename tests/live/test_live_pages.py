"""The pages: who may see and do what, and what is refused, without a browser."""

import re
from collections.abc import Callable, Iterator
from contextlib import ExitStack

import httpx
import pytest
from streaming import serving

from surae.api import ready_protocols
from surae_workbench.live.pages import ServedRoom
from surae_workbench.web.security import Policy

OPERATOR, SUBJECT = "operator-token", "subject-token"


@pytest.fixture(scope="module")
def served(lsl, tmp_path_factory):
    made = ServedRoom(
        tmp_path_factory.mktemp("pages"), mapping=None, network=False, device="achilles"
    )
    yield made
    made.close()


@pytest.fixture(scope="module")
def here(served) -> Iterator[str]:
    """The address where only this computer may ask."""
    with serving(served, Policy.of("127.0.0.1"), None) as address:
        yield address


@pytest.fixture(scope="module")
def beyond(served) -> Iterator[str]:
    """The address of a server that others reach, too."""
    with serving(served, Policy.of("0.0.0.0", OPERATOR), SUBJECT) as address:
        yield address


@pytest.fixture
def client() -> Iterator[Callable[[str], httpx.Client]]:
    """Makes browsers."""
    with ExitStack() as made:
        yield lambda address: made.enter_context(
            httpx.Client(base_url=address, verify=False, follow_redirects=True, timeout=60.0)
        )


def opened(browser: httpx.Client) -> str:
    """Load the operator's page; the token of its requests."""
    text = browser.get("/").text
    return text.partition('name="csrf-token" content="')[2].partition('"')[0]


def test_the_operator_loads_starts_and_stops(client, here) -> None:
    browser = client(here)
    headers = {"X-CSRF-Token": opened(browser)}
    loaded = browser.post(
        "/api/live/load",
        json={"profile": "sine", "task": "passive", "seconds": 20},
        headers=headers,
    )
    assert loaded.status_code == 200, loaded.text
    state = browser.get("/api/live").json()
    assert state["asked"] == {"protocol": "sine passive", "seconds": 20.0, "effort": "passive"}
    assert any(re.search("torque of virtual legs.*within", e["text"]) for e in state["limits"])
    names = [movement["name"] for movement in state["profiles"]]
    assert names[0] in ready_protocols()
    assert {"maximum", "sine"} < set(names)
    assert state["alarms"] == []
    assert len(state["curve"]["t"]) == len(state["curve"]["effort"])
    begun = browser.post("/api/live/start", json={}, headers=headers).json()
    assert browser.get("/api/live").json()["running"] == begun["trial"]
    again = browser.post("/api/live/start", json={}, headers=headers)
    assert (again.status_code, "is running" in again.json()["error"]) == (400, True)
    assert browser.post("/api/live/mark", json={"text": "cough"}, headers=headers).is_success
    assert browser.post("/api/live/stop", json={}, headers=headers).is_success
    trial = browser.get("/api/live").json()["trials"][-1]
    assert trial["marks"][0]["text"] == "cough"


@pytest.mark.parametrize("state", ["silent", "lost"])
def test_a_stream_that_sends_nothing_is_an_alarm_for_as_long(served, monkeypatch, state) -> None:
    streams = [{"name": "EMG", "kind": "EMG", "state": state}]
    monkeypatch.setattr(served.room.trials.recorder, "health", lambda: streams)
    assert [alarm["text"] for alarm in served.health()["alarms"]] == [
        "EMG sends nothing: look at its program, cable and battery."
    ]
    streams[0]["state"] = "good"
    assert served.health()["alarms"] == []


@pytest.mark.parametrize(
    ("name", "body", "says"),
    [
        ("load", {"profile": "nothing", "task": "active"}, "nothing"),
        ("load", {"profile": "sine", "task": "active", "seconds": "x"}, "seconds"),
        ("load", {"profile": 3}, "profile"),
        ("dance", {}, "there is no such page"),
        ("next", {}, "measure next"),
        ("fault", {"kind": "hum"}, "no rehearsal"),
    ],
)
def test_what_makes_no_sense_is_refused_in_a_line(client, here, name, body, says) -> None:
    browser = client(here)
    answer = browser.post(f"/api/live/{name}", json=body, headers={"X-CSRF-Token": opened(browser)})
    assert answer.status_code in (400, 404, 422)
    assert says in answer.json()["error"]


def test_the_subjects_page_asks_for_nothing_but_its_own(client, here, served, monkeypatch) -> None:
    browser = client(here)
    browser.get("/subject")
    monkeypatch.delattr(type(served), "state")
    assert browser.get("/api/subject").status_code == 200


def test_another_site_can_do_nothing(client, here) -> None:
    browser = client(here)
    token = opened(browser)
    assert browser.post("/api/live/stop", json={}).status_code == 403
    elsewhere = {"X-CSRF-Token": token, "Origin": "http://example.org"}
    assert browser.post("/api/live/stop", json={}, headers=elsewhere).status_code == 403
    assert browser.get("/", headers={"Host": "example.org"}).status_code == 400
    policy = browser.get("/").headers["content-security-policy"]
    assert "script-src 'self'" in policy


def test_beyond_this_computer_everything_needs_a_token(client, beyond) -> None:
    for path in ("/", "/subject", "/api/live", "/api/subject", "/static/live/live.css"):
        assert client(beyond).get(path).status_code == 403, path
    browser = client(beyond)
    assert browser.get(f"/?token={OPERATOR}").status_code == 200
    assert browser.get("/api/live").status_code == 200
    assert browser.get("/static/live/live.css").status_code == 200


def test_the_subjects_token_opens_the_subjects_page_alone(client, beyond) -> None:
    browser = client(beyond)
    assert browser.get(f"/subject?token={SUBJECT}").status_code == 200
    assert browser.get("/static/live/subject.js").status_code == 200
    told = browser.get("/api/subject")
    assert set(told.json()) == {"running", "begin", "now", "curve"}
    for path in ("/", "/api/live", f"/?token={SUBJECT}", f"/api/live?token={SUBJECT}"):
        assert browser.get(path).status_code == 403, path
    wrong = client(beyond)
    assert wrong.get(f"/?token={SUBJECT}").status_code == 403


def test_a_mapping_that_is_being_edited_holds_as_it_was(lsl, tmp_path) -> None:
    mapping = tmp_path / "map.toml"
    mapping.write_text('[channels.angle]\ncolumn = "device: a"\n')
    made = ServedRoom(tmp_path / "leg", mapping=mapping)
    try:
        assert made.health()["roles"] == ["angle"]
        for broken in ("[channels.angle\n", "", "channels = 3\n", '[channels.angle]\nunit = "x"\n'):
            mapping.write_text(broken)
            assert made.health()["roles"] == ["angle"]
        mapping.write_text('[channels.torque]\ncolumn = "device: t"\n')
        assert made.health()["roles"] == ["torque"]
    finally:
        made.close()
