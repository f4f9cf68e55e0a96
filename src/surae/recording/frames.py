"""Tables of pandas and xarray of what surae has; neither is loaded unless it is used."""

import importlib
from collections.abc import Mapping, Sequence
from typing import Any

import numpy as np

from surae.errors import InputError


def frame(rows: Sequence[Mapping[str, Any]], units: Mapping[str, str]) -> Any:
    """Rows as a pandas DataFrame, the units of its columns in ``attrs["units"]``."""
    table = library("pandas", "a DataFrame").DataFrame(list(rows))
    table.attrs["units"] = dict(units)
    return table


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
        **about, **({} if alike else {"times": "own"}), "units": {"time_s": "s", **units},
    }  # fmt: skip
    return table


def channels_dataset(channels: Mapping[str, Any], about: Mapping[str, str]) -> Any:
    """Channels by role as an xarray Dataset, each time axis once; see `Recording.to_xarray`."""
    axes: list[tuple[str, Any]] = []
    variables = {}
    for role, channel in channels.items():
        name = next((n for n, time in axes if np.array_equal(time, channel.time)), None)
        if name is None:
            name = f"time_{len(axes) + 1}" if axes else "time"
            axes.append((name, channel.time))
        variables[role] = (name, channel.values, {"units": channel.unit, "source": channel.source})
    coordinates = {name: (name, time, {"units": "s"}) for name, time in axes}
    return library("xarray", "a Dataset").Dataset(variables, coordinates, dict(about))


def library(name: str, purpose: str) -> Any:
    """A library of the extra ``notebook``, loaded only where it is used."""
    try:
        return importlib.import_module(name)
    except ImportError:
        raise InputError(
            f"{purpose} needs {name}: install it with `pip install 'surae[notebook]'`"
        ) from None
