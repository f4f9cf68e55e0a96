"""Tables of pandas and xarray, and axes of Matplotlib; none is loaded unless it is used."""

import importlib
from collections.abc import Mapping, Sequence
from typing import TYPE_CHECKING, Any

import numpy as np

from surae.base.errors import InputError
from surae.base.records import to_plain
from surae.base.units import FloatArray, kind

if TYPE_CHECKING:
    from matplotlib.axes import Axes


def frame(rows: Sequence[Mapping[str, Any]], units: Mapping[str, str]) -> Any:
    """Rows as a pandas DataFrame, the units of its columns in ``attrs["units"]``."""
    table = library("pandas", "a DataFrame").DataFrame(list(rows))
    table.attrs["units"] = dict(units)
    return table


def records_frame(records: Mapping[str, Any], name: str) -> Any:
    """Records of one kind, a row each by name, as a pandas DataFrame.

    The ends of an interval are columns ``_low`` and ``_high``, what a table in a record has is
    named after both; lists are left out.
    """
    plain = [to_plain(record) for record in records.values()]
    # What is an interval or a table in one record may be None in another.
    parted = {
        key for each in plain for key, entry in each.items() if isinstance(entry, list | dict)
    }
    rows = [_flat(each) for each in plain]
    shown = [
        column for column in dict.fromkeys(c for row in rows for c in row) if column not in parted
    ]
    pandas = library("pandas", "a DataFrame")
    table = pandas.DataFrame([[row.get(c) for c in shown] for row in rows], list(records), shown)
    return table.rename_axis(name)


def _flat(plain: Mapping[str, Any]) -> dict[str, Any]:
    """The numbers and words of one record."""
    row: dict[str, Any] = {}
    for key, entry in plain.items():
        if isinstance(entry, dict):
            row.update({f"{key}_{inner}": value for inner, value in _flat(entry).items()})
        elif isinstance(entry, list) and len(entry) == 2:
            row[f"{key}_low"], row[f"{key}_high"] = entry
        elif not isinstance(entry, list):
            row[key] = entry
    return row


def channels_frame(channels: Mapping[str, Any], about: Mapping[str, str]) -> Any:
    """Channels by role as a DataFrame with the columns of our CSV; see `Recording.to_dataframe`."""
    times = [channel.time for channel in channels.values()]
    alike = all(np.array_equal(time, times[0]) for time in times)
    every = times[0] if alike else np.unique(np.concatenate(times))
    names = {role: f"{role}_{c.unit.replace('/', '_')}" for role, c in channels.items()}
    columns = {"time_s": every}
    for role, name in names.items():
        columns[name] = np.full(len(every), np.nan)
        columns[name][np.searchsorted(every, channels[role].time)] = channels[role].values
    table = library("pandas", "a DataFrame").DataFrame(columns)
    units = {name: channels[role].unit for role, name in names.items()}
    table.attrs = {
        **about,
        **({} if alike else {"times": "own"}),
        "units": {"time_s": "s", **units},
    }
    return table


def library(name: str, purpose: str, extra: str = "notebook") -> Any:
    """A library of an extra, loaded only where it is used."""
    try:
        return importlib.import_module(name)
    except ImportError:
        raise InputError(
            f"{purpose} needs {name}: install it with `pip install 'surae[{extra}]'`"
        ) from None


#: What readers look at: factor and unit.
_SHOWN = {"rad": (180.0 / np.pi, "°"), "V": (1e3, "mV"), "m": (1e3, "mm")}


#: Part of the samples that a channel's height is made for: spikes may reach its neighbours.
_HEIGHT = 99.5


def _stacked(
    panel: "Axes",
    names: Sequence[str],
    signals: Sequence[tuple[FloatArray, FloatArray]],
    unit: str,
) -> None:
    """Channels one below the other on one scale, named at their zeros, with a bar of that scale."""
    height = max(float(np.percentile(np.abs(values), _HEIGHT)) for _, values in signals) or 1.0
    apart = 2.0 * height if any(values.min() < 0.0 for _, values in signals) else 1.1 * height
    zeros = [-apart * k for k in range(len(signals))]
    for name, zero, (time, values) in zip(names, zeros, signals, strict=True):
        panel.plot(time, zero + values, linewidth=0.6, label=name)
    panel.set_yticks(zeros, names)
    panel.set_ylim(zeros[-1] - 0.6 * apart, 0.9 * apart)
    bar = 10.0 ** np.floor(np.log10(height))
    bar *= max(step for step in (1.0, 2.0, 5.0) if step * bar <= height)
    end = float(max(time[-1] for time, _ in signals))
    panel.plot([end, end], [zeros[-1], zeros[-1] + bar], color="black", linewidth=2.5)
    panel.annotate(
        f"{bar:g} {unit}",
        (end, zeros[-1] + 0.5 * bar),
        xytext=(4, 0),
        textcoords="offset points",
        va="center",
        fontsize=8,
    )
    panel.set_ylabel(f"emg [{unit}]")


def plotted(name: str, channels: "Mapping[str, Any]") -> "Sequence[Axes]":
    """Draw every kind of signal in a panel of its own; derivatives of the angle are left out."""
    from matplotlib import pyplot

    panels: dict[str, list[str]] = {}
    for role in channels:
        if not role.startswith("angular_"):
            panels.setdefault(kind(role), []).append(role)
    figure, axes = pyplot.subplots(
        len(panels),
        1,
        sharex=True,
        squeeze=False,
        figsize=(8.4, 1.0 + 1.9 * len(panels)),
        layout="constrained",
    )
    figure.suptitle(name, fontsize=10)
    for panel, (what, roles) in zip(axes[:, 0], panels.items(), strict=True):
        of_these = [channels[role] for role in roles]
        unit = of_these[0].unit
        factor, unit = _SHOWN.get(unit, (1.0, unit.replace("1", "-")))
        names = [role.replace("_", " ") for role in roles]
        if what == "emg" and len(roles) > 1:
            _stacked(panel, names, [(c.time, factor * c.values) for c in of_these], unit)
            continue
        for name_, channel in zip(names, of_these, strict=True):
            panel.plot(channel.time, factor * channel.values, linewidth=0.8, label=name_)
        panel.set_ylabel(f"{what} [{unit}]")
        if len(roles) > 1:
            panel.legend(fontsize=8, frameon=False)
    axes[-1, 0].set_xlabel("Time [s]")
    return list(axes[:, 0])
