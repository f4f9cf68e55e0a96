"""Take the workbench's pictures: the example's leg, from its folder to the answer, in a browser."""

import shutil
import subprocess
import sys
import tempfile
from pathlib import Path

from playwright.sync_api import sync_playwright

import surae
from surae.recording import csv_columns, write_csv

HERE = Path(__file__).parent


def turned(trials: Path, folder: Path) -> list[Path]:
    """Two of the trials as a laboratory has them that counts the other way."""
    made = []
    for name in ("slow_stretch", "active_1"):
        recording = surae.read(trials / f"{name}.csv", sign={"angle": -1, "torque": -1})
        made.append(folder / f"{name}.csv")
        write_csv(made[-1], csv_columns(recording), [f"name: {name}", "emg: raw"])
    return made


SURAE = (sys.executable, "-m", "surae")

with tempfile.TemporaryDirectory() as folder, sync_playwright() as playwright:
    trials = Path(folder, "leg")
    subprocess.run([*SURAE, "example", "--folder", str(trials)], check=True)
    serve = [*SURAE, "serve", str(Path(folder, "my-project")), "--no-open", "--port", "0"]
    with subprocess.Popen(serve, stdout=subprocess.PIPE, text=True) as server:
        assert server.stdout is not None
        address = next(word for line in server.stdout for word in line.split() if "http" in word)
        browser = playwright.chromium.launch(
            executable_path=shutil.which("chromium"), args=["--no-sandbox"]
        )
        page = browser.new_page(viewport={"width": 1440, "height": 960})
        page.set_default_timeout(600_000)
        page.goto(f"{address}import")
        page.locator("#undo[aria-label]").wait_for()
        page.set_input_files("#files", turned(trials, Path(folder)))
        page.locator(".remedy").first.wait_for()
        page.locator(".remedy progress").first.wait_for(state="detached")
        page.get_by_label("Day of the visit").fill("2026-03-04")
        page.locator("#offer-card").screenshot(path=HERE / "import.png")
        page.reload()
        page.get_by_role("button", name="Begin anew").click()
        page.locator("#uploads-card").wait_for(state="hidden")
        page.set_input_files("#files", sorted(trials.iterdir()))
        page.get_by_label("Day of the visit").fill("2026-03-04")
        page.get_by_role("button", name="Analyse").click()
        page.wait_for_url("**/sessions/*")
        page.locator(".report .leg").wait_for()
        for theme in ("light", "dark"):
            page.emulate_media(color_scheme=theme)
            page.reload()
            page.locator("#undo[aria-label]").wait_for()
            page.screenshot(path=HERE / f"workbench-{theme}.png")
        browser.close()
        server.terminate()
