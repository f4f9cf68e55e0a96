"""Parameters from a file: a FIT.json, or a table of names and values."""

import json
from collections.abc import Mapping
from dataclasses import dataclass
from typing import Any

from surae.assessment.saved.json_file import check_format, read_json
from surae.errors import InputError
from surae.files import PathLike, shown


@dataclass(frozen=True, slots=True)
class GivenParameters:
    """Parameters from a file, and what else a FIT.json says of them."""

    values: Mapping[str, float]  #: By name.
    model: str | None  #: The model they belong to; None where the file does not say.
    options: Mapping[str, Any]  #: The model's options.
    emg_unit: str | None  #: Unit of the EMG that the weights go with.


def read_parameters(path: PathLike) -> GivenParameters:
    """Parameter values from a FIT.json or from ``{"parameters": {"m": 2.0, …}}``.

    Raises
    ------
    InputError
        The file is missing, not JSON, or has no table of numbers under ``parameters``.
    """
    data = read_json(path)
    check_format(data, path)
    table, nuisances = data.get("parameters"), data.get("nuisances")
    if isinstance(table, dict) and isinstance(nuisances, dict):
        table = table | nuisances
    if not isinstance(table, dict) or not table:
        raise InputError(
            f'{shown(path)}: no parameters; write {{"parameters": {{"m": 2.0, …}}}} or give a '
            "FIT.json"
        )
    values = {}
    for name, entry in table.items():
        value = entry.get("value") if isinstance(entry, dict) else entry
        if isinstance(value, bool) or not isinstance(value, int | float):
            text = json.dumps(entry, ensure_ascii=False)
            raise InputError(f"{shown(path)}: parameter {name!r} is {text}; give a number")
        try:
            values[name] = float(value)
        except OverflowError:
            raise InputError(f"{shown(path)}: parameter {name!r} is too large a number") from None
    model, options, traces = data.get("model"), data.get("options", {}), data.get("traces")
    if not (isinstance(model, str | None) and isinstance(options, dict)):
        raise InputError(f"{shown(path)}: model must be a name, and options a table")
    units = {t.get("emg_unit") for t in traces if isinstance(t, dict)} if traces else set()
    return GivenParameters(values, model, options, units.pop() if len(units) == 1 else None)
