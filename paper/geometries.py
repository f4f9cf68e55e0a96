"""Draw the paper's second figure: equal fits, other muscles, and what a film decides.

A measured trial of the tibialis (Tecchio et al. 2023), fitted along two paths, with its film and
without: python paper/geometries.py TORQUE.mat FASCICLES.csv
"""

import argparse
import tempfile
from pathlib import Path

import matplotlib.pyplot as plt
import numpy as np

import surae
from surae.base.normal import NORMAL

FOLDER = Path(__file__).parent
CHANNELS = {"angle": ("Angle", "deg"), "torque": ("Torque", "Nm"), "emg_ta": ("EMG_TA", "V")}
PATHS = {"thesis": ("#0072b2", "equation (9)"), "virtual-work": ("#d55e00", "virtual work")}


def recording(torque: Path, film: Path | None) -> surae.Recording:
    """The trial, with its film or without."""
    text = 'name = "tibialis"\nemg = "raw"\nfixed = { g2 = 0.0, g3 = 0.0, g4 = 0.0 }\n'
    for role, (column, unit) in CHANNELS.items():
        text += f'[channels.{role}]\nfile = "{torque}"\ncolumn = "{column}"\nunit = "{unit}"\n'
        text += "" if role == "emg_ta" else "sign = -1\n"
    if film is not None:
        text += f'[channels.fascicle_tib]\nfile = "{film}"\n'
        text += 'column = "fascicle_superficial_mm"\nunit = "mm"\n'
    with tempfile.TemporaryDirectory() as folder:
        mapping = Path(folder) / "map.toml"
        mapping.write_text(text, encoding="utf-8")
        return surae.read(mapping)


def believed(fit: surae.Fit) -> tuple[float, float]:
    """The interval of l0_tib were the assumed path the leg's [m]."""
    known = fit.assessment.uncertainty.at_assumed
    return known.interval("l0_tib", NORMAL * known.sd(known.along("l0_tib")))


def draw(torque: Path, film: Path) -> None:
    """Torque, and the optimal length by each fit."""
    figure, (left, right) = plt.subplots(1, 2, figsize=(6.5, 2.6), layout="constrained")
    rows = []
    for path, (colour, words) in PATHS.items():
        for seen in (None, film):
            fit = surae.fit(recording(torque, seen), geometry=path, quality=())
            p = fit["l0_tib"]
            ends = (*p.ci95, *believed(fit))
            print(
                f"{words}, {'with' if seen else 'no'} film: R² {fit.adequacy.r2:.2f} %, l0_tib "
                f"{1e3 * p.value:.1f} mm ({1e3 * ends[0]:.1f}–{1e3 * ends[1]:.1f}; were the path "
                f"the leg's {1e3 * ends[2]:.1f}–{1e3 * ends[3]:.1f})"
            )
            rows.append((colour, f"{words}{', film' if seen else ''}", p.value, ends))
            if seen is None:
                (trial,) = fit.result.problem.inputs
                if path == "thesis":
                    left.plot(trial.time, trial.torque, color="0.75", linewidth=3, label="measured")
                modelled = trial.torque - fit.residual
                label = f"{words}, R² {fit.adequacy.r2:.1f} %"
                left.plot(trial.time, modelled, color=colour, linewidth=0.8, label=label)
    left.set(xlabel="time [s]", ylabel="torque [Nm]")
    left.legend(frameon=False, fontsize=7)
    for place, (colour, _, value, ends) in enumerate(reversed(rows)):
        low, high, *own = 1e3 * np.array(ends)
        right.plot([low, high], [place, place], color=colour, linewidth=1)
        right.plot(own, [place, place], color=colour, linewidth=4, alpha=0.5)
        right.plot(1e3 * value, place, "o", color=colour)
    right.set(xlabel="optimal length of the tibialis [mm]", yticks=range(len(rows)))
    right.set_yticklabels([words for _, words, *_ in reversed(rows)])
    figure.savefig(FOLDER / "geometries.png", dpi=200, metadata={"Software": None})


if __name__ == "__main__":
    parser = argparse.ArgumentParser(description=__doc__)
    parser.add_argument("torque", type=Path)
    parser.add_argument("film", type=Path)
    given = parser.parse_args()
    draw(given.torque.resolve(), given.film.resolve())
