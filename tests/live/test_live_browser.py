"""A rehearsed trial in a browser, with the keyboard alone: both pages, and the verdict."""

import os
import re
import shutil

import numpy as np
import pytest
from playwright import sync_api
from streaming import rehearsing, serving

from surae_workbench.live.lsl import outlet
from surae_workbench.live.pages import ServedRoom
from surae_workbench.web.security import Policy

pytestmark = pytest.mark.slow  # a rehearsal in real time; what the pages are told is tested beside
expect = sync_api.expect
PATIENCE = 240_000


@pytest.fixture(scope="module")
def chromium():
    path = next(
        (p for n in ("chromium", "chromium-browser", "google-chrome") if (p := shutil.which(n))),
        None,
    )
    if path is None:
        if os.environ.get("CI"):
            pytest.fail("Chromium is missing; .ci/browser installs it")
        pytest.skip("LIVE PAGES NOT TESTED: no Chromium here")
    with sync_api.sync_playwright() as player:
        browser = player.chromium.launch(
            executable_path=path, args=["--no-sandbox", "--disable-gpu"]
        )
        expect.set_options(timeout=PATIENCE)  # as long as a busy computer may take
        yield browser
        browser.close()


@pytest.fixture(scope="module")
def address(lsl, tmp_path_factory):
    folder = tmp_path_factory.mktemp("browser")
    with rehearsing(folder / "leg", "--no-open", "--port", "0") as process:
        assert process.stdout is not None
        said = process.stdout.readline()
        match = re.search(r"http://\S+", said)
        assert match, said
        yield match.group()


def test_a_trial_by_keyboard_on_both_pages(chromium, address) -> None:
    page, wrong = chromium.new_page(), []
    page.on("pageerror", lambda error: wrong.append(str(error)))
    page.on("console", lambda message: wrong.append(message.text))
    page.goto(address, timeout=PATIENCE)
    expect(page.locator("#profile option")).not_to_have_count(0, timeout=PATIENCE)
    page.select_option("#profile", "sine")
    page.fill("#seconds", "12")
    page.locator("#seconds").press("Enter")
    expect(page.locator("#asked")).to_contain_text("12 s", timeout=PATIENCE)
    expect(page.locator("#clock")).to_have_text("Ready", timeout=PATIENCE)
    expect(page.locator("#streams li")).to_have_count(2)  # our own target is none

    subject = chromium.new_context().new_page()
    subject.on("pageerror", lambda error: wrong.append(str(error)))
    subject.goto(f"{address}subject", timeout=PATIENCE)
    expect(subject.locator("#say")).to_have_text("Relax")
    page.locator("#clock").click()
    page.keyboard.press("Space")
    expect(page.locator("#clock")).to_contain_text("Trial 1", timeout=PATIENCE)
    expect(subject.locator("#say")).to_have_text(re.compile("Ready …|Push down|Pull up"))
    expect(subject.locator("#say")).to_have_text(re.compile("Push down|Pull up"), timeout=PATIENCE)
    assert "Nm" not in subject.inner_text("body")
    page.keyboard.press("m")

    expect(page.locator("#verdict strong")).to_contain_text("Trial 1:", timeout=PATIENCE)
    expect(page.locator("#trials li")).to_have_count(1)
    expect(page.locator("#trials li .pill")).not_to_have_text("being judged")  # with the verdict
    expect(page.locator("#start")).to_contain_text("Start")
    assert len(page.evaluate("window.suraeLatency")) > 30
    assert wrong == []


def test_the_page_names_no_stream_where_none_is_and_draws_what_is_no_number(
    chromium, lsl, tmp_path
) -> None:
    served = ServedRoom(tmp_path)
    page, wrong = chromium.new_page(), []
    page.on("pageerror", lambda error: wrong.append(str(error)))
    try:
        with serving(served, Policy.of("127.0.0.1"), None) as address:
            served.warm()
            page.goto(address, timeout=PATIENCE)
            expect(page.locator("#streams")).to_have_text(re.compile("^None yet"), timeout=PATIENCE)
            device = outlet("device", "x", ["angle"], ["rad"], 100.0, "device")
            for i in range(100):
                rows = np.full((2, 1), np.nan if i % 20 else 0.1 * i)
                device.push_chunk(rows, lsl.local_clock())
                page.wait_for_timeout(50)
            expect(page.locator("#streams")).to_contain_text("values are no numbers")
            expect(page.locator("#streams strong")).to_have_text("device")
            served.stop()
    finally:
        served.close()
        page.close()
    assert wrong == []


def test_a_server_that_is_gone_is_said(chromium, lsl, tmp_path) -> None:
    served = ServedRoom(tmp_path)
    page = chromium.new_page()
    try:
        with serving(served, Policy.of("127.0.0.1"), None) as address:
            page.goto(address, timeout=PATIENCE)
            expect(page.locator("#clock")).not_to_be_empty(timeout=PATIENCE)
            expect(page.locator("#error")).to_be_hidden()
            served.stop()  # as it does before its end: no browser is waited for
        expect(page.locator("#error")).to_contain_text("surae does not answer", timeout=PATIENCE)
    finally:
        served.close()
        page.close()
