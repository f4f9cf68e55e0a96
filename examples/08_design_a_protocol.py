"""
Which movement makes the parameters identifiable?
=================================================

The standard errors that a protocol promises follow from the model's derivatives along it, before
anything is measured.
"""

import numpy as np

import surae
from surae.protocol import PROFILES, Protocol, generate
from surae.protocol.triceps import triceps_path
from surae.studies import virtual_subject, virtual_trial

subject = virtual_subject(seed=1)
names = list(subject.parameters)
print(f"{'profile':18} {'visited':>8} {'k_tri':>8} {'tau_rel':>8} {'l0_tri':>8}   SEM / value")
for profile in PROFILES:
    trajectory = generate(Protocol(profile=profile, chirp_amplitude=0.1, rate_hz=125.0))
    trial = virtual_trial(subject, trajectory, noise=0.0)
    torque, jacobian = surae.simulate("muscle", subject.parameters, trial, jacobian=True)
    noise = 0.05 * np.abs(torque).mean()
    values = np.array([subject.parameters[name] for name in names])
    relative = noise * np.sqrt(np.diag(np.linalg.pinv((jacobian * values).T @ (jacobian * values))))
    promised = dict(zip(names, relative, strict=True))
    share = triceps_path(trajectory).coverage.share
    shown = " ".join(f"{100 * promised[n]:7.2f}%" for n in ("k_tri", "tau_rel", "l0_tri"))
    print(f"{profile:18} {100 * share:7.1f}% {shown}")
