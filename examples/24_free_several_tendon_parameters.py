"""
Can several tendon parameters be free at once?
==============================================

The thesis left that to others, for fear of local minima. ``--free dlt_tri --free pt_tri`` frees the
strain and the toe force of the triceps; several starts find the best minimum, and the correlation
says whether one recording tells the two apart.
"""

import surae
from surae.protocol import Protocol, generate
from surae.studies import virtual_subject, virtual_trial

subject = virtual_subject(seed=3, tendons=True)
true = {"dlt_tri": 0.04, "pt_tri": 0.3, **subject.parameters, **subject.tendons}
motion = generate(Protocol(profile="multiple-holds", chirp_amplitude=0.2, rate_hz=125.0))
trial = virtual_trial(subject, motion, model="muscle-tendon-strain")

for free in ((), ("dlt_tri",), ("dlt_tri", "pt_tri")):
    fit = surae.fit(trial, "muscle-tendon", free=free, starts=4, seed=1)
    found = ", ".join(
        f"{name} {fit[name].value:.3f} ± {fit[name].ci95[1] - fit[name].value:.3f} "
        f"({true[name]:.3f} in truth)"
        for name in free
    )
    agree = fit.result.solution.starts
    print(f"free: {' '.join(free) or 'none':16} VAF {fit.vaf:.3f} %, {len(agree)} starts; {found}")
print(f"correlation of the two: {fit.correlation.loc['dlt_tri', 'pt_tri']:+.2f}")
