"""Draw the paper's figure: what is called identified, and how much of that is true.

The counts are read from docs/how-to/when-to-believe-a-number.md, which names the command that made
them: python paper/figures.py
"""

import re
from pathlib import Path

import matplotlib.pyplot as plt
from scipy.stats import binomtest

FOLDER = Path(__file__).parent
PAGE = FOLDER.parent / "docs" / "how-to" / "when-to-believe-a-number.md"
#: A row of the table: whose legs, then "n of m" identified and "n of m" true.
ROW = re.compile(
    r"^\| ([^|]+) \|[^|]+\|[^|]+\((\d+) of (\d+)\) \|[^|]+\((\d+) of (\d+)\)", re.MULTILINE
)


def draw() -> None:
    """Both parts of every row, as dots with intervals."""
    rows = ROW.findall(PAGE.read_text(encoding="utf-8"))
    figure, axes = plt.subplots(figsize=(6.5, 2.4), layout="constrained")
    for place, (_, *counts) in enumerate(reversed(rows)):
        known, of, true, claimed = map(int, counts)
        for n, all_, shift, colour, label in (
            (known, of, -0.12, "#0072b2", "identified"),
            (true, claimed, 0.12, "#d55e00", "of these true"),
        ):
            low, high = binomtest(n, all_).proportion_ci(method="wilson")
            axes.plot([100 * low, 100 * high], 2 * [place + shift], color=colour)
            axes.plot(
                100 * n / all_, place + shift, "o", color=colour, label=label if not place else None
            )
    axes.axvline(95, color="grey", linestyle="--", linewidth=0.8)
    axes.set(xlim=(0, 100), xlabel="%", yticks=range(len(rows)))
    axes.set_yticklabels([row[0] for row in reversed(rows)])
    axes.legend(loc="center", frameon=False)
    figure.savefig(FOLDER / "claims.png", dpi=200, metadata={"Software": None})


if __name__ == "__main__":
    draw()
