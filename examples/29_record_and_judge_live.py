"""
How is a trial judged while the subject is still there?
=======================================================

``surae live`` records streams of the Lab Streaming Layer and judges each trial as it ends. Here it
rehearses, with nobody and no browser: a simulated device and leg stream one trial in real time.
"""

import json
import subprocess
import sys
import tempfile
from pathlib import Path

import matplotlib.pyplot as plt

import surae

folder = Path(tempfile.mkdtemp(), "rehearsal")
rehearse = ["live", "--rehearse", "--unattended", "--trials", "1", "--seconds", "20"]
command = [sys.executable, "-m", "surae", *rehearse, "--output", str(folder)]
done = subprocess.run(command, capture_output=True, text=True, check=True)
(line,) = [json.loads(each) for each in done.stdout.splitlines() if each.startswith("{")]
print({key: line[key] for key in ("trial", "grade", "vaf", "findings", "seconds_to_verdict")})

recording = surae.read(folder / Path(line["recording"]).name)
figure, (above, below) = plt.subplots(2, 1, figsize=(8, 4), sharex=True, layout="constrained")
angle, torque = recording["angle"], recording["torque"]
above.plot(angle.time, 57.2958 * angle.values, color="black", linewidth=0.8)
above.set(ylabel="Angle [°]", title="What was recorded")
below.plot(torque.time, torque.values, color="black", linewidth=0.8)
below.set(xlabel="Time [s]", ylabel="Torque [Nm]")
plt.show()
