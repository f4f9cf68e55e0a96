"""Work of a section that is no study: one function over many settings, kept as it comes."""

import hashlib
import inspect
import json
import os
from collections.abc import Callable, Iterator, Mapping
from contextlib import closing
from pathlib import Path
from types import ModuleType
from typing import Any

from surae.errors import ComputationError, InputError
from surae.files import read_bytes, shown
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
    from surae.runner import Died, Engine, results
    from surae.studies.database import lock

    path = context.store(f"{name}.jsonl")
    program = _program(function, also)
    keys = {label: _key(program, settings) for label, settings in jobs.items()}
    held = lock(path)
    if held is None:
        raise InputError(f"{shown(path)} is in use by another run; wait for it, or stop it")
    try:
        _mend(path)
        found = dict(_kept(path))
        rest = [label for label in jobs if keys[label] not in found]
        context.progress(name, len(jobs) - len(rest), len(jobs))
        workers = min(context.workers, max(len(rest), 1))
        engine = Engine("processes" if workers > 1 else "threads", workers)
        work = f"{function.__module__}:{function.__qualname__}"
        with closing(results(work, {label: jobs[label] for label in rest}, engine)) as batches:
            for label, value in (pair for batch in batches for pair in batch):
                if isinstance(value, Died):
                    raise ComputationError(f"{name}, {label}: {value.message}")
                _keep(path, keys[label], value)
                found[keys[label]] = value
                context.progress(name, len(set(found) & set(keys.values())), len(jobs))
    finally:
        held.close()
    return {label: found[keys[label]] for label in jobs}


def _program(function: Callable[..., Plain], also: tuple[ModuleType, ...]) -> str:
    from surae.studies.program import fingerprint

    digest = hashlib.sha256(f"{fingerprint()} {function.__qualname__}".encode())
    for module in (inspect.getmodule(function), *also):
        if module is not None and module.__file__:
            digest.update(Path(module.__file__).read_bytes())
    return digest.hexdigest()


def _key(program: str, settings: Mapping[str, Plain]) -> str:
    text = json.dumps([program, settings], sort_keys=True, allow_nan=False)
    return hashlib.sha256(text.encode()).hexdigest()


def _kept(path: Path) -> Iterator[tuple[str, Plain]]:
    """What is in the store; a line that a stopped run left unfinished is no result."""
    if not path.exists():
        return
    for line in read_bytes(path).decode(errors="replace").splitlines():
        try:
            key, value = json.loads(line)
        except ValueError:
            continue
        yield key, value


def _mend(path: Path) -> None:
    """End a line that a stopped run left unfinished, so that the next one is a line of its own."""
    if path.exists() and not read_bytes(path).endswith(b"\n"):
        with path.open("ab") as handle:
            handle.write(b"\n")


def _keep(path: Path, key: str, value: Plain) -> None:
    """Put one result on disk before it counts."""
    text = json.dumps([key, value], allow_nan=False, ensure_ascii=True)
    try:
        with path.open("a", encoding="ascii") as handle:
            handle.write(f"{text}\n")
            handle.flush()
            os.fsync(handle.fileno())
    except OSError as error:
        raise InputError(f"cannot write {shown(path)}: {error.strerror}") from None
