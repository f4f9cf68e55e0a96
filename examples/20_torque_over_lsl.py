"""
How do I have the torque of a stream as it comes?
=================================================

A device streams angle, torque and EMG over the Lab Streaming Layer; the predictor answers each
sample with a torque on a stream of its own. Here a thread plays the device.
"""

import threading
import time

import matplotlib.pyplot as plt
import numpy as np

import surae
from surae.protocol import Protocol, generate
from surae.studies import virtual_subject, virtual_trial
from surae_workbench.live.lsl import outlet
from surae_workbench.live.predicting import predict_stream

RATE, SECONDS = 250.0, 4.0
protocol = Protocol(profile="multiple-holds", rate_hz=RATE, task="active")
trial, other = (virtual_trial(virtual_subject(1), generate(protocol), seed=k) for k in (1, 2))
p = surae.fit(trial, "muscle", starts=1).predictor(RATE)

labels = ["angle", "torque", "emg_ta", "emg_gl", "emg_sol", "emg_gm"]
device = outlet("leg", "device", labels, ["rad", "Nm", "V", "V", "V", "V"], RATE, "example")
rows = np.column_stack([other.angle, other.torque, other.emg])[: int(RATE * SECONDS)]


def stream() -> None:
    """Send a trial in real time."""
    begun = time.perf_counter()
    for i, row in enumerate(rows):
        time.sleep(max(begun + i / RATE - time.perf_counter(), 0.0))
        device.push_sample(row.tolist())


sender = threading.Thread(target=stream)
seen = predict_stream(p, "leg", SECONDS + 1.0, ready=sender.start)
sender.join()
print(seen)

figure, (torque, late) = plt.subplots(2, 1, figsize=(8, 4), layout="constrained")
since = seen.time - seen.time[0]
torque.plot(since, seen.measured, color="0.7", linewidth=3, label="measured")
torque.plot(since, seen.torque, color="black", linewidth=0.8, label="predicted")
torque.set(ylabel="Torque [Nm]", xlabel="Time [s]")
torque.legend(frameon=False)
late.hist(1e3 * seen.latency, bins=50, color="0.5")
late.set(xlabel="Latency [ms]", ylabel="Samples")
plt.show()
