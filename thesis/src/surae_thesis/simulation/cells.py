"""The fits of the simulation study as cells, what is asked of them, and readings of the noise."""

from collections.abc import Iterable, Mapping, Sequence
from dataclasses import dataclass, replace
from typing import Any

import numpy as np

from surae.base.units import FloatArray
from surae_thesis.claims import NotThereError
from surae_thesis.legs import NOISE

#: The five basic profiles (2.5.1) in the order of Figure 13.
PROFILES = ("sine", "multiple-holds", "multi-sine", "multi-sine-holds", "scaled-chirp")
MODELS = ("muscle", "muscle-tendon")
TASKS = ("part-passive", "active")
#: Chirp A·sin(s·t²): amplitudes A [rad], and the 23 factors s (2.5.1).
AMPLITUDES = (0.0, 0.1, 0.2, 0.3)
FACTORS = tuple(round(0.05 + 0.025 * k, 3) for k in range(23))
#: What the thesis chose (4.1.5).
CHOSEN = ("multiple-holds", "multi-sine-holds")
CHOSEN_AMPLITUDE = 0.2
CHOSEN_FACTOR = 0.5
#: Repeats of the noise, their amplitude and factors (3.1.4).
REPEATS = 5
NOISE_AMPLITUDE = 0.1
NOISE_FACTORS = tuple(factor for factor in FACTORS if factor >= 0.3)
#: Faster chirps than the thesis's, by which a lowest value at its end is told from one before it.
FASTER = tuple(round(0.65 + 0.05 * k, 3) for k in range(4))
#: Readings of "5 % of the mean" of a torque that changes its sign, the first as it is written.
SIGNED = "the signed mean"
MAGNITUDE = "the mean magnitude"
#: The relaxation parameters, which the thesis treats apart.
RELAXATION = ("tau_rel", "k_rel")


@dataclass(frozen=True, slots=True, kw_only=True)
class GridCell:
    """One fit of a study that gave estimates.

    Amplitude [rad] and factor are the chirp's, None without one; subject and repeat the numbers of
    subject and noise; VAF in percent; IPDE None where a parameter could not be told, whose SEM is
    missing then; `off` the estimate over the truth, minus 1; torque the mean magnitude, size of the
    mean, and root mean square of the torque without noise [Nm].
    """

    model: str
    profile: str
    task: str
    amplitude: float
    factor: float | None
    subject: int = 1
    repeat: int = 1
    vaf: float
    ipde: float | None
    sem: Mapping[str, float]
    off: Mapping[str, float]
    torque: Sequence[float]

    @property
    def worst(self) -> tuple[str, float]:
        """The parameter farthest from its truth, and how far, as a part of the truth."""
        name = max(self.off, key=lambda key: abs(self.off[key]))
        return name, abs(self.off[name])

    @property
    def floor(self) -> float:
        """The VAF [%] that the torque's noise alone leaves."""
        return 100.0 * (1.0 - (NOISE * self.torque[1] / self.torque[2]) ** 2)


Cells = tuple[GridCell, ...]


@dataclass(frozen=True, slots=True)
class Study:
    """All cells under one reading.

    The grid is of one healthy subject, `faster` beyond its factors; `noise` has repeats of the
    noise, muscle model; `patients` a patient's cells; `others` chosen cells of all healthy
    subjects. Cells of the grid that gave no fit have `failed`.
    """

    grid: Cells
    faster: Cells = ()
    noise: Cells = ()
    patients: Cells = ()
    others: Cells = ()
    failed: int = 0


def cells(places: Iterable[Mapping[str, Any]], fits: Iterable[Any]) -> Cells:
    """Fits at their places; failed ones are left out."""
    names = ("model", "profile", "task", "amplitude", "factor", "subject", "repeat")
    return tuple(
        GridCell(**{name: place[name] for name in names}, **fit)
        for place, fit in zip(places, fits, strict=True)
        if fit is not None
    )


def with_magnitude(cell: GridCell) -> GridCell:
    """What a fitted cell would be with noise of 5 % of the torque's mean magnitude.

    The sum of squares loses the noise that was added and takes the other; VAF follows, and a
    standard error is proportional to its root, equation (34). To first order correlations and IPDE
    do not depend on the size of the noise. Estimates stay as they were fitted.
    """
    magnitude, mean, rms = cell.torque
    added = NOISE * mean
    other = NOISE * magnitude
    rest = (1.0 - cell.vaf / 100.0) * (rms**2 + added**2)
    now = max(rest - added**2, 0.0) + other**2
    scale = float(np.sqrt(now / rest)) if rest > 0.0 else 1.0
    return replace(
        cell,
        vaf=100.0 * (1.0 - now / (rms**2 + other**2)),
        sem={name: value * scale for name, value in cell.sem.items()},
    )


def select(some: Iterable[GridCell], **values: object) -> Cells:
    """The cells with these values of their attributes."""
    return tuple(
        cell for cell in some if all(getattr(cell, key) == value for key, value in values.items())
    )


def there(some: Iterable[GridCell], **values: object) -> Cells:
    """Select cells as `select` does; NotThereError where there is none."""
    cells = select(some, **values)
    if not cells:
        asked = ", ".join(map(str, values.values()))
        raise NotThereError(f"no such fit is there: {asked}")
    return cells


def along_factor(some: Cells, model: str, profile: str = "multiple-holds") -> Cells:
    """Cells at 0.2 rad against the chirp's factor, part-passive; NotThereError without any."""
    line = there(
        some, model=model, profile=profile, task="part-passive", amplitude=CHOSEN_AMPLITUDE
    )
    if len({cell.factor for cell in line}) < 2:
        raise NotThereError(f"no fits of the {model} model with {profile} over the factors")
    return tuple(sorted(line, key=lambda cell: cell.factor or 0.0))


def along_amplitude(
    some: Cells, model: str, profile: str = "multiple-holds", upto: float = AMPLITUDES[-1]
) -> Cells:
    """Cells at factor 0.5 against the chirp's amplitude, part-passive; errors as of `there`."""
    return tuple(cell_at(some, model, profile, a) for a in AMPLITUDES if a <= upto)


def along_profile(some: Cells, model: str, names: Sequence[str] = PROFILES) -> Cells:
    """Cells at the chosen chirp, part-passive, of these profiles; errors as of `there`."""
    return tuple(cell_at(some, model, name, CHOSEN_AMPLITUDE) for name in names)


def cell_at(
    some: Cells, model: str, profile: str, amplitude: float, task: str = "part-passive"
) -> GridCell:
    """The cell at factor 0.5 and this amplitude; of several subjects the first."""
    factor = CHOSEN_FACTOR if amplitude else None
    return there(some, model=model, profile=profile, task=task, amplitude=amplitude, factor=factor)[
        0
    ]


def normalised(some: Sequence[GridCell]) -> dict[str, FloatArray]:
    """SEM of every parameter over its mean over these cells, shape (n,); NaN where there is none.

    The thesis's measure (Figures 11 to 14), by which parameters of different units compare.
    """
    names = dict.fromkeys(name for cell in some for name in cell.sem)
    curves = {}
    for name in names:
        values = np.array([cell.sem.get(name, np.nan) for cell in some])
        curves[name] = values / np.nanmean(values)
    return curves


def scores(some: Sequence[GridCell]) -> FloatArray:
    """Mean over the parameters of `normalised`, shape (n,): below 1 is better than the others."""
    total: FloatArray = np.nanmean(np.array(list(normalised(some).values())), axis=0)
    return total


def ranked(values: Mapping[str, float]) -> list[str]:
    """Names by their values, the lowest first."""
    return sorted(values, key=lambda name: values[name])
