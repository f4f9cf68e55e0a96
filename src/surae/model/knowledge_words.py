"""What is known of leg and device before a fit, as readers read it."""

import math

from surae.base.names import GEOMETRY_OF
from surae.model.knowledge import MASS_SPREAD, Knowledge, Plate


def lines_of(known: Knowledge) -> tuple[tuple[str, str, str], ...]:
    """What was known, how well, and where it is from."""
    rows = [made.line for made in known.statements.values()]
    if known.plate is not None:
        rows.append(("empty device", _words_of(known.plate), known.plate.file or "stated"))
    if known.geometry:
        whose = "this person’s" if known.geometry_of == GEOMETRY_OF[1] else "a generic one"
        rows.append(("lengths and moment arms", whose, known.geometry))
    if known.size:
        how = f"{known.size:.3g} times the assumed, ± {known.size_sd:.2g} %"
        by = "height and foot" if known.foot_mm or known.height_cm else "age"
        rows.append(("moment arms", how, by))
    if known.mass is not None:
        text = f"{known.mass[0]:.2g} kg, ± {100 * MASS_SPREAD:.0f} %"
        rows.append(("mass of foot and plate", text, "body mass"))
    if known.crosstalk:
        largest = max(known.crosstalk.values(), key=lambda stated: stated.value)
        sds = sorted(stated.sd for stated in known.crosstalk.values())
        text = f"at most {100 * largest.value:.0f} % of another muscle’s EMG, ± "
        rows.append(("crosstalk", f"{text}{100 * sds[len(sds) // 2]:.1f} %", known.crosstalk_of))
    return tuple(rows)


def summary_of(known: Knowledge) -> str:
    """What it is among other settings."""
    return "; ".join(f"{what} {how}" for what, how, _ in lines_of(known)) or "nothing"


def _words_of(plate: Plate) -> str:
    """What the empty device is, or that it was taken away."""
    if not plate.file:
        return "taken away before (tared)"
    (i, c, s, d, f, _), (sd_i, _, _, sd_d, sd_f, _) = plate.values, plate.sds
    return (
        f"inertia {1e3 * i:.1f} ± {1e3 * sd_i:.1f} g·m², "
        f"weight up to {math.hypot(c, s):.2g} Nm, damping {d:.2g} ± {sd_d:.1g} Nm·s/rad, "
        f"friction {f:.2g} ± {sd_f:.1g} Nm; taken away"
    )
