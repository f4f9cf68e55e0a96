"""The fits of a study as cells of its grid, and what the claims compare: SEM over its mean."""

from collections.abc import Iterable, Mapping, Sequence
from dataclasses import dataclass
from typing import Any

import numpy as np

from surae.reproduction.fits import Row
from surae.units import FloatArray


class NoFitError(LookupError):
    """A claim needs a cell of the grid whose fit failed."""


#: The relaxation parameters, which the thesis treats apart.
RELAXATION = ("tau_rel", "k_rel")
#: The thesis's noise, as a part of each signal's mean (2.5.3).
NOISE = 0.05


@dataclass(frozen=True, slots=True)
class TorqueSize:
    """Mean magnitude, mean and root mean square of a torque without noise [Nm]."""

    magnitude: float
    mean: float
    rms: float

    @property
    def noise(self) -> float:
        """Standard deviation of the thesis's noise, of the mean magnitude [Nm]."""
        return NOISE * self.magnitude

    @property
    def signed_noise(self) -> float:
        """The same of the signed mean [Nm]."""
        return NOISE * abs(self.mean)

    def vaf(self, *, signed: bool = False) -> float:
        """The VAF [%] that this noise alone leaves; of the signed mean instead."""
        noise = self.signed_noise if signed else self.noise
        return 100.0 * (1.0 - (noise / self.rms) ** 2)


@dataclass(frozen=True, slots=True)
class Cell:
    """One fit of a study that gave estimates.

    Attributes
    ----------
    model, profile, task : str
        Model, basic profile and EMG task.
    amplitude : float
        Of the chirp [rad].
    rate : float or None
        Of the chirp [-]; None without chirp.
    subject, repeat : int
        Numbers of subject and noise.
    vaf : float
        [%].
    ipde : float or None
        None where a parameter could not be told.
    sem : mapping of str to float
        Standard errors by parameter; without those that could not be told.
    off : mapping of str to float
        Estimate over truth, minus 1.
    truth : mapping of str to float
        True values.
    torque : TorqueSize or None
        None where it has not been computed.
    """

    model: str
    profile: str
    task: str
    amplitude: float
    rate: float | None
    subject: int
    repeat: int
    vaf: float
    ipde: float | None
    sem: Mapping[str, float]
    off: Mapping[str, float]
    truth: Mapping[str, float]
    torque: TorqueSize | None = None

    @property
    def worst(self) -> tuple[str, float]:
        """The parameter farthest from its truth, and how far, as a part of the truth."""
        name = max(self.off, key=lambda one: abs(self.off[one]))
        return name, abs(self.off[name])


def cells(rows: Iterable[Row]) -> tuple[Cell, ...]:
    """The distinct fits of a study's table; failed ones are left out."""
    found: dict[tuple[object, ...], Cell] = {}
    for row in rows:
        if row["status"] == "failed" or row["vaf"] is None:
            continue
        cell = _cell(row)
        key = (
            cell.model, cell.profile, cell.task, cell.amplitude, cell.rate, cell.subject,
            cell.repeat,
        )  # fmt: skip
        found.setdefault(key, cell)
    return tuple(found.values())


def _cell(row: Mapping[str, Any]) -> Cell:
    names = [key.removesuffix("_true") for key in row if key.endswith("_true")]
    names = [name for name in names if row[name] is not None]
    return Cell(
        model=row["model"],
        profile=row["protocol"],
        task=row["task"],
        amplitude=row["chirp_amplitude"],
        rate=row["chirp_factor"] if row["chirp_amplitude"] else None,
        subject=row["subject"],
        repeat=row["repeat"],
        vaf=row["vaf"],
        ipde=row["ipde"],
        sem={name: row[f"{name}_sem"] for name in names if row[f"{name}_sem"] is not None},
        off={name: row[name] / row[f"{name}_true"] - 1.0 for name in names},
        truth={name: row[f"{name}_true"] for name in names},
    )


def select(found: Iterable[Cell], **values: object) -> tuple[Cell, ...]:
    """The cells with these values of their attributes."""
    return tuple(
        cell for cell in found if all(getattr(cell, key) == value for key, value in values.items())
    )


def at_chirp(
    found: Iterable[Cell], amplitude: float, rate: float, **values: object
) -> tuple[Cell, ...]:
    """The cells with this chirp; without amplitude there is no rate."""
    return select(found, amplitude=amplitude, rate=rate if amplitude else None, **values)


def normalised(found: Sequence[Cell]) -> dict[str, FloatArray]:
    """SEM of every parameter over its mean over these cells, shape (n,); NaN where there is none.

    The thesis's measure (Figures 11 to 14), by which parameters of different units compare.
    """
    names = dict.fromkeys(name for cell in found for name in cell.sem)
    result = {}
    for name in names:
        values = np.array([cell.sem.get(name, np.nan) for cell in found])
        result[name] = values / mean(values)
    return result


def mean(values: FloatArray) -> float:
    """Mean of the values that there are; NaN where there is none."""
    there = values[~np.isnan(values)]
    return float(there.mean()) if there.size else np.nan


def scores(found: Sequence[Cell]) -> FloatArray:
    """Mean over the parameters of `normalised`, shape (n,): below 1 is better than the others."""
    values = np.array(list(normalised(found).values()))
    there = ~np.isnan(values)
    total: FloatArray = np.where(there, values, 0.0).sum(axis=0) / there.sum(axis=0)
    return total


def ranked(names: Sequence[str], values: Sequence[float]) -> list[str]:
    """Names by their values, the lowest first."""
    return [name for _, name in sorted(zip(values, names, strict=True))]
