"""A whole rehearsed session in Chromium, by keyboard: screenshots of both pages, and figures.

    python benchmarks/rehearsal.py FOLDER [SECONDS]

Maximum contractions, a passive trial and three active ones; in the second of these an electrode
falls off at 12 s, and R repeats it. Then N loads what to measure next. Prints a line of JSON for
each trial, then the milliseconds from a sample to the screen.
"""

import json
import re
import shutil
import subprocess
import sys
import time
from pathlib import Path

import numpy as np
from playwright.sync_api import Page, expect, sync_playwright

PATIENCE = 300_000


class Operator:
    """Who presses the keys."""

    def __init__(self, page: Page, folder: Path) -> None:
        self.page, self.folder = page, folder
        self.shots = 0

    def shot(self, name: str, page: Page | None = None) -> None:
        """Keep what is on the screen."""
        self.shots += 1
        (page or self.page).screenshot(path=self.folder / f"{self.shots:02d}-{name}.png")

    def load(self, profile: str, task: str, seconds: float) -> None:
        """Ask for a movement, in the form, with Enter."""
        self.page.select_option("#profile", profile)
        if self.page.locator("#task").is_enabled():  # a designed movement has its own
            self.page.select_option("#task", task)
            self.page.fill("#seconds", f"{seconds:g}")
        self.page.get_by_role("button", name="Load", exact=True).press("Enter")
        expect(self.page.locator("#asked")).to_contain_text(profile, timeout=PATIENCE)
        self.page.locator("#clock").click()

    def begin(self, key: str = "Space") -> int:
        """Start a trial with a key; its number."""
        expect(self.page.locator("#clock")).to_have_text("Ready", timeout=PATIENCE)
        expect(self.page.locator("#start")).to_be_enabled(timeout=PATIENCE)
        self.page.keyboard.press(key)
        expect(self.page.locator("#clock")).to_contain_text("Trial", timeout=PATIENCE)
        return int(re.search(r"\d+", self.page.locator("#clock").inner_text())[0])

    def fault(self, kind: str, at: float) -> None:
        """Have something go wrong in the next trial; the buttons do at once."""
        answer = self.page.evaluate(
            """([kind, at]) => fetch("/api/live/fault", { method: "POST", headers: {
                 "Content-Type": "application/json", "X-CSRF-Token":
                 document.querySelector("meta[name=csrf-token]").content },
                 body: JSON.stringify({ kind, at }) }).then((told) => told.status)""",
            [kind, at],
        )
        assert answer == 200

    def at(self, seconds: float) -> None:
        """Wait until so much of the trial is over."""
        said = "(?:" + "|".join(str(n) for n in range(round(seconds), round(seconds) + 40)) + ") of"
        expect(self.page.locator("#clock")).to_contain_text(re.compile(f"· {said}"), timeout=60_000)

    def judged(self, trial: int) -> dict:
        """Wait for what is said of a trial."""
        expect(self.page.locator("#verdict strong")).to_contain_text(
            f"Trial {trial}:", timeout=PATIENCE
        )
        state = self.page.evaluate("fetch('/api/live').then((told) => told.json())")
        said = next(each for each in state["trials"] if each["trial"] == trial)
        told = {
            key: said.get(key)
            for key in (
                "trial",
                "protocol",
                "use",
                "effort",
                "grade",
                "vaf",
                "verdict",
                "advice",
                "seconds_to_verdict",
                "marks",
            )
        }
        print(json.dumps(told, ensure_ascii=False), flush=True)
        return said


def session(operator: Operator, subject: Page, seconds: float) -> None:
    """The whole session."""
    page = operator.page
    operator.load("maximum", "active", 18)
    operator.shot("ready")
    trial = operator.begin()
    operator.at(5)
    operator.shot("maximum")
    operator.shot("maximum-subject", subject)
    operator.judged(trial)
    operator.load("multiple-holds", "passive", seconds)
    trial = operator.begin()
    operator.at(6)
    operator.shot("passive-subject", subject)
    operator.judged(trial)
    operator.load("multiple-holds", "active", seconds)
    trial = operator.begin()
    operator.at(8)
    page.keyboard.press("m")
    operator.shot("active")
    operator.shot("active-subject", subject)
    assert operator.judged(trial)["marks"], "M marks nothing"
    operator.shot("kept")
    operator.fault("electrode-off", 12.0)
    spoilt = operator.judged(operator.begin("r"))
    operator.shot("spoilt")
    assert spoilt["verdict"] == "repeat", spoilt
    assert "electrode" in spoilt["advice"], spoilt
    page.get_by_role("button", name="mend all").click()
    page.locator("#clock").click()
    operator.judged(operator.begin("r"))
    operator.judged(operator.begin("r"))
    begun = time.monotonic()
    expect(page.locator("#next")).to_be_visible(timeout=2 * PATIENCE)
    expect(page.locator("#session")).to_contain_text(
        "Trials 1, 2, 3, 5, 6 together", timeout=2 * PATIENCE
    )
    print(json.dumps({"joint_fit_after_the_last_verdict_s": round(time.monotonic() - begun, 1)}))
    page.screenshot(path=operator.folder / "whole-page.png", full_page=True)
    page.locator("#session").screenshot(path=operator.folder / "session.png")
    page.keyboard.press("n")
    expect(page.locator("#asked")).to_contain_text("next: ", timeout=PATIENCE)
    operator.shot("next")


def main(folder: Path, seconds: float) -> None:
    """Make the session, and say what it took."""
    folder.mkdir(parents=True, exist_ok=True)
    process = subprocess.Popen(
        [
            sys.executable,
            "-m",
            "surae",
            "live",
            "--rehearse",
            "--no-open",
            "--port",
            "0",
            "--output",
            str(folder / "leg"),
        ],
        stdout=subprocess.PIPE,
        text=True,
    )
    try:
        address = re.search(r"http://\S+", process.stdout.readline())[0]
        path = next(
            p for n in ("chromium", "chromium-browser", "google-chrome") if (p := shutil.which(n))
        )
        with sync_playwright() as player:
            browser = player.chromium.launch(
                executable_path=path, args=["--no-sandbox", "--disable-gpu"]
            )
            page = browser.new_page(viewport={"width": 1366, "height": 860})
            wrong = []
            page.on("pageerror", lambda error: wrong.append(str(error)))
            page.goto(address)
            expect(page.locator("#profile option")).not_to_have_count(0, timeout=PATIENCE)
            subject = browser.new_context(viewport={"width": 1024, "height": 768}).new_page()
            subject.goto(f"{address}subject")
            session(Operator(page, folder), subject, seconds)
            late = np.array(page.evaluate("window.suraeLatency"))
            print(
                json.dumps(
                    {
                        "frames": len(late),
                        "median_ms": float(np.median(late)),
                        "p99_ms": float(np.quantile(late, 0.99)),
                        "worst_ms": int(late.max()),
                        "wrong": wrong,
                    }
                )
            )
            browser.close()
    finally:
        process.terminate()
        process.communicate(timeout=60)


if __name__ == "__main__":
    main(Path(sys.argv[1]), float(sys.argv[2]) if len(sys.argv) > 2 else 20.0)
