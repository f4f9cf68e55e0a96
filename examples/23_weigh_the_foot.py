"""
What if the mass ends at its bound?
===================================

The mass of foot and plate is told by inertia and weight alone. Where the torque's zero is off, the
mass is wrong, and may end at its bound, as that of most of the thesis's subjects did. Weigh the
plate, take the foot from the body's mass, and fix it: ``--fixed m=2.1``. Or estimate the zero.
"""

from dataclasses import replace

import surae
from surae.protocol import Protocol, generate
from surae.studies import virtual_subject, virtual_trial

subject = virtual_subject(seed=4)
motion = generate(Protocol(profile="multiple-holds", chirp_amplitude=0.1, rate_hz=125.0))
trial = virtual_trial(subject, motion)
off = replace(trial, torque=trial.torque + 1.5)  # the sensor was not set to zero

true = subject.parameters["m"]
ways = {
    "estimated": {},
    "fixed": {"fixed": {"m": true}},
    "estimated, and the zero": {"free": ["torque_zero"]},
}
for what, given in ways.items():
    fit = surae.fit(off, "muscle", starts=2, seed=1, **given)
    m = fit.parameters["m"]
    zero = f", zero {fit.parameters['torque_zero'].value:.2f} Nm" if "free" in given else ""
    print(f"mass {what:24} {m.value:.2f} kg ({m.verdict}; {true:.2f} in truth){zero}")
