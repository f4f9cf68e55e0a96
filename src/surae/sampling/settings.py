"""What may be asked of profiles and of a posterior."""

from collections.abc import Mapping
from dataclasses import dataclass
from typing import Any

from surae.base.setting import Request, setting

_INFLATION = "Factor on the variance of the noise.  [default: from the residual's correlation]"


def _at_once(what: str) -> Any:
    return setting(
        None,
        f"{what} at a time, by default one for each processor; the numbers do not depend on it.",
        least=1,
        most=1000,
        metavar="N",
        help=f"{what} at a time.  [default: all processors]",
    )


@dataclass(frozen=True, slots=True, kw_only=True)
class ProfileSettings(Request):
    """How parameters are profiled; see `surae.profile`."""

    variance_inflation: float | Mapping[str, float] | None = setting(
        None,
        "Divides Δχ², of all or of each parameter. By default what the assessment asks for: "
        "each parameter's own (sem_robust/sem)² where its interval is robust, as for a residual "
        "that is correlated over time, and 1 otherwise; see `surae.inference.judging.assessed`.",
        above=0.0,
        metavar="F",
        help=_INFLATION,
    )
    workers: int | None = _at_once("Profiles")


@dataclass(frozen=True, slots=True, kw_only=True)
class PosteriorSettings(Request):
    """How a posterior is drawn from; see `surae.posterior`."""

    draws: int = setting(
        1000,
        "Draws that are kept, of equal weight.",
        least=10,
        most=1_000_000,
        help="Draws that are kept.",
    )
    evaluations: int = setting(
        3600,
        "Evaluations of the posterior, in six rounds.",
        least=600,
        most=1_000_000,
        help="Evaluations of the posterior.",
    )
    seed: int = setting(
        0,
        "Seed of the draws; the numbers depend on nothing else that is random.",
        least=0,
        most=2**63,
        help="Seed of the draws.",
    )
    priors: Mapping[str, tuple[float, float]] | None = setting(
        None,
        "Priors in place of the fit's own, which stand in place of the wide defaults of "
        "`surae.inference.population_priors`.",
        type="mapping of str to (median, spread)",
        option="prior",
        metavar="MEDIAN:SPREAD",
        example="tau_rel=3:0.3",
        help="Known beforehand, instead of the defaults.",
    )
    variance_inflation: float | None = setting(
        None,
        "Divides the weight of the data. By default what the assessment asks for: the median "
        "over the parameters of (sem_robust/sem)² where intervals are robust, as for a residual "
        "that is correlated over time, and 1 otherwise; see `surae.inference.judging.assessed`. "
        "One number, since the likelihood has one noise: parameters for which the correlation "
        "matters more than for most get too narrow an interval, which their profile or "
        "`ci95` does not.",
        above=0.0,
        metavar="F",
        help=_INFLATION,
    )
    workers: int | None = _at_once("Evaluations")
