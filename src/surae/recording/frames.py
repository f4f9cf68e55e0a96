"""Tables of pandas and xarray, and axes of Matplotlib; none is loaded unless it is used."""

import importlib
from collections.abc import Mapping, Sequence
from typing import TYPE_CHECKING, Any

import numpy as np

from surae.base.errors import InputError
from surae.base.records import to_plain
from surae.base.units import kind

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
