"""The one numba decorator of surae, with an on-disk cache that cannot go stale."""

from collections.abc import Callable
from concurrent.futures import ThreadPoolExecutor
from contextlib import closing, suppress
from functools import cache
from importlib import import_module
from pathlib import Path
from typing import Any, TypeVar, cast

from surae.base.working_folder import ignoring
from surae.model.kernel_cache import VerifiedFile, cache_folder, say_unsaved

with ignoring(".numba_config.yaml"):
    import numba
vars(numba.config)["_config_fname"] = ""  # looked for again at every compilation

F = TypeVar("F", bound=Callable[..., Any])


@cache
def compile_all() -> None:
    """Compile what a fit needs, half of it in a child at the same time, once for a cache folder."""
    folder = cache_folder()
    if folder is None:
        say_unsaved(None, "")  # a child's work would be lost
        return
    done = folder / "all"
    if done.exists():
        return
    from surae.processes import Child

    with ThreadPoolExecutor(1) as pool, closing(Child(calls=1)) as child:
        other = pool.submit(child.call, f"{__name__}:compile_half", {"half": 1})
        compile_half(0)
        other.exception()  # what a child that failed left is compiled where it is needed
    try:
        done.touch()
    except OSError as error:
        say_unsaved(folder, str(error.strerror).lower())


def compile_half(half: int) -> None:
    """Compile, or load, kernels that Python calls in a fit: one half of `kernels.txt`.

    It names what each takes: real numbers and integers, in arrays of so many dimensions, and tuples
    of such.
    """
    text = Path(__file__).with_name("kernels.txt").read_text(encoding="utf-8")
    for line in text.split("\n\n")[half].splitlines():
        name, *given = line.split()
        module, kernel = name.split(":")
        types = tuple(map(_type_of, given))
        getattr(import_module(f"surae.{module}"), kernel).compile(types)


def _type_of(word: str) -> Any:
    """Numba's type by its word: f or i, then dimensions; in parentheses a tuple of them."""
    types: Any = numba.types
    if word.startswith("("):
        return types.Tuple(tuple(map(_type_of, word[1:-1].split(","))))
    kind = {"f": numba.float64, "i": numba.int64}[word[0]]
    return types.Array(kind, int(word[1:]), "C") if word[1:] else kind


def inner(function: F) -> F:
    """As `jit`, of what kernels alone call: not to be called by Python spares its wrapper."""
    return jit(function, no_cpython_wrapper=True)


def jit(function: F, **more: Any) -> F:
    """Compile `function` with numba: no GIL, IEEE arithmetic but for `more`, cached on disk."""
    # Nobody calls them by address: to allow for that is a tenth of their compilation.
    options: Any = {"nogil": True, "error_model": "numpy", "no_cfunc_wrapper": True, **more}
    folder = cache_folder()
    if folder is None:
        return cast(F, numba.njit(**options)(function))
    config: Any = numba.config
    previous = config.CACHE_DIR
    config.CACHE_DIR = str(folder)  # numba reads it when it decorates
    try:
        compiled: Any = numba.njit(cache=True, **options)(function)
        with suppress(AttributeError):  # a later numba's own file serves too
            compiled._cache._cache_file.__class__ = VerifiedFile
    finally:
        config.CACHE_DIR = previous
    return cast(F, compiled)
