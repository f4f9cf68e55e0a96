"""What takes long, kept as it comes: one function over many settings, and studies.

A stopped run goes on where it was; what is kept was made by the same program.
"""

import hashlib
import inspect
from collections.abc import Callable, Mapping
from pathlib import Path
from types import ModuleType
from typing import Any

from surae.studies import fingerprint, study_rows
from surae_thesis.section import Context

#: Plain data that JSON holds without loss: numbers finite, keys texts.
Plain = Any
#: A row of a study's table, by column.
Row = dict[str, Any]


def rows_of(context: Context, name: str, text: str) -> list[Row]:
    """The table of a study: a row for each combination, in the order of the plan.

    Parameters
    ----------
    context : Context
        Of the section.
    name : str
        Of the study and its store, unique over all sections.
    text : str
        The rest of its STUDY.toml.

    Raises
    ------
    InputError, ComputationError
        As of `surae.studies.study_rows`.
    """
    return study_rows(
        f'name = "{name}"\n{text}',
        context.store(f"{name}.db"),
        workers=context.workers,
        progress=lambda done, total: context.progress(name, done, total),
    )


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
        Modules of this package, beside the function's own, that its results depend on: a change
        in them, or in what fits and simulates, computes again.

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

    digest = hashlib.sha256(f"{fingerprint()} {function.__qualname__}".encode())
    for module in (inspect.getmodule(function), *also):
        if module is not None and module.__file__:
            digest.update(Path(module.__file__).read_bytes())
    return kept_calls(
        context.store(f"{name}.db"),
        function,
        jobs,
        program=digest.hexdigest(),
        workers=context.workers,
        progress=lambda done, total: context.progress(name, done, total),
    )
