"""A recording's signals against time, for whoever looks at them in a notebook."""

from typing import TYPE_CHECKING, Any

import numpy as np

from surae.units import kind

if TYPE_CHECKING:
    from collections.abc import Mapping, Sequence

    from matplotlib.axes import Axes

#: What readers look at: factor and unit.
_SHOWN = {"rad": (180.0 / np.pi, "°"), "V": (1e3, "mV"), "m": (1e3, "mm")}


def plotted(name: str, channels: "Mapping[str, Any]") -> "Sequence[Axes]":
    """Draw every kind of signal in a panel of its own; derivatives of the angle are left out."""
    from matplotlib import pyplot

    panels: dict[str, list[str]] = {}
    for role in channels:
        if not role.startswith("angular_"):
            panels.setdefault(kind(role), []).append(role)
    figure, axes = pyplot.subplots(
        len(panels), 1, sharex=True, squeeze=False, figsize=(8.4, 1.0 + 1.9 * len(panels)),
        layout="constrained",
    )  # fmt: skip
    figure.suptitle(name, fontsize=10)
    for panel, (what, roles) in zip(axes[:, 0], panels.items(), strict=True):
        for role in roles:
            channel = channels[role]
            factor, unit = _SHOWN.get(channel.unit, (1.0, channel.unit.replace("1", "-")))
            label = role.replace("_", " ")
            panel.plot(channel.time, factor * channel.values, linewidth=0.8, label=label)
        panel.set_ylabel(f"{what} [{unit}]")
        if len(roles) > 1:
            panel.legend(fontsize=8, frameon=False)
    axes[-1, 0].set_xlabel("Time [s]")
    return list(axes[:, 0])
