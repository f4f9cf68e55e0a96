"""
How much of this stiffness is nerve?
====================================

A simulated ankle, moved by about 2° at random for a minute: tissue resists at once, a reflex 40 ms
later. Which part of the torque is the reflex's is found from angle and torque alone.
"""

import numpy as np
import pandas as pd
from scipy.signal import butter, sosfilt

import surae

rate = 200.0
draw = np.random.default_rng(3)
time = np.arange(0.0, 60.0, 1.0 / rate)
random = draw.choice((-1.0, 1.0), len(time) // 30 + 1).repeat(30)[: len(time)]
angle = 0.02 * sosfilt(butter(2, 8.0, fs=rate, output="sos"), random)
speed = np.gradient(angle, time)
tissue = 40.0 * angle + 0.4 * speed + 0.02 * np.gradient(speed, time)
late = np.interp(time - 0.04, time, np.maximum(speed, 0.0))
reflex = sosfilt(butter(2, 4.0, fs=rate, output="sos"), 6.0 * late)
torque = tissue + reflex + 0.05 * draw.standard_normal(len(time))

recording = pd.DataFrame({"time_s": time, "angle_rad": angle, "torque_Nm": torque})
found = surae.impedance(recording)
print(found)
print(f"the reflex: {found.reflex.verdict}")
