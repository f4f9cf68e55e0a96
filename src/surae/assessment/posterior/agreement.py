"""Credible intervals beside those of the covariance and of profiles: where they part, and how far.

All three agree where the model is linear within the width of the posterior. Where they do not, the
posterior is skewed or bent, or its prior matters.
"""

from collections.abc import Mapping
from dataclasses import dataclass

from surae.assessment.posterior.sample import Posterior
from surae.errors import InputError
from surae.files import PathLike, shown
from surae.records import check_format, from_plain, read_json

#: Ends of intervals agree when they lie within this part of the credible interval's half-width;
#: with enough draws, chance moves them by less than a third of it.
AGREEMENT_TOLERANCE = 0.25


@dataclass(frozen=True, slots=True)
class ProfileInterval:
    """The 95 % interval of a profile: its ends, None where open, and what it took noise for."""

    ends: tuple[float | None, float | None]
    variance_inflation: float


@dataclass(frozen=True, slots=True)
class Agreement:
    """The 95 % intervals of one parameter.

    Attributes
    ----------
    name : str
        The parameter.
    credible : tuple of float
        Of the posterior.
    covariance : tuple of float, or None
        Of the covariance; None where there is none.
    profile : ProfileInterval or None
        Of the profile likelihood; None without one.
    """

    name: str
    credible: tuple[float, float]
    covariance: tuple[float, float] | None
    profile: ProfileInterval | None

    @property
    def off_covariance(self) -> float | None:
        """How far the covariance's ends lie from the credible ones, in its half-widths."""
        return self._off(self.covariance)

    @property
    def off_profile(self) -> float | None:
        """How far the profile's ends lie from the credible ones, in its half-widths.

        An open end lies nowhere; None where both are open.
        """
        return self._off(self.profile.ends) if self.profile is not None else None

    def _off(self, interval: tuple[float | None, float | None] | None) -> float | None:
        half = (self.credible[1] - self.credible[0]) / 2
        ends = zip(self.credible, interval or (), strict=False)
        return max((abs(a - b) / half for a, b in ends if b is not None), default=None)


def agreements(
    posterior: Posterior, profiles: Mapping[str, ProfileInterval] | None = None
) -> dict[str, Agreement]:
    """The intervals of every parameter of a posterior, with those of profiles where there are any.

    Parameters
    ----------
    posterior : Posterior
        The draws.
    profiles : mapping of str to ProfileInterval, optional
        By parameter, as `read_profile_intervals` gives them.
    """
    return {
        name: Agreement(name, marginal.ci95, marginal.from_covariance, (profiles or {}).get(name))
        for name, marginal in posterior.marginals.items()
    }


@dataclass(frozen=True, slots=True)
class _KeptProfile:
    value: float
    interval: tuple[float | None, float | None]
    variance_inflation: float


@dataclass(frozen=True, slots=True)
class _Kept:
    model: str
    profiles: Mapping[str, _KeptProfile]


def read_profile_intervals(
    path: PathLike, values: Mapping[str, float], model: str
) -> dict[str, ProfileInterval]:
    """The intervals of a PROFILE.json, which must be of the same fit.

    Parameters
    ----------
    path : path
        What `surae profile --output` wrote.
    values : mapping of str to float
        Estimates of the fit.
    model : str
        Its model.

    Raises
    ------
    InputError
        The file is missing or damaged, or of another fit.
    """
    data = read_json(path)
    check_format(data, path)
    try:
        kept = from_plain(_Kept, data)
    except InputError as error:
        raise InputError(
            f"{shown(path)}: not a whole PROFILE.json ({error}); give one that "
            "`surae profile --output` wrote"
        ) from None
    for name, profile in kept.profiles.items():
        if kept.model != model or profile.value != values.get(name):
            raise InputError(
                f"{shown(path)}: profiles of another fit; profile this one with `surae profile`"
            )
    return {
        name: ProfileInterval(own.interval, own.variance_inflation)
        for name, own in kept.profiles.items()
    }
