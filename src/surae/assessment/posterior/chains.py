"""Chains by the no-U-turn sampler of nutpie (Hoffman and Gelman 2014; Seyboldt 2024); checks."""

import importlib.util
import threading
import time
import warnings
from collections.abc import Callable, Mapping
from contextlib import suppress
from dataclasses import dataclass
from importlib.metadata import version
from typing import Any

import numpy as np

from surae.assessment.posterior.density import Density
from surae.errors import InputError
from surae.frozen import read_only
from surae.progress import Progress
from surae.threads import one_blas_thread
from surae.units import FloatArray

#: How often the chains are looked after [s].
_PERIOD = 0.1
#: Part of the steps that are to be accepted: the torque has kinks, which long steps jump over.
EXACT = 0.9
#: Fewer draws or chains than these are no posterior.
_FEWEST_DRAWS, _FEWEST_CHAINS = 10, 2
#: What the posterior needs beside what surae needs.
_NEEDED = ("nutpie", "arviz_stats")


@dataclass(frozen=True, slots=True)
class Chains:
    """What the sampler drew."""

    draws: FloatArray  #: Points after the tuning, shape (chains, draws, p).
    diverging: int  #: Draws at which the sampler's energy went astray.
    evaluations: int  #: Of the density in the draws kept.
    seconds: float  #: Wall time, tuning included.
    whole: bool  #: False when the user stopped the sampler before its end.
    versions: Mapping[str, str]  #: Versions of the sampler's libraries.


def require_sampler() -> None:
    """Refuse to begin without the libraries of the extra."""
    for name in _NEEDED:
        if importlib.util.find_spec(name) is None:
            raise InputError(
                f"the posterior needs {_package(name)}, which is not installed: "
                'pip install "surae[bayes]"'
            )


def _package(name: str) -> str:
    return name.replace("_", "-")


def run_chains(
    make_density: Callable[[], Density],
    dimension: int,
    *,
    draws: int,
    tune: int,
    chains: int,
    seed: int,
    cores: int | None = None,
    progress: Progress | None = None,
    accepted: float = EXACT,
) -> Chains:
    """Draw from a density that is nearly a standard Gaussian.

    `make_density` gives a density of its own to every thread; each chain tunes and then draws, from
    a point drawn from the Gaussian; `cores` chains run at a time, by default one for each
    processor. The same seed gives the same draws on any number of cores. Ctrl-C keeps what is
    drawn, when at least two chains have draws to keep.
    """
    require_sampler()
    _check(draws=draws, tune=tune, chains=chains, seed=seed, cores=cores)
    with warnings.catch_warnings():  # nutpie's dependency announces its next version
        warnings.simplefilter("ignore", FutureWarning)
        import nutpie
        from nutpie.compiled_pyfunc import from_pyfunc

    begin = time.perf_counter()
    work = _Work(make_density, dimension)
    model = from_pyfunc(
        dimension,
        work.make_density,
        work.make_keeper,
        [np.dtype(np.float64)],
        [(dimension,)],
        ["z"],
        make_initial_point_fn=work.initial,
    )
    with one_blas_thread():
        sampler = nutpie.sample(
            model,
            draws=draws,
            tune=tune,
            chains=chains,
            cores=cores,
            seed=seed,
            target_accept=accepted,
            save_warmup=False,
            progress_bar=False,
            blocking=False,
        )
        trace, whole = _attend(sampler, work, progress, chains * (draws + tune))
    complete = _kept(trace, whole=whole)
    statistics = trace.sample_stats
    part = np.s_[complete[0], : complete[1]]
    return Chains(
        draws=read_only(trace.posterior["z"].values[part]),
        diverging=int(statistics["diverging"].values[part].sum()),
        evaluations=int(statistics["n_steps"].values[part].sum()),
        seconds=time.perf_counter() - begin,
        whole=whole,
        versions={name: version(_package(name)) for name in _NEEDED},
    )


class _Work:
    """What nutpie calls, from its own threads: nothing here may raise."""

    def __init__(self, make_density: Callable[[], Density], dimension: int) -> None:
        self._make, self._dimension = make_density, dimension
        self._lock = threading.Lock()
        self.done = 0
        self.error: BaseException | None = None

    def make_density(self) -> Density:
        """A density for one thread, which gives no finite number once something has failed."""
        try:
            density = self._make()
        except BaseException as error:
            self.error = error

        def guarded(z: FloatArray) -> tuple[float, FloatArray]:
            if self.error is None:
                try:
                    return density(z)
                except BaseException as error:
                    self.error = error
            return -np.inf, np.zeros(self._dimension)

        return guarded

    def make_keeper(
        self, seed1: int, seed2: int, chain: int
    ) -> Callable[[FloatArray], Mapping[str, FloatArray]]:
        """What is kept of a point: the point; counts them."""
        del seed1, seed2, chain

        def keep(z: FloatArray) -> Mapping[str, FloatArray]:
            with self._lock:
                self.done += 1
            return {"z": np.array(z)}

        return keep

    def initial(self, seed: int) -> FloatArray:
        """A point from the Gaussian, drawn closer to the mode where the density is not finite."""
        z = np.random.default_rng(seed).standard_normal(self._dimension)
        density = self.make_density()
        for _ in range(10):
            if np.isfinite(density(z)[0]):
                break
            z /= 2
        return z


def _attend(sampler: Any, work: _Work, progress: Progress | None, total: int) -> tuple[Any, bool]:
    """Wait for the sampler; its trace, and whether it came to its end."""
    trace = None
    try:
        while True:
            try:
                trace = sampler.wait(timeout=_PERIOD)
            except TimeoutError:
                trace = None
            except RuntimeError:
                # Nothing is finite once a density has failed, and the sampler may see that first.
                if work.error is None:
                    raise
            if work.error is not None:
                raise work.error from None
            if trace is not None:
                return trace, True
            if progress is not None:
                progress(min(work.done, total), total)
    except KeyboardInterrupt:
        with warnings.catch_warnings():  # of chains that have not begun
            warnings.simplefilter("ignore", UserWarning)
            return sampler.abort(), False
    except BaseException:
        with suppress(BaseException):  # it panics where a chain has failed before
            sampler.cancel()
        raise


def _kept(trace: Any, *, whole: bool) -> tuple[list[int], int]:
    """Chains and draws to keep of a trace: the most draws that two chains or more hold."""
    if "z" not in getattr(trace, "posterior", {}):
        raise KeyboardInterrupt
    drawn = np.isfinite(trace.posterior["z"].values).all(axis=2).sum(axis=1)
    if whole:
        return list(range(len(drawn))), int(drawn.min())
    lengths = sorted((int(n) for n in drawn), reverse=True)
    enough = list(enumerate(lengths, 1))[_FEWEST_CHAINS - 1 :]
    _, draws = max(enough, key=lambda pair: pair[0] * pair[1], default=(0, 0))
    if draws < _FEWEST_DRAWS:
        raise KeyboardInterrupt
    return [i for i, n in enumerate(drawn) if n >= draws], draws


def _check(**numbers: int | None) -> None:
    """Refuse numbers with which there is nothing to draw."""
    least = {"draws": _FEWEST_DRAWS, "tune": _FEWEST_DRAWS, "chains": _FEWEST_CHAINS, "cores": 1}
    for name, value in numbers.items():
        if value is not None and value < least.get(name, 0):
            raise InputError(f"{name} is {value}; give at least {least.get(name, 0)}")


#: Chains that agree have an R-hat of at most this; so many effective draws of each are enough.
RHAT, ESS_PER_CHAIN = 1.01, 100
#: Part of the draws that may diverge: the torque has kinks, at which a step may fail.
_DIVERGING = 0.005
#: Quantiles between which the tails begin.
_TAILS = (0.05, 0.95)


@dataclass(frozen=True, slots=True)
class Convergence:
    """How far the chains of one parameter can be believed."""

    #: Rank-normalised split R-hat: 1 where the chains agree; None where they never moved.
    rhat: float | None
    #: `ess_bulk`, `ess_tail`: independent draws that the chains are worth for the median, and for
    #: the ends of the interval.
    ess_bulk: float | None
    ess_tail: float | None


def convergence(draws: FloatArray) -> Convergence:
    """Diagnostics of one parameter's chains, shape (chains, draws).

    Vehtari, Gelman, Simpson, Carpenter and Bürkner, Rank-normalization, folding, and
    localization: an improved R̂, Bayesian Analysis 16 (2021).
    """
    from arviz_stats.base import array_stats

    along = {"chain_axis": 0, "draw_axis": 1}
    with np.errstate(all="ignore"):
        numbers = (
            array_stats.rhat(draws, method="rank", **along),
            array_stats.ess(draws, method="bulk", **along),
            array_stats.ess(draws, method="tail", prob=_TAILS, **along),
        )
    moved = draws.min() < draws.max()
    return Convergence(*(float(n) if moved and np.isfinite(n) else None for n in numbers))


def verdict(
    convergences: Mapping[str, Convergence], diverging: int, shape: tuple[int, ...]
) -> tuple[bool, str]:
    """Whether draws can be believed, and a sentence that says why or what to do.

    `shape` is the number of chains, and of draws of each.
    """
    chains, draws = shape
    enough = ESS_PER_CHAIN * chains
    apart = {name: c.rhat for name, c in convergences.items() if not (c.rhat or np.inf) <= RHAT}
    few = {name: min(c.ess_bulk or 0.0, c.ess_tail or 0.0) for name, c in convergences.items()}
    complaints = []
    if apart:
        worst = max(apart, key=lambda name: apart[name] or np.inf)
        rhat = apart[worst]
        complaints.append(
            f"the chains disagree in {', '.join(apart)} (R-hat up to "
            f"{'∞' if rhat is None else f'{rhat:.3f}'}, {RHAT} wanted): draw more, or fix or "
            "give a prior to a parameter that trades off"
        )
    least = min(few, key=lambda name: few[name])
    if few[least] < enough:
        factor = f"at least {enough / few[least]:.2g} times as many" if few[least] else "more"
        complaints.append(
            f"only {few[least]:.0f} effective draws of {least}, {enough} wanted: draw {factor}"
        )
    if diverging > _DIVERGING * chains * draws:
        complaints.append(
            f"{diverging} of {chains * draws} draws diverge: part of the posterior may be missing; "
            "give a prior to a parameter the recordings say little of, or fix it"
        )
    if complaints:
        return False, "; ".join(complaints)
    highest = max(c.rhat or np.inf for c in convergences.values())
    text = f"{chains} chains agree: R-hat at most {highest:.3f}, "
    text += f"{few[least]:.0f} effective draws or more"
    if diverging:
        text += f"; {diverging} of {chains * draws} draws diverge"
    return True, text
