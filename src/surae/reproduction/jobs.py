"""Work of a section that is no study: one function over many settings, kept as it comes."""

import hashlib
import inspect
from collections.abc import Callable, Mapping
from pathlib import Path
from types import ModuleType
from typing import Any

from surae.reproduction.chapter import Context

#: Plain data that JSON holds without loss: numbers finite, keys texts.
Plain = Any


def run_jobs(
    context: Context,
    name: str,
    function: Callable[..., Plain],
    jobs: Mapping[str, Mapping[str, Plain]],
    *,
    also: tuple[ModuleType, ...] = (),
) -> dict[str, Plain]:
    """Call a function with each job's settings in parallel; what is kept is not computed again.

    Parameters
    ----------
    context : Context
        Of the section.
    name : str
        Of the store, unique over all sections.
    function : callable
        A pure function of a module, called with a job's settings as keywords; returns plain data.
    jobs : mapping of str to mapping
        Settings, plain data, by the job's label.
    also : tuple of module
        Modules of the reproduction, beside the function's own, that its results depend on: a
        change in them, or in what fits and simulates, computes again.

    Returns
    -------
    dict of str to plain data
        By label, in the order of the jobs.

    Raises
    ------
    InputError
        The store is in use by another run, or cannot be written.
    """
    from surae.runner import kept_calls

    return kept_calls(
        context.store(f"{name}.db"),
        function,
        jobs,
        program=_program(function, also),
        workers=context.workers,
        progress=lambda done, total: context.progress(name, done, total),
    )


def _program(function: Callable[..., Plain], also: tuple[ModuleType, ...]) -> str:
    from surae.studies.program import fingerprint

    digest = hashlib.sha256(f"{fingerprint()} {function.__qualname__}".encode())
    for module in (inspect.getmodule(function), *also):
        if module is not None and module.__file__:
            digest.update(Path(module.__file__).read_bytes())
    return digest.hexdigest()
