"""
What does a second recording add?
=================================

Several recordings are one joint fit with shared parameters. A slow passive trial and a fast active
one determine together what neither does alone.
"""

import matplotlib.pyplot as plt

import surae
from surae.protocol import Protocol, generate
from surae.studies import virtual_subject, virtual_trial

subject = virtual_subject(seed=2)
passive = virtual_trial(
    subject, generate(Protocol(profile="ramp-and-hold", task="passive", rate_hz=125.0)), seed=1
)
active = virtual_trial(
    subject, generate(Protocol(profile="multi-sine", task="active", rate_hz=125.0)), seed=2
)

alone = surae.fit(active, "muscle", starts=2)
joint = surae.fit([passive, active], "muscle", starts=2)


def half_width(fit, name: str) -> str:
    """Half of the 95 % interval, as a part of the value."""
    p = fit.parameters[name]
    return f"± {100 * (p.ci95[1] - p.value) / p.value:5.1f} % {p.verdict:10}"


print(f"{'':8} active alone          with the passive trial")
for name in ("k_tri", "k_tib", "x0_tib", "tau_rel", "k_rel", "l0_tri"):
    print(f"{name:8} {half_width(alone, name)}  {half_width(joint, name)}")

# %%
# Half-widths of the 95 % intervals; what is known to 10 % is identified.
names = ("k_tri", "k_tib", "x0_tib", "tau_rel", "k_rel", "l0_tri")
figure, axes = plt.subplots(figsize=(7, 3.2), layout="constrained")
for shift, (fit, label, colour) in enumerate(
    ((alone, "active alone", "0.7"), (joint, "with the passive trial", "black"))
):
    wide = [100 * (fit[name].ci95[1] - fit[name].value) / fit[name].value for name in names]
    axes.bar([k + 0.4 * shift for k in range(len(names))], wide, 0.38, color=colour, label=label)
axes.axhline(10, color="0.4", linestyle=":")
axes.set_xticks([k + 0.2 for k in range(len(names))], names)
axes.set(ylabel="± 95 % [%]", yscale="log")
axes.legend(frameon=False)
plt.show()
