"""Parameters from a file: a FIT.json, or a table of names and values."""

from collections.abc import Mapping
from dataclasses import dataclass, field
from typing import Any

from surae.errors import InputError
from surae.files import PathLike, shown
from surae.frozen import FrozenDict
from surae.records import check_format, from_plain, read_json


@dataclass(frozen=True, slots=True)
class GivenParameters:
    """Parameters from a file, and what else a FIT.json says of them."""

    values: Mapping[str, float]  #: By name.
    model: str | None  #: The model they belong to; None where the file does not say.
    options: Mapping[str, Any]  #: The model's options.
    emg_unit: str | None  #: Unit of the EMG that the weights go with.


@dataclass(frozen=True, slots=True)
class _Value:
    value: float


@dataclass(frozen=True, slots=True)
class _Trace:
    emg_unit: str


@dataclass(frozen=True, slots=True)
class _Given:
    parameters: Mapping[str, _Value | float]
    nuisances: Mapping[str, _Value | float] = field(default_factory=FrozenDict)
    model: str | None = None
    options: Mapping[str, Any] = field(default_factory=FrozenDict)
    traces: tuple[_Trace, ...] = ()


def read_parameters(path: PathLike) -> GivenParameters:
    """Parameter values from a FIT.json or from ``{"parameters": {"m": 2.0, …}}``.

    Raises
    ------
    InputError
        The file is missing, not JSON, or has no table of numbers under ``parameters``.
    """
    data = read_json(path)
    check_format(data, path)
    where = shown(path)
    table = data.get("parameters")
    if not isinstance(table, dict) or not table:
        raise InputError(
            f'{where}: no parameters; write {{"parameters": {{"m": 2.0, …}}}} or give a FIT.json'
        )
    try:
        given = from_plain(_Given, data)
    except InputError as error:
        raise InputError(f"{where}: {error}") from None
    values = {
        name: entry.value if isinstance(entry, _Value) else entry
        for name, entry in {**given.parameters, **given.nuisances}.items()
    }
    units = {trace.emg_unit for trace in given.traces}
    unit = units.pop() if len(units) == 1 else None
    return GivenParameters(values, given.model, given.options, unit)
