"""Who may ask, and how: names, origins, tokens, sizes, paths."""

import http.client
import json
from urllib.parse import urlsplit

import httpx
import pytest

from surae.web.imports import file_name
from surae.web.security import Policy, is_loopback

WRITES = [
    ("POST", "/api/draft/undo"),
    ("PATCH", "/api/draft"),
    ("DELETE", "/api/uploads/" + "0" * 16),
]


def raw(server, method: str, path: str, headers: dict[str, str]) -> tuple[int, dict[str, str], str]:
    """A request that no library improves."""
    connection = http.client.HTTPConnection(urlsplit(server.address).netloc, timeout=10)
    connection.putrequest(method, path, skip_host=True, skip_accept_encoding=True)
    for key, value in headers.items():
        connection.putheader(key, value)
    connection.endheaders()
    answer = connection.getresponse()
    found = answer.status, dict(answer.getheaders()), answer.read().decode()
    connection.close()
    return found


@pytest.mark.parametrize(
    "host", ["evil.example", "evil.example:80", "", "127.0.0.1.evil.example", "[::1", "localhost:x"]
)
def test_another_name_is_refused(server, host) -> None:
    status, _, text = raw(server, "GET", "/api/session", {"Host": host})
    assert status == 400
    assert list(json.loads(text)) == ["error"]


@pytest.mark.parametrize("host", ["localhost", "127.0.0.1:9", "[::1]:8765", "LOCALHOST"])
def test_this_computer_has_several_names(server, host) -> None:
    assert raw(server, "GET", "/api/session", {"Host": host})[0] == 200


@pytest.mark.parametrize(
    "headers",
    [
        {"Origin": "https://evil.example"},
        {"Origin": "null"},
        {"Sec-Fetch-Site": "cross-site"},
        {"Sec-Fetch-Site": "same-site"},
    ],
)
@pytest.mark.parametrize(("method", "path"), WRITES)
def test_another_site_changes_nothing(browser, headers, method, path) -> None:
    assert browser.request(method, path, headers=headers).status_code == 403


@pytest.mark.parametrize("token", [None, "", "wrong"])
@pytest.mark.parametrize(("method", "path"), WRITES)
def test_without_the_sessions_token_nothing_changes(browser, token, method, path) -> None:
    del browser.headers["X-CSRF-Token"]
    headers = {} if token is None else {"X-CSRF-Token": token}
    answer = browser.request(method, path, headers=headers)
    assert answer.status_code == 403
    assert "X-CSRF-Token" in answer.json()["error"]


def test_the_token_of_another_session_is_no_use(server) -> None:
    one, other = server.browser(), server.browser()
    headers = {"X-CSRF-Token": other.headers["X-CSRF-Token"]}
    assert one.post("/api/draft/undo", headers=headers).status_code == 403


def test_without_a_session_nothing_is_told(server) -> None:
    for path in ("/api/recordings", "/api/draft", "/api/cohort", "/api/jobs"):
        assert httpx.get(server.address + path).status_code == 403
        stolen = {"surae_session": "x" * 43}
        assert httpx.get(server.address + path, cookies=stolen).status_code == 403


def test_pages_allow_nothing_from_outside(browser, server) -> None:
    for path in ("/api/session", "/api/nothing", "/static/none.js"):
        headers = browser.get(path).headers
        policy = headers["content-security-policy"]
        assert "default-src 'none'" in policy
        assert "unsafe" not in policy
        assert "http" not in policy
        assert headers["x-content-type-options"] == "nosniff"
        assert headers["referrer-policy"] == "no-referrer"
    cookie = httpx.get(server.address + "/api/session").headers["set-cookie"]
    assert "HttpOnly" in cookie
    assert "SameSite=Strict" in cookie


@pytest.mark.parametrize(
    "id_", ["../../etc/passwd", "..%2f..%2fproject.db", "%00", "0" * 15, "A" * 16, "é" * 16]
)
@pytest.mark.parametrize(
    "path", ["/api/recordings/{}", "/api/fits/{}/fit.json", "/api/uploads/{}/inspect", "/static/{}"]
)
def test_ids_lead_nowhere_else(browser, path, id_) -> None:
    answer = browser.get(path.format(id_))
    assert answer.status_code in (404, 405, 422)
    assert "root:" not in answer.text


def test_static_files_end_at_their_folder(server) -> None:
    for path in (
        "/static/../app.py",
        "/static/..%2fapp.py",
        "/static/%2e%2e/app.py",
        "//etc/passwd",
    ):
        status, _, text = raw(server, "GET", path, {"Host": "localhost"})
        assert status == 404
        assert "create_app" not in text


def test_too_much_is_refused_while_it_comes(serve) -> None:
    server = serve(upload_bytes=100_000)
    browser = server.browser()
    url = "/api/uploads?name=big.csv"
    assert browser.post(url, content=b"x" * 100_001).status_code == 413

    def endless():
        for _ in range(30):
            yield b"x" * 10_000

    assert browser.post(url, content=endless()).status_code == 413  # no length announced
    assert browser.get("/api/uploads").json()["uploads"] == []
    folder = server.bench.project.folder / "uploads"
    assert [one for one in folder.rglob("*") if one.is_file()] == []
    assert browser.post(url, content=b"x" * 100_000).status_code == 201
    long = {"change": {"model": "m" * 3_000_000}}
    assert browser.patch("/api/draft", json=long).status_code == 413


def test_another_address_needs_the_token(serve) -> None:
    server = serve(token="let me in please")
    client = httpx.Client(base_url=server.address)
    for path in ("/", "/api/session", "/api/openapi.json", "/static/none"):
        assert client.get(path).status_code == 403
    assert client.get("/api/session", params={"token": "wrong"}).status_code == 403
    answer = client.get("/api/session?x=1&token=let+me+in+please")
    assert answer.status_code == 303
    assert answer.headers["location"] == "/api/session?x=1"
    assert "let" not in answer.headers["set-cookie"]
    assert client.get("/api/session").status_code == 200
    bearer = {"Authorization": "Bearer let me in please"}
    assert httpx.get(server.address + "/api/session", headers=bearer).status_code == 200
    client.close()


def test_the_token_leads_to_no_other_server(serve) -> None:
    server = serve(token="let me in please")
    answer = httpx.get(server.address + "//evil.example/?token=let+me+in+please")
    assert answer.headers["location"].startswith("/evil.example/")


def test_policies() -> None:
    assert is_loopback("127.0.0.1")
    assert is_loopback("::1")
    assert is_loopback("localhost")
    assert not is_loopback("0.0.0.0")
    assert not is_loopback("192.168.1.4")
    assert not Policy.of("192.168.1.4").allows_host("10.0.0.1")
    assert Policy.of("192.168.1.4").allows_host("192.168.1.4:8765")
    assert Policy.of("0.0.0.0").allows_host("10.0.0.1:1")
    assert not Policy.of("0.0.0.0").allows_host("evil.example")


@pytest.mark.parametrize(
    ("name", "kept"),
    [
        ("trial.csv", "trial.csv"),
        ("../../etc/passwd", "passwd"),
        ("C:\\data\\Trial 1.c3d", "Trial 1.c3d"),
        (".hidden", "hidden"),
        ("a\0b\n.csv", "a_b_.csv"),
        ("..", "file"),
        ("mapping.toml", "given-mapping.toml"),
    ],
)
def test_names_of_files_are_only_names(name, kept) -> None:
    assert file_name(name) == kept
