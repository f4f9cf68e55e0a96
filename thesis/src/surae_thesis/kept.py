"""Calls of one function with many settings, none of which is computed twice."""

import hashlib
import json
from collections.abc import Callable, Mapping

from surae.base.errors import ComputationError
from surae.base.files import PathLike
from surae.processes import Plain
from surae.processes.ledger import Ledger
from surae.processes.runner import Died, Engine, results


def kept_calls(
    path: PathLike,
    work: Callable[..., Plain],
    calls: Mapping[str, Mapping[str, Plain]],
    *,
    program: str,
    workers: int = 1,
    progress: Callable[[int, int], None] | None = None,
) -> dict[str, Plain]:
    """Call a function with many settings; what a file holds already is not computed again.

    Parameters
    ----------
    path : path
        The file, of this function alone.
    work : callable
        A pure function of a module, called with keywords; what it returns is plain data.
    calls : mapping of str to mapping
        Keywords, plain data, by label.
    program : str
        What beside them the results depend on: where it changes, they are computed again.
    workers : int
        Processes at a time; one call after the other in this process where it is 1.
    progress : callable, optional
        Called with how many are done and how many there are.

    Returns
    -------
    dict of str to plain data
        By label, in the order of the calls.

    Raises
    ------
    InputError
        The file is in use by another run, or cannot be written.
    ComputationError
        A call killed its worker.
    """
    keys = {label: _key(program, keywords) for label, keywords in calls.items()}
    by_key = {key: label for label, key in keys.items()}
    with Ledger(path, write=True) as ledger:
        done = ledger.begin(
            "calls", work.__qualname__, "", ((key, label) for label, key in keys.items())
        )
        rest = {key: calls[label] for key, label in by_key.items() if key not in done}
        count = min(workers, max(len(rest), 1))
        engine = Engine("processes" if count > 1 else "threads", count)
        name = f"{work.__module__}:{work.__qualname__}"
        ledger.keep(results(work if count == 1 else name, rest, engine), progress)
        values = dict(ledger.results())
    for label, value in values.items():
        if isinstance(value, Died):
            raise ComputationError(f"{label}: {value.message}")
    return {label: values[label] for label in calls}


def _key(program: str, keywords: Mapping[str, Plain]) -> str:
    text = json.dumps([program, keywords], sort_keys=True, allow_nan=False)
    return hashlib.sha256(text.encode()).hexdigest()
