"""Who may ask, and how: names, origins, tokens, sizes, paths."""

import contextlib
import csv
import http.client
import json
import socket
import time
from collections.abc import Callable, Iterator
from functools import partial
from pathlib import Path
from urllib.parse import urlsplit

import httpx
import pytest

from answering import Answering
from surae_workbench.web import server as module
from surae_workbench.web.app import create_app
from surae_workbench.web.imports import file_name
from surae_workbench.web.security import Policy, is_loopback
from surae_workbench.web.workbench import Workbench

from .test_web_damage import OTHERS, SUBJECT, recording

#: Certificates of the world's authorities are read for each, and nobody here shows one.
get = partial(httpx.get, verify=False)
WRITES = [
    ("POST", "/api/draft/undo"),
    ("PATCH", "/api/draft"),
    ("DELETE", "/api/uploads/" + "0" * 16),
]


def raw(server, method: str, path: str, headers: dict[str, str]) -> tuple[int, dict[str, str], str]:
    """A request that no library improves."""
    connection = http.client.HTTPConnection(urlsplit(server.address).netloc, timeout=60)
    connection.putrequest(method, path, skip_host=True, skip_accept_encoding=True)
    for key, value in headers.items():
        connection.putheader(key, value)
    connection.endheaders()
    answer = connection.getresponse()
    told = answer.status, dict(answer.getheaders()), answer.read().decode()
    connection.close()
    return told


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
        {"Origin": "http://["},
        {"Origin": "http://localhost:1"},
        {"Sec-Fetch-Site": "cross-site"},
        {"Sec-Fetch-Site": "same-site"},
    ],
)
def test_another_site_changes_nothing(browser, headers) -> None:
    for method, path in (*WRITES, ("GET", "/api/session"), ("GET", "/")):
        if path != "/" or "Origin" in headers:  # a link gets a page that asks again
            assert browser.request(method, path, headers=headers).status_code == 403


def test_cookies_of_other_programs_do_no_harm(serve) -> None:
    """Cookies do not know ports: what another program on this computer sets comes here too."""
    server = serve(token="let me in please")
    first = get(server.address + "/api/session?token=let+me+in+please")
    token = first.headers["set-cookie"].partition(";")[0]
    cookie = get(server.address + "/api/session", headers={"Cookie": token})
    session = cookie.headers["set-cookie"].partition(";")[0]
    name = session.partition("=")[0]
    for other in (
        'other_app={"theme":"dark"}',
        'a="',
        "=",
        ";;",
        'b="x; c=1',
        "é=ü",
        f"x{name}=1",
        f"{name}=" + "x" * 43,
        f"{name}=\xff",
    ):
        for given in (f"{other}; {token}; {session}", f"{token}; {session}; {other}"):
            headers = {"Cookie": given.encode("latin-1")}
            assert get(server.address + "/api/draft", headers=headers).status_code == 200


@pytest.mark.parametrize("token", [None, "", "wrong", "\xe9".encode("latin-1")])
@pytest.mark.parametrize(("method", "path"), WRITES)
def test_without_the_sessions_token_nothing_changes(browser, token, method, path) -> None:
    del browser.headers["X-CSRF-Token"]
    headers = {} if token is None else {"X-CSRF-Token": token}
    answer = browser.request(method, path, headers=headers)
    assert answer.status_code == 403
    assert "X-CSRF-Token" in answer.json()["error"]


def test_the_token_of_another_session_is_no_use(server) -> None:
    first, other = server.browser(), server.browser()
    headers = {"X-CSRF-Token": other.headers["X-CSRF-Token"]}
    assert first.post("/api/draft/undo", headers=headers).status_code == 403


def test_without_a_session_nothing_is_told(server) -> None:
    for path in ("/api/recordings", "/api/draft", "/api/cohort", "/api/jobs"):
        assert get(server.address + path).status_code == 403
        stolen = {f"surae_session_{server.bench.project.id}": "x" * 43}
        assert get(server.address + path, cookies=stolen).status_code == 403


def test_pages_allow_nothing_from_outside(browser, server) -> None:
    for path in ("/api/session", "/api/nothing", "/static/none.js"):
        headers = browser.get(path).headers
        policy = headers["content-security-policy"]
        assert "default-src 'none'" in policy
        assert "unsafe" not in policy
        assert "http" not in policy
        assert headers["x-content-type-options"] == "nosniff"
        assert headers["referrer-policy"] == "no-referrer"
    cookie = get(server.address + "/api/session").headers["set-cookie"]
    assert "HttpOnly" in cookie
    assert "SameSite=Strict" in cookie


def test_another_site_reads_nothing_either(server) -> None:
    """Other ports of this computer are the same site: cookies marked Strict go with them."""
    for site in ("cross-site", "same-site"):
        headers = {"Host": "localhost", "Sec-Fetch-Site": site}
        status, headers_back, _ = raw(server, "GET", "/api/session", headers)
        assert status == 403
        assert "set-cookie" not in headers_back
        # A link that somebody follows comes without the cookies: were it given new ones, the
        # session would be lost. It gets a page that asks again, by then from here.
        status, headers_back, text = raw(server, "GET", "/import", headers)
        assert status == 200
        assert "set-cookie" not in headers_back
        assert 'http-equiv="refresh" content="0"' in text


def test_two_projects_on_one_computer_keep_their_sessions(serve) -> None:
    first, other = serve("one"), serve("other")
    with httpx.Client(verify=False) as client:
        client.get(f"{first.address}/")
        mine = dict(client.cookies)
        client.get(f"{other.address}/")  # cookies do not know ports
        assert dict(client.cookies).items() > mine.items()
        assert client.get(f"{first.address}/api/draft").status_code == 200


@pytest.mark.parametrize(
    "body",
    [
        "[" * 100_000,
        '{"a":' * 50_000,
        "1" * 100_000,
        '{"change": {"seed": NaN}}',
        "\xff",
        '{"change": {"peaks": 1e999}}',
        '{"change": {}, "label": "\\ud800"}',
    ],
)
def test_json_that_is_an_attack_is_refused_in_a_line(browser, body) -> None:
    headers = {"Content-Type": "application/json"}
    answer = browser.patch("/api/draft", content=body.encode("latin-1"), headers=headers)
    assert answer.status_code in (400, 422)
    assert list(answer.json()) == ["error"]


def test_json_without_a_length_has_its_limit(browser) -> None:
    def endless():
        for _ in range(30):
            yield b" " * 100_000

    headers = {"Content-Type": "application/json"}
    assert browser.patch("/api/draft", content=endless(), headers=headers).status_code == 413


def until(holds: Callable[[], object]) -> None:
    end = time.monotonic() + 60
    while not holds():
        assert time.monotonic() < end
        time.sleep(0.02)


def test_a_broken_off_upload_leaves_nothing(server, caplog) -> None:
    browser = server.browser()
    cookies = "; ".join(f"{key}={value}" for key, value in browser.cookies.items())
    head = (
        f"POST /api/uploads?name=a.csv HTTP/1.1\r\nHost: localhost\r\nCookie: {cookies}\r\n"
        f"X-CSRF-Token: {browser.headers['X-CSRF-Token']}\r\nContent-Length: 500\r\n\r\nhello"
    )
    place = urlsplit(server.address)
    folder = server.bench.project.folder / "uploads"

    def files() -> set[Path]:
        return {path for path in folder.rglob("*") if path.is_file()}

    before = files()
    with socket.create_connection((place.hostname, place.port)) as connection:
        connection.sendall(head.encode())
        until(lambda: files() - before)  # what has come so far is there
    until(lambda: not files() - before)
    assert browser.get("/api/uploads").json()["uploads"] == []
    assert not caplog.records


def test_a_mapping_of_other_files_reaches_none(browser) -> None:
    text = """
        name = 1979-05-27
        [channels.angle]
        file = "/etc/passwd"
        column = "x"
        [channels.torque]
        file = "../../project.db"
        column = "x"
    """
    id_ = browser.post("/api/uploads", params={"name": "m.toml"}, content=text.encode()).json()
    answer = browser.get(f"/api/uploads/{id_['id']}/inspect")
    assert answer.status_code == 200, answer.text
    assert answer.json()["mapping"]["channels"] == {}
    assert not answer.json()["ready"]
    for wrong in ("scale = inf", "sign = 2", "[fixed]\nm = nan", "[more]"):
        content = f"{text}\n{wrong}\n".encode()
        id_ = browser.post("/api/uploads", params={"name": "m.toml"}, content=content).json()
        answer = browser.get(f"/api/uploads/{id_['id']}/inspect")
        assert answer.status_code == 400
        assert answer.json()["error"].startswith("m.toml: ")


@pytest.mark.parametrize("code", ["a\u2028b", "a\u202eb", "a\x85b", "a\x1bb", "a\nb"])
def test_a_name_is_on_one_line_and_reads_as_it_is(browser, code) -> None:
    assert browser.post("/api/subjects", json={"code": code}).status_code == 422


def test_the_cohorts_table_runs_no_formula(serve) -> None:
    server = serve()
    database = server.bench.database
    subject = database.add("subject", {**SUBJECT, "code": "=1+1"})
    measured = {**recording("a"), "subject": subject, "condition": "x;=2+2", "trial": '"@x'}
    fit = {**OTHERS["fit"], "recordings": [database.add("recording", measured)]}
    database.add("fit", fit)
    head, row = csv.reader(server.browser().get("/api/cohort.csv").text.splitlines())
    cells = dict(zip(head, row, strict=True))
    assert {"'=1+1", '"@x', "x;'=2+2"} <= set(cells.values())
    assert not any(cell.startswith(("=", "+", "@")) for cell in row)


@pytest.mark.parametrize("toml", ["a = " + "[" * 50_000, "repeats = " + "9" * 5000])
def test_a_study_that_is_an_attack_is_refused_in_a_line(browser, toml) -> None:
    answer = browser.post("/api/studies", json={"toml": toml, "start": False})
    assert answer.status_code == 400
    assert "not valid TOML" in answer.json()["error"]


def test_nothing_is_sent_elsewhere_whatever_the_environment_asks_for(tmp_path, monkeypatch) -> None:
    monkeypatch.setenv("FASTAPI_OTEL_AUTO_CONFIGURE", "true")
    monkeypatch.setenv("OTEL_EXPORTER_OTLP_ENDPOINT", "http://192.0.2.1:4318")
    bench = Workbench(tmp_path / "p", 1)
    app = create_app(bench, Policy.of("127.0.0.1"))
    bench.close()
    asked = getattr(app._app, "_telemetry", {})  # older versions have none
    assert not any(asked.get(key) for key in ("auto_configure", "tracing", "metrics", "logs"))


@contextlib.contextmanager
def answering_as_served(folder: Path) -> Iterator[tuple[Workbench, Answering]]:
    """A workbench with the connections that `surae serve` has."""
    listening = module._listen("127.0.0.1", 0)
    bench = Workbench(folder, 1)
    app = create_app(bench, Policy.of("127.0.0.1"))
    answering = Answering(app, listening, http=module._Connection, ws="none", limit_concurrency=250)
    try:
        yield bench, answering
    finally:
        bench.events.close()
        answering.close()


def test_an_upload_of_which_nothing_comes_is_given_up(server, monkeypatch) -> None:
    monkeypatch.setattr("surae_workbench.web.security._PATIENCE", 0.2)
    browser, address = server.browser(), urlsplit(server.address)
    cookies = "; ".join(f"{key}={value}" for key, value in browser.cookies.items())
    with socket.create_connection((address.hostname, address.port), timeout=60) as slow:
        slow.sendall(
            f"POST /api/uploads?name=a.csv HTTP/1.1\r\nHost: localhost\r\nCookie: {cookies}\r\n"
            f"X-CSRF-Token: {browser.headers['X-CSRF-Token']}\r\n"
            "Content-Length: 100\r\n\r\n".encode()
        )
        assert slow.recv(100).split()[1] == b"408"


def test_a_connection_that_asks_nothing_is_closed(tmp_path, monkeypatch) -> None:
    monkeypatch.setattr(module, "_PATIENCE", 0.2)
    with answering_as_served(tmp_path / "p") as (bench, answering):
        listening = answering.socket
        with socket.create_connection(listening.getsockname(), timeout=60) as slow:
            slow.sendall(b"GET / HTTP/1.1\r\nHost: localhost\r\nX-")
            assert slow.recv(100) == b""
        address = answering.address
        monkeypatch.setattr(module, "_PATIENCE", 1.0)  # this client may be slow, but it asks
        with httpx.Client(verify=False, base_url=address, timeout=60) as client:
            client.get("/api/session")
            with client.stream("GET", "/api/events") as events:  # one that waits for news stays
                time.sleep(1.2)
                assert client.get("/api/draft").status_code == 200
                bench.events.changed("fits")
                assert "event: changed" in events.iter_lines()


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
    assert [path for path in folder.rglob("*") if path.is_file()] == []
    assert browser.post(url, content=b"x" * 100_000).status_code == 201
    long = {"change": {"model": "m" * 3_000_000}}
    assert browser.patch("/api/draft", json=long).status_code == 413


def test_another_address_needs_the_token(serve) -> None:
    server = serve(token="let me in please")
    client = httpx.Client(verify=False, base_url=server.address)
    for path in ("/", "/api/session", "/api/openapi.json", "/static/none"):
        assert client.get(path).status_code == 403
    assert client.get("/api/session", params={"token": "wrong"}).status_code == 403
    answer = client.get("/api/session?x=1&token=let+me+in+please")
    assert answer.status_code == 303
    assert answer.headers["location"] == "/api/session?x=1"
    assert "let" not in answer.headers["set-cookie"]
    again = client.get("/import?token=old")  # never stays in the address, known already or not
    assert again.headers["location"] == "/import"
    assert client.get("/api/session").status_code == 200
    bearer = {"Authorization": "Bearer let me in please"}
    assert get(server.address + "/api/session", headers=bearer).status_code == 200
    client.close()


def test_the_token_leads_to_no_other_server(serve) -> None:
    server = serve(token="let me in please")
    answer = get(server.address + "//evil.example/?token=let+me+in+please")
    assert answer.headers["location"].startswith("/evil.example/")
    for path in ("%09/evil.example", "/%5cevil.example", "%0d%0aX-Other:1", "%0a/evil.example"):
        answer = get(f"{server.address}/{path}?token=let+me+in+please&x=%0d%0a")
        assert answer.status_code == 303
        place = answer.headers["location"]
        assert place[0] == "/"
        assert place[1] not in "/\\\t\r\n"
        assert "x-other" not in answer.headers


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
        ("con", "given-con"),
        ("NUL.csv", "given-NUL.csv"),
        ("com1 .tar.gz", "given-com1 .tar.gz"),
        ("console.csv", "console.csv"),
        ("mapping.toml", "given-mapping.toml"),
        ("é" * 300 + ".csv", "é" * 78 + ".csv"),
    ],
)
def test_names_of_files_are_only_names(name, kept) -> None:
    assert file_name(name) == kept
