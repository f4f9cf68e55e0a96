"""Draw profiles beside the covariance: the foot, and the tendon of the tibialis freed altogether.

The torque is linear in the mass of the foot, and there the two agree. Strain factor and toe
force of a tendon that stays in its toe trade off along a curve, and there they do not.
"""

from pathlib import Path

import surae
from surae.protocol import Protocol, generate
from surae.report.figures import png
from surae.report.figures.intervals import profile_figure
from surae.studies import virtual_subject, virtual_trial

protocol = Protocol(profile="multiple-holds", chirp_amplitude=0.2, chirp_rate=0.159, rate_hz=125.0)
trial = virtual_trial(virtual_subject(seed=1), generate(protocol), model="muscle-tendon")
fit = surae.fit(trial, "muscle-tendon", free=("dlt_tib", "pt_tib"), starts=2)
found = surae.profile(fit, ("m", "dlt_tib", "pt_tib"))
picture = png(profile_figure(tuple(found.profiles.values()), found.noise))
(Path(__file__).parent / "profile.png").write_bytes(picture)
