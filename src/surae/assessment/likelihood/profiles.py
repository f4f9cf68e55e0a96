"""Profiles of several parameters of one fit, side by side, and as a file."""

import threading
import time
from collections.abc import Callable, Iterable, Mapping, Sequence
from contextlib import nullcontext
from dataclasses import dataclass
from typing import Any

from surae.assessment.inflation import described
from surae.assessment.likelihood.profile import Profile, check_profiled, prior_noise, profile
from surae.errors import InputError
from surae.estimation import FitResult
from surae.estimation.interrupt import postponed_interrupt
from surae.files import PathLike, write_json
from surae.threads import one_blas_thread
from surae.versions import versions

#: Called after every profile with its parameter, how many are done, and how many there are.
Told = Callable[[str, int, int], None]


@dataclass(frozen=True, slots=True)
class Profiles:
    """Profiles of one fit.

    Attributes
    ----------
    model : str
        Name of the model.
    profiles : mapping of str to Profile
        By parameter, in the order asked for.
    missing : tuple of str
        Parameters whose profile the user stopped.
    inflation_reason : str
        Why the variance of the noise was multiplied by each profile's `variance_inflation`.
    seconds : float
        Wall time.
    versions : mapping of str to str
        Versions of surae and of what its numbers depend on.
    """

    model: str
    profiles: Mapping[str, Profile]
    missing: tuple[str, ...]
    inflation_reason: str
    seconds: float
    versions: Mapping[str, str]

    def __getitem__(self, name: str) -> Profile:
        return self.profiles[name]

    @property
    def noise(self) -> str:
        """What the noise was taken for, in a line; empty without a profile."""
        factors = {name: one.variance_inflation for name, one in self.profiles.items()}
        return described(factors, self.inflation_reason) if factors else ""

    def as_dict(self) -> dict[str, Any]:
        """The profiles as plain data, as they are saved."""
        return {
            "surae": self.versions["surae"],
            "model": self.model,
            "profiles": {name: _plain(one) for name, one in self.profiles.items()},
            "missing": list(self.missing),
            "variance_inflation_reason": self.inflation_reason,
            "seconds": self.seconds,
            "versions": dict(self.versions),
        }

    def save(self, path: PathLike) -> None:
        """Write the profiles as JSON, all of it or nothing.

        Raises
        ------
        InputError
            The file cannot be written.
        """
        write_json(path, self.as_dict())


def profiles(
    result: FitResult,
    names: Sequence[str] | None = None,
    *,
    variance_inflation: float | Mapping[str, float] = 1.0,
    inflation_reason: str = "",
    workers: int | None = None,
    progress: Told | None = None,
) -> Profiles:
    """Profile several parameters of a fit, each in a thread of its own.

    Parameters
    ----------
    result : FitResult
        The fit.
    variance_inflation : float or mapping of str to float
        Divides Δχ², see `profile`; by parameter, 1 for those left out, or the same for all.
    inflation_reason : str
        Why, for the reader.
    names, workers, progress
        As of `surae.profile`, and so are what is returned and the errors.
    """
    from joblib import Parallel, cpu_count, delayed

    wanted = tuple(result.problem.free if names is None else names)
    inflation = dict.fromkeys(wanted, 1.0)
    if isinstance(variance_inflation, Mapping):
        inflation |= variance_inflation
    else:
        inflation = dict.fromkeys(wanted, variance_inflation)
    for name, factor in inflation.items():
        check_profiled(result, name, factor)
    for name in wanted:
        if wanted.count(name) > 1:
            raise InputError(f"{name} is given twice; give it once")
    if not wanted:
        raise InputError(f"nothing to profile; choose from: {', '.join(result.problem.free)}")
    if workers is not None and workers < 1:
        raise InputError(f"workers is {workers}; give at least 1")
    threads = min(workers or cpu_count(), len(wanted))
    begin, stop = time.perf_counter(), threading.Event()
    found: dict[str, Profile] = {}

    def one(name: str, noise: float) -> Profile | None:
        try:
            return profile(
                result,
                name,
                variance_inflation=inflation[name],
                noise=noise,
                stopped=stop.is_set,
            )
        except KeyboardInterrupt:
            stop.set()
            return None

    # A single worker is the main thread, where Ctrl-C must not come within compiled code; several
    # are not, and the main thread, which only waits, tells them to stop.
    patience = postponed_interrupt() if threads == 1 else nullcontext()
    outputs: Iterable[Profile | None] = ()
    with one_blas_thread(), patience:
        try:
            noise = prior_noise(result.problem)
            pool = Parallel(n_jobs=threads, backend="threading", return_as="generator_unordered")
            outputs = pool(delayed(one)(name, noise) for name in wanted)
            for done in outputs:
                if done is not None:
                    found[done.name] = done
                    if progress is not None:
                        progress(done.name, len(found), len(wanted))
        except KeyboardInterrupt:
            stop.set()
            for done in outputs:  # what is under way ends at its next evaluation
                if done is not None:
                    found[done.name] = done
    return Profiles(
        model=result.problem.spec.name,
        profiles={name: found[name] for name in wanted if name in found},
        missing=tuple(name for name in wanted if name not in found),
        inflation_reason=inflation_reason,
        seconds=time.perf_counter() - begin,
        versions=versions(),
    )


def _plain(one: Profile) -> dict[str, Any]:
    return {
        "unit": one.unit,
        "value": one.value,
        "sem": one.sem,
        "variance_inflation": one.variance_inflation,
        "threshold": one.threshold,
        "interval": list(one.interval),
        "open": list(one.reasons),
        "from_covariance": None if one.from_covariance is None else list(one.from_covariance),
        "status": one.status,
        "message": one.message,
        "lower_minimum": None if one.lower is None else dict(one.lower),
        "grid": one.values.tolist(),
        "sse": one.sse.tolist(),
        "delta_chi2": one.chi2.tolist(),
        "others": dict(zip(one.others, one.path.T.tolist(), strict=True)),
        "evaluations": one.evaluations,
    }
