"""Take the picture of the operator's page: a robot that never heard of surae, and its verdict."""

import os
import shutil
import sys
import tempfile
import threading
from pathlib import Path

import numpy as np
from playwright.sync_api import expect, sync_playwright

from surae.protocol import Protocol, generate
from surae.studies import virtual_recording, virtual_subject
from surae_workbench.live.lsl import SESSION, lsl, outlet
from surae_workbench.live.pages import ServedRoom, create_app
from surae_workbench.web.security import Policy

HERE = Path(__file__).parent
sys.path.insert(0, str(HERE.parents[1] / "tests"))
from answering import Answering  # noqa: E402

os.environ[SESSION] = f"picture-{os.getpid()}"
RATE = 1000.0
PATIENCE = 300_000.0
asked = Protocol(profile="multiple-holds", task="active", duration=60.0, rate_hz=RATE)
channels = virtual_recording(virtual_subject(3), generate(asked)).channels
angle = np.degrees(channels["angle"].values)
robot = np.column_stack([angle, channels["torque"].values, np.full(len(angle), 31.0)])
emg = np.column_stack([1e6 * channels[f"emg_{m}"].values for m in ("ta", "gl", "sol", "gm")])
clock = lsl().local_clock
NAMES = ["Ankle position", "Ankle moment", "Motor"], ["TA", "GasLat", "Soleus", "GasMed"]
streams = [
    (outlet("Robot", "x", NAMES[0], ["deg", "Nm", "C"], RATE, "robot"), robot),
    (outlet("Amplifier", "EMG", NAMES[1], ["uV"] * 4, RATE, "amplifier"), emg),
]
ended = threading.Event()


def send() -> None:
    """Send the leg's signals over and over, in real time."""
    begun = clock()
    sent = 0
    while not ended.wait(0.02):
        due = int((clock() - begun) * RATE)
        rows = np.arange(sent, due) % len(robot)
        for stream, values in streams:
            stream.push_chunk(values[rows], clock())
        sent = due


threading.Thread(target=send, daemon=True).start()
with tempfile.TemporaryDirectory() as folder, sync_playwright() as playwright:
    served = ServedRoom(Path(folder, "leg"))
    served.warm()
    answering = Answering(create_app(served, Policy.of("127.0.0.1"), None))
    browser = playwright.chromium.launch(
        executable_path=shutil.which("chromium"), args=["--no-sandbox"]
    )
    page = browser.new_page(viewport={"width": 1366, "height": 768})
    page.set_default_timeout(PATIENCE)
    page.goto(answering.address)
    expect(page.locator("#clock")).to_have_text("Which channel is which?", timeout=PATIENCE)
    page.click("#start")
    page.wait_for_timeout(20_000)
    page.click("#start")
    expect(page.locator("#verdict")).to_be_visible(timeout=PATIENCE)
    page.click("#channels-form button[type=submit]")
    expect(page.locator("#trials .pill")).to_contain_text("Keep", timeout=PATIENCE)
    page.wait_for_timeout(12_000)
    page.screenshot(path=HERE / "live.png", full_page=True)
    browser.close()
    served.stop()
    answering.close()
    served.close()
ended.set()
