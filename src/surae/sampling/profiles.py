"""Profiles of several parameters of one fit, side by side, and as a file."""

import threading
import time
from collections.abc import Callable, Mapping, Sequence
from concurrent.futures import FIRST_COMPLETED, ThreadPoolExecutor, wait
from contextlib import suppress
from dataclasses import dataclass
from typing import Any

from surae.base.errors import InputError, UnknownNameError
from surae.base.file_form import filed
from surae.base.formatting import NO_NUMBER, nearest, significant
from surae.base.records import Saved
from surae.base.tables import Tabular, TextTable
from surae.base.threads import cores, one_blas_thread
from surae.base.versions import versions
from surae.inference import FitResult
from surae.inference.judging.assessed import described
from surae.sampling.conditional import surface_of
from surae.sampling.one_profile import ParameterProfile, check_profiled, profile, profiled

#: Called with a parameter, how many profiles are done, and how many there are.
NamedProgress = Callable[[str, int, int], None]
#: How often to look for Ctrl-C where it does not end a wait [s].
_LOOK = 0.5


def open_ends(interval: Sequence[float | None] | None) -> str:
    """An interval, either end of which may be open; a dash where there is none."""
    if interval is None:
        return NO_NUMBER
    return " … ".join("open" if end is None else significant(end, 4) for end in interval)


@filed(inflation_reason="variance_inflation_reason")
@dataclass(frozen=True, slots=True, repr=False)
class Profiles(Tabular, Saved):
    """Profiles of one fit."""

    model: str  #: Name of the model.
    profiles: Mapping[str, ParameterProfile]  #: By parameter, in the order asked for.
    missing: tuple[str, ...]  #: Parameters whose profile the user stopped.
    #: Why the variance of the noise was multiplied by each profile's `variance_inflation`.
    inflation_reason: str
    seconds: float  #: Wall time.
    versions: Mapping[str, str]  #: Versions of surae and of what its numbers depend on.

    def __getitem__(self, name: str) -> ParameterProfile:
        if name not in self.profiles:
            raise UnknownNameError(f"no profile of {name!r}{nearest(name, self.profiles)}")
        return self.profiles[name]

    def to_dataframe(self) -> Any:
        """The profiles' intervals as a pandas DataFrame.

        Returns
        -------
        pandas.DataFrame
            A row each by parameter: value, unit, ends of every interval (None where open),
            status and message; the curves themselves are in `profiles`.

        Raises
        ------
        InputError
            pandas is not installed.
        """
        from surae.recording.frames import records_frame

        return records_frame(self.profiles, "parameter")

    @property
    def noise(self) -> str:
        """What the noise was taken for, in a line; empty without a profile."""
        factors = {name: profile.variance_inflation for name, profile in self.profiles.items()}
        return described(factors, self.inflation_reason) if factors else ""

    def as_table(self) -> TextTable:
        """Intervals of profile and covariance beside each other, then remarks on them."""
        every = self.profiles.values()
        notes = [f"{p.name}: {p.message}" for p in every if p.message != "both ends found"]
        done = f"{len(every)} profiles in {self.seconds:.1f} s"
        heads = (
            "parameter",
            "value",
            "95 % profile",
            "95 % covariance",
            "with arms and paths",
            "status",
            "unit",
        )
        rows = [
            (
                p.name,
                significant(p.value, 4),
                open_ends(p.interval),
                open_ends(p.from_covariance),
                open_ends(p.with_geometry),
                p.status,
                p.unit,
            )
            for p in every
        ]
        below = (*notes, *filter(None, [self.noise]), done)
        return TextTable(heads, tuple(rows), below=below, numbers=heads[1:5])


def profiles(
    result: FitResult,
    names: Sequence[str] | None = None,
    *,
    variance_inflation: float | Mapping[str, float] = 1.0,
    inflation_reason: str = "",
    workers: int | None = None,
    progress: NamedProgress | None = None,
) -> Profiles:
    """Profile several parameters of a fit, each in a thread of its own.

    `variance_inflation` divides Δχ², see `profile`: by parameter, 1 for those left out, or the same
    for all; `inflation_reason` says why, for the reader. All else is as of `surae.profile`.
    """
    wanted = profiled(result) if names is None else tuple(names)
    if not isinstance(variance_inflation, Mapping):
        variance_inflation = dict.fromkeys(wanted, variance_inflation)
    inflation = {**dict.fromkeys(wanted, 1.0), **variance_inflation}
    for name, factor in inflation.items():
        check_profiled(result, name, factor)
    for name in wanted:
        if wanted.count(name) > 1:
            raise InputError(f"{name} is given twice; give it once")
    if not wanted:
        raise InputError(f"nothing to profile; choose from: {', '.join(profiled(result))}")
    if workers is not None and workers < 1:
        raise InputError(f"workers is {workers}; give at least 1")
    begin = time.perf_counter()
    stop = threading.Event()
    with one_blas_thread():
        over = surface_of(result)

    def made(name: str) -> ParameterProfile:
        factor = inflation[name]
        return profile(result, name, variance_inflation=factor, over=over, stopped=stop.is_set)

    done: dict[str, ParameterProfile] = {}
    with one_blas_thread(), ThreadPoolExecutor(workers or cores()) as pool:
        running = {pool.submit(made, name): name for name in wanted}
        try:
            with suppress(KeyboardInterrupt):
                while running:
                    for future in wait(running, _LOOK, FIRST_COMPLETED).done:
                        name = running.pop(future)
                        done[name] = future.result()
                        if progress is not None:
                            progress(name, len(done), len(wanted))
        finally:
            stop.set()
            pool.shutdown(cancel_futures=True)
    return Profiles(
        model=result.problem.spec.name,
        profiles={name: done[name] for name in wanted if name in done},
        missing=tuple(name for name in wanted if name not in done),
        inflation_reason=inflation_reason,
        seconds=time.perf_counter() - begin,
        versions=versions(),
    )
