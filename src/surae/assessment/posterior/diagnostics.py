"""Whether Markov chains can be believed: R-hat, effective draws, divergences (Vehtari 2021)."""

from collections.abc import Mapping
from dataclasses import dataclass

import numpy as np

from surae.units import FloatArray

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
