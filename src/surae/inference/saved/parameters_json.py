"""Parameters from a file: a FIT.json, or a table of names and values."""

from collections.abc import Mapping
from dataclasses import dataclass, field
from typing import Any

from surae.base.errors import InputError
from surae.base.files import PathLike, shown
from surae.base.frozen import FrozenDict
from surae.base.records import check_format, from_file, read_json


@dataclass(frozen=True, slots=True)
class _Value:
    value: float


@dataclass(frozen=True, slots=True)
class _Trace:
    emg_unit: str


@dataclass(frozen=True, slots=True)
class GivenParameters:
    """Parameters from a file, and what else a FIT.json says of them."""

    #: `parameters`, `nuisances`: by name.
    parameters: Mapping[str, _Value | float]
    nuisances: Mapping[str, _Value | float] = field(default_factory=FrozenDict)
    model: str | None = None  #: The model they belong to; None where the file does not say.
    options: Mapping[str, Any] = field(default_factory=FrozenDict)  #: The model's options.
    traces: tuple[_Trace, ...] = ()

    @property
    def values(self) -> dict[str, float]:
        """The numbers, by name."""
        every = {**self.parameters, **self.nuisances}
        return {
            n: entry.value if isinstance(entry, _Value) else entry for n, entry in every.items()
        }

    @property
    def emg_unit(self) -> str | None:
        """Unit of the EMG that the weights go with; None where the file does not say."""
        units = {trace.emg_unit for trace in self.traces}
        return units.pop() if len(units) == 1 else None


def read_parameters(path: PathLike) -> GivenParameters:
    """Parameter values from a FIT.json or from ``{"parameters": {"m": 2.0, …}}``.

    Raises
    ------
    InputError
        The file is missing, not JSON, or has no table of numbers under ``parameters``.
    """
    data = read_json(path)
    check_format(data, path)
    table = data.get("parameters")
    if not isinstance(table, dict) or not table:
        raise InputError(
            f'{shown(path)}: no parameters; write {{"parameters": {{"m": 2.0, …}}}} or give a '
            "FIT.json"
        )
    return from_file(GivenParameters, path, data)
