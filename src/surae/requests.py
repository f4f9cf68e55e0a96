"""What further questions about a fit may be asked, one field each, as `settings.py` has a fit's."""

from collections.abc import Mapping
from dataclasses import dataclass
from typing import Any

from surae.setting import setting

#: More fits or threads than these are slips of the keyboard.
_MOST_FITS, _MOST_WORKERS = 1_000_000, 1000
#: What `--variance-inflation` says of itself.
_INFLATION = "Factor on the variance of the noise.  [default: from the residual's correlation]"


def _workers(what: str) -> Any:
    return setting(
        None, f"{what} at a time, by default one for each processor; the numbers do not depend on "
        "it.", least=1, most=_MOST_WORKERS, metavar="N",
        help=f"{what} at a time.  [default: all processors]",
    )  # fmt: skip


def _seed(what: str, most: int | None = None) -> Any:
    text = f"Seed of the {what}; the numbers depend on nothing else that is random."
    return setting(0, text, least=0, most=most, help=f"Seed of the {what}.")


@dataclass(frozen=True, slots=True, kw_only=True)
class ProfileSettings:
    """How parameters are profiled; see `surae.profile`."""

    variance_inflation: float | Mapping[str, float] | None = setting(
        None, "Divides Δχ², of all or of each parameter. By default what the assessment asks for: "
        "each parameter's own (sem_robust/sem)² where its interval is robust, as for a residual "
        "that is correlated over time, and 1 otherwise; see `surae.assessment.assess`.",
        above=0.0, metavar="F", help=_INFLATION,
    )  # fmt: skip
    workers: int | None = _workers("Profiles")


@dataclass(frozen=True, slots=True, kw_only=True)
class PosteriorSettings:
    """How a posterior is drawn from; see `surae.posterior`."""

    draws: int = setting(
        1000, "Draws of each chain that are kept.", least=10, most=_MOST_FITS,
        help="Draws of each chain.",
    )  # fmt: skip
    tune: int = setting(
        300, "Draws of each chain that tune the sampler before.", least=10, most=_MOST_FITS,
        help="Draws that tune the sampler first.",
    )  # fmt: skip
    chains: int = setting(4, "Number of chains.", least=2, most=100, help="Number of chains.")
    seed: int = _seed("draws", 2**63)
    priors: Mapping[str, tuple[float, float]] | None = setting(
        None, "Priors in place of the fit's own, which stand in place of the wide defaults of "
        "`surae.estimation.population`.", type="mapping of str to (median, spread)", option="prior",
        metavar="MEDIAN:SPREAD", example="tau_rel=3:0.3",
        help="Known beforehand, instead of the defaults.",
    )  # fmt: skip
    variance_inflation: float | None = setting(
        None, "Divides the weight of the data. By default what the assessment asks for: the median "
        "over the parameters of (sem_robust/sem)² where intervals are robust, as for a residual "
        "that is correlated over time, and 1 otherwise; see `surae.assessment.assess`. One number, "
        "since the likelihood has one noise: parameters for which the correlation matters more "
        "than for most get too narrow an interval, which their profile or `ci95` does not.",
        above=0.0, metavar="F", help=_INFLATION,
    )  # fmt: skip
    cores: int | None = _workers("Chains")


@dataclass(frozen=True, slots=True, kw_only=True)
class BootstrapSettings:
    """How a fit is made again and again; see `surae.bootstrap`."""

    replicates: int = setting(1000, "Fits to make.", least=1, most=_MOST_FITS, help="Fits to make.")
    seed: int = _seed("random blocks")
    block_s: float | None = setting(
        None, "Length of the blocks [s]; by default from the residual's autocorrelation.",
        option="block", metavar="SECONDS",
        help="Length of the blocks.  [default: from the residual]",
    )  # fmt: skip
    workers: int | None = _workers("Fits")
