"""One server and one browser for all of these tests, and files to work on."""

import os
import re
import shutil
import subprocess
import sys
import threading
from collections.abc import Iterator
from pathlib import Path
from typing import Any

import numpy as np
import pytest
from playwright import sync_api

from surae.protocol import Protocol, generate
from surae.recording import write_csv
from surae.studies import virtual_subject, virtual_trial

expect = sync_api.expect
CHROMIUM = ("chromium", "chromium-browser", "google-chrome", "chrome")
FLAGS = [
    "--no-sandbox",
    "--disable-gpu",
    "--disable-quic",
    "--no-first-run",
    "--disable-background-networking",
    "--disable-component-update",
    "--disable-sync",
    # One process draws all pages: else every page of every test starts another, and a spare one.
    "--renderer-process-limit=1",
    "--disable-features=SpareRendererForSitePerProcess,Translate,MediaRouter,OptimizationHints,"
    "ProactivelySwapBrowsingInstance,IsolateOrigins,site-per-process,BackForwardCache",
    "--disable-site-isolation-trials",
    "--in-process-gpu",
]
#: Has a page complain that reads a field which an answer, or a thing in it, has not.
HELD = """(() => {
  const plain = new Set(["then", "toJSON", "constructor", "length"]);
  const held = (value, path, whole = false) => {
    if (value === null || typeof value !== "object") return value;
    for (const key of Object.keys(value)) value[key] = held(value[key], path);
    if (Array.isArray(value) || !(whole || ("id" in value && "created" in value))) return value;
    return new Proxy(value, { get(thing, key) {
      if (typeof key === "string" && !(key in thing) && !plain.has(key)) {
        console.error(`Refused to read ${key}: no field of a thing of ${path}`);
      }
      return thing[key];
    } });
  };
  const json = Response.prototype.json;
  Response.prototype.json = async function () {
    return held(await json.call(this), new URL(this.url).pathname, this.ok);
  };
})()"""
#: When everybody was measured.
DAY = "2026-03-04"
#: Of a window.
SIZE = {"width": 1280, "height": 800}
_ADDRESS = re.compile(r"http://\S+?(?=/? )")
#: A draft in which nothing is left out, as a session asks.
WHOLE = {"model": "muscle", "starts": 1}
MUSCLES = ("ta", "gl", "sol", "gm")
#: Milliseconds that a page may take on a busy computer, the first compilation of kernels included.
PATIENCE = 120_000


class Server:
    """`surae serve` as a process of its own."""

    def __init__(self, folder: Path, port: int = 0) -> None:
        self.folder = folder
        command = [sys.executable, "-m", "surae", "serve", str(folder), "--no-open"]
        self.process = subprocess.Popen(
            [*command, "--port", str(port), "--workers", "1"],
            stdout=subprocess.PIPE,
            stderr=subprocess.STDOUT,
            text=True,
        )
        self.said: list[str] = []
        self._heard = threading.Event()
        self._reader = threading.Thread(target=self._read, daemon=True)
        self._reader.start()
        self._heard.wait(PATIENCE / 1000)
        match = _ADDRESS.search(" ".join(self.said))
        if match is None:
            raise AssertionError(f"surae serve did not start: {self.said}")
        self.address = match.group()

    def _read(self) -> None:
        assert self.process.stdout is not None
        for line in self.process.stdout:
            self.said.append(line + " ")
            if _ADDRESS.search(line + " "):
                self._heard.set()
        self._heard.set()  # it has ended

    def stop(self) -> None:
        """End it as Ctrl-C or a shutdown does, and let go of its pipe."""
        self.process.terminate()
        try:
            self.process.wait(60)
        except subprocess.TimeoutExpired:
            self.process.kill()
            self.process.wait()
        self._reader.join(5)
        assert self.process.stdout is not None
        self.process.stdout.close()


class Desk:
    """One browser window, which notes whatever a page must not do."""

    def __init__(self, browser: Any, server: Server) -> None:
        self.context = browser.new_context(viewport=SIZE)
        self.context.set_default_timeout(PATIENCE)
        expect.set_options(timeout=PATIENCE)
        self.address = server.address
        self.outside: list[str] = []
        self.complaints: list[str] = []
        self.context.on("request", self._requested)
        self.context.on("console", self._said)
        self.context.on("weberror", lambda error: self.complaints.append(str(error.error)))
        self.context.add_init_script(HELD)
        self.page = self.context.new_page()

    def _requested(self, request: Any) -> None:
        own = (self.address + "/", "blob:", "data:")
        if not request.url.startswith(own):
            self.outside.append(request.url)

    def _said(self, message: Any) -> None:
        if "Content Security Policy" in message.text or "Refused to" in message.text:
            self.complaints.append(message.text)

    def go(self, path: str) -> Any:
        """Open a page and wait until its scripts have filled it."""
        self.page.goto(self.address + path)
        self.page.locator("#undo[aria-label]").wait_for()
        return self.page

    def research(self, on: bool) -> None:
        """Show, from the next page on, what research needs."""
        if self.page.url == "about:blank":
            self.go("/live")
        self.page.evaluate("on => localStorage.setItem('surae.research', on)", "on" if on else "")

    def api(self, method: str, path: str, body: Any = None) -> Any:
        """What a page's own script would get."""
        if self.page.url == "about:blank":
            self.go("/cohort")
        return self.page.evaluate(
            """async ([method, path, body]) => {
              const csrf = document.querySelector('meta[name="csrf-token"]').content;
              const answer = await fetch(path, {
                method,
                headers: { "X-CSRF-Token": csrf, "Content-Type": "application/json" },
                body: method === "GET" ? undefined : JSON.stringify(body),
              });
              const text = await answer.text();
              if (!answer.ok) throw new Error(`${path}: ${text}`);
              return text ? JSON.parse(text) : null;
            }""",
            [method, path, body],
        )

    def add(self, path: Path) -> str:
        """Import one of our CSVs through the page, as it is; the id of the recording."""
        page = self.go("/import")
        page.set_input_files("#files", path)
        page.get_by_text("As it will be imported").wait_for()
        page.get_by_label("Day of the visit").fill(DAY)
        page.get_by_role("button", name="Import this recording").click()
        page.wait_for_url("**/recordings/*")
        return str(page.url.rsplit("/", 1)[-1])

    def wait_for_job(self, job: dict[str, Any]) -> dict[str, Any]:
        """The job when it has ended."""
        ended = self.page.evaluate(
            """([id, most]) => new Promise((done) => {
              const source = new EventSource(`/api/jobs/${id}/events`);
              const finish = (job) => { source.close(); done(job); };
              source.addEventListener("end", (event) => finish(JSON.parse(event.data)));
              setTimeout(() => finish(null), most);
            })""",
            [job["id"], PATIENCE],
        )
        assert ended is not None, job
        return dict(ended)

    def renew(self) -> None:
        """Leave the page, and forget the session, what the browser kept and what was noted."""
        self.page.unroute_all(behavior="ignoreErrors")
        if self.page.url.startswith(self.address):
            self.page.evaluate("localStorage.clear()")
        self.page.goto("about:blank")
        self.context.clear_cookies()
        self.page.emulate_media(media="screen", color_scheme="light")
        self.page.set_viewport_size(SIZE)
        self.outside.clear()
        self.complaints.clear()

    def judge(self) -> None:
        """Fail when a page asked another computer or broke its own rules."""
        assert self.outside == []
        assert self.complaints == []

    def close(self) -> None:
        """Close the window, and judge."""
        self.context.close()
        self.judge()


@pytest.fixture(scope="package")
def browser() -> Iterator[Any]:
    """A headless Chromium; never missing where the tests are run for all."""
    path = next((file for name in CHROMIUM if (file := shutil.which(name))), None)
    if path is None and os.environ.get("CI"):
        pytest.fail("no Chromium: install it, the workbench is tested with it")
    if path is None:
        pytest.skip("THE WORKBENCH'S PAGES ARE NOT TESTED: no Chromium is installed")
    with sync_api.sync_playwright() as playwright:
        opened = playwright.chromium.launch(executable_path=path, args=FLAGS)
        yield opened
        opened.close()


@pytest.fixture(scope="package")
def server(tmp_path_factory: pytest.TempPathFactory) -> Iterator[Server]:
    """The workbench over an empty project."""
    running = Server(tmp_path_factory.mktemp("bench") / "knee")
    yield running
    running.stop()


@pytest.fixture(scope="package")
def window(browser: Any, server: Server) -> Iterator[Desk]:
    """A window for all tests: to open one takes as long as most of what they look at."""
    opened = Desk(browser, server)
    yield opened
    opened.context.close()


@pytest.fixture
def desk(window: Desk) -> Iterator[Desk]:
    """The window onto the workbench, as if it were new, with a session of its own."""
    window.renew()
    yield window
    window.judge()


@pytest.fixture(scope="package")
def trial() -> Any:
    """A short trial of a virtual subject, with the thesis's noise."""
    protocol = Protocol(
        profile="multiple-holds", chirp_amplitude=0.1, chirp_rate=0.2, rate_hz=64.0, duration=20.0
    )
    return virtual_trial(virtual_subject(1), generate(protocol))


@pytest.fixture(scope="package")
def csv(trial: Any, tmp_path_factory: pytest.TempPathFactory) -> Path:
    """The trial as a CSV of ours."""
    path = tmp_path_factory.mktemp("files") / "walk-in.csv"
    emg = {f"emg_{m}_V": np.maximum(trial.emg[:, i], 0.0) for i, m in enumerate(MUSCLES)}
    columns = {"time_s": trial.time, "angle_rad": trial.angle, "torque_Nm": trial.torque, **emg}
    write_csv(path, columns, ["emg: envelope"])
    return path


@pytest.fixture(scope="package")
def mat(trial: Any, tmp_path_factory: pytest.TempPathFactory) -> Path:
    """The trial as a laboratory's own MAT file: other names, degrees, millivolts, torque turned."""
    from scipy.io import savemat

    path = tmp_path_factory.mktemp("files") / "lab.mat"
    emg = {f"chan{i + 1}": 1e3 * np.maximum(trial.emg[:, i], 0.0) for i in range(4)}
    content = {"time": trial.time, "hoek": np.degrees(trial.angle), "moment": -trial.torque}
    savemat(path, content | emg)
    return path


@pytest.fixture(scope="package")
def done(browser: Any, server: Server, csv: Path) -> dict[str, str]:
    """A project with a subject, a recording, a fit and a study: ids by kind."""
    desk = Desk(browser, server)
    subject = desk.api(
        "POST", "/api/subjects", {"code": "S77", "group": "patient", "notes": "", "body_mass": None}
    )
    recording = desk.add(csv)
    desk.api("PATCH", f"/api/recordings/{recording}", {"name": "seeded", "subject": subject["id"]})
    change = {
        "recordings": [recording],
        "model": "muscle",
        "starts": 1,
        "exclusions": {recording: [[2.0, 3.0]]},
    }
    desk.api("PATCH", "/api/draft", {"change": change, "label": "fit it"})
    job = desk.wait_for_job(desk.api("POST", "/api/fits", {"name": "seeded fit"}))
    assert job["state"] == "done", job
    asked = {"recordings": [recording], "name": "seeded session"}
    whole = WHOLE | {"exclusions": {recording: None}}
    desk.api("PATCH", "/api/draft", {"change": whole, "label": "all of it"})
    session = desk.wait_for_job(desk.api("POST", "/api/sessions", asked))
    assert session["state"] == "done", session
    desk.api("POST", "/api/studies", {"toml": 'protocol = "sine"\n', "start": False})
    desk.close()
    return {
        "recording": recording,
        "fit": job["result"],
        "session": session["result"],
    }
