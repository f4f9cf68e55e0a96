"""The fits of the simulation study as cells, what is asked of them, and readings of the noise."""

from collections.abc import Iterable, Mapping, Sequence
from dataclasses import dataclass, replace

import numpy as np

from surae.units import FloatArray
from surae_thesis.claims import NotThereError
from surae_thesis.section import Row

#: The five basic profiles (2.5.1) in the order of Figure 13.
PROFILES = ("sine", "multiple-holds", "multi-sine", "multi-sine-holds", "scaled-chirp")
MODELS = ("muscle", "muscle-tendon")
TASKS = ("part-passive", "active")
#: Chirp A·sin(s·t²): amplitudes A [rad], and the 23 factors s (2.5.1).
AMPLITUDES = (0.0, 0.1, 0.2, 0.3)
FACTORS = tuple(round(0.05 + 0.025 * k, 3) for k in range(23))
#: What the thesis chose (4.1.5).
CHOSEN = ("multiple-holds", "multi-sine-holds")
CHOSEN_AMPLITUDE, CHOSEN_FACTOR = 0.2, 0.5
#: Sampling rates of the implicit and of the thesis's explicit scheme [Hz] (4.4).
RATE_HZ, EXPLICIT_HZ = 125, 1000
#: Noise, a part of each signal's mean (2.5.3); its repeats, their amplitude and factors (3.1.4).
NOISE = 0.05
REPEATS, NOISE_AMPLITUDE = 5, 0.1
NOISE_FACTORS = tuple(factor for factor in FACTORS if factor >= 0.3)
#: Readings of "5 % of the mean" of a torque that changes its sign: the first is simulated and
#: fitted. Equal: in every cell of a model the mean of the first over its grid.
MAGNITUDE, SIGNED, EQUAL = "the mean magnitude", "the signed mean", "equal noise"
READINGS = (MAGNITUDE, SIGNED, EQUAL)
#: The muscle-tendon model with Table 2's ε0 as a strain of the slack length.
STRAIN = "ε0 as a strain"
#: The relaxation parameters, which the thesis treats apart.
RELAXATION = ("tau_rel", "k_rel")


@dataclass(frozen=True, slots=True)
class TorqueSize:
    """Mean magnitude, size of the mean, and root mean square of a torque without noise [Nm]."""

    magnitude: float
    mean: float
    rms: float


@dataclass(frozen=True, slots=True)
class GridCell:
    """One fit of a study that gave estimates.

    Amplitude [rad] and factor are the chirp's, None without one; subject and repeat the numbers of
    subject and noise; VAF in percent; IPDE None where a parameter could not be told, whose SEM is
    missing then; `off` the estimate over the truth, minus 1.
    """

    model: str
    profile: str
    task: str
    amplitude: float
    factor: float | None
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
        name = max(self.off, key=lambda key: abs(self.off[key]))
        return name, abs(self.off[name])

    @property
    def floor(self) -> float:
        """The VAF [%] that the torque's noise alone leaves."""
        if self.torque is None:
            return np.nan
        return 100.0 * (1.0 - (NOISE * self.torque.magnitude / self.torque.rms) ** 2)


Cells = tuple[GridCell, ...]


@dataclass(frozen=True, slots=True)
class Study:
    """All cells under one reading of the noise.

    The grid is of one healthy subject; `noise` has repeats of the noise, muscle model; `patients`
    the grid at fewer factors, part-passive, with a patient's parameters; `others` amplitudes at
    factor 0.5, part-passive, and the chosen chirp, active, for more healthy subjects; `explicit`
    the muscle-tendon model by the thesis's scheme, by sampling rate. Rows of the grid that gave no
    fit have `failed`.
    """

    grid: Cells
    noise: Cells
    patients: Cells
    others: Cells
    explicit: Mapping[int, Cells]
    failed: int = 0


def cells(rows: Iterable[Row]) -> Cells:
    """The distinct fits of a study's table; failed ones are left out."""
    distinct: dict[tuple[object, ...], GridCell] = {}
    for row in rows:
        if row["status"] == "failed" or row["vaf"] is None:
            continue
        names = [key.removesuffix("_true") for key in row if key.endswith("_true")]
        names = [name for name in names if row[name] is not None]
        cell = GridCell(
            model=row["model"],
            profile=row["protocol"],
            task=row["task"],
            amplitude=row["chirp_amplitude"],
            factor=row["chirp_factor"] if row["chirp_amplitude"] else None,
            subject=row["subject"],
            repeat=row["repeat"],
            vaf=row["vaf"],
            ipde=row["ipde"],
            sem={name: row[f"{name}_sem"] for name in names if row[f"{name}_sem"] is not None},
            off={name: row[name] / row[f"{name}_true"] - 1.0 for name in names},
            truth={name: row[f"{name}_true"] for name in names},
        )
        place = (
            cell.model, cell.profile, cell.task, cell.amplitude, cell.factor, cell.subject,
            cell.repeat,
        )  # fmt: skip
        distinct.setdefault(place, cell)
    return tuple(distinct.values())


def level(torque: TorqueSize, reading: str, equal: float) -> float:
    """Standard deviation of the torque's noise by a reading [Nm]."""
    return {MAGNITUDE: NOISE * torque.magnitude, SIGNED: NOISE * torque.mean, EQUAL: equal}[reading]


def under(cell: GridCell, reading: str, equal: float) -> GridCell:
    """What a fitted cell would be with the torque's noise of another reading.

    The sum of squares loses the noise that was added and takes the other; VAF follows, and a
    standard error is proportional to its root, equation (34). To first order correlations and IPDE
    do not depend on the size of the noise. Estimates stay as they were fitted.
    """
    torque = cell.torque
    if torque is None or reading == MAGNITUDE:
        return cell
    added, other = (level(torque, name, equal) for name in (MAGNITUDE, reading))
    rest = (1.0 - cell.vaf / 100.0) * (torque.rms**2 + added**2)
    now = max(rest - added**2, 0.0) + other**2
    scale = float(np.sqrt(now / rest)) if rest > 0.0 else 1.0
    return replace(
        cell,
        vaf=100.0 * (1.0 - now / (torque.rms**2 + other**2)),
        sem={name: value * scale for name, value in cell.sem.items()},
    )


def select(some: Iterable[GridCell], **values: object) -> Cells:
    """The cells with these values of their attributes."""
    return tuple(
        cell for cell in some if all(getattr(cell, key) == value for key, value in values.items())
    )


def there(some: Iterable[GridCell], model: str, **values: object) -> Cells:
    """Select cells as `select` does; NotThereError where there is none."""
    cells = select(some, model=model, **values)
    if not cells:
        raise NotThereError(f"no such fit of the {model} model is there")
    return cells


def along_factor(some: Cells, model: str, profile: str = "multiple-holds") -> Cells:
    """Cells at 0.2 rad against the chirp's factor, part-passive; NotThereError without any."""
    line = select(
        some, model=model, profile=profile, task="part-passive", amplitude=CHOSEN_AMPLITUDE
    )
    if len({cell.factor for cell in line}) < 2:
        raise NotThereError(f"no fits of the {model} model with {profile} over the factors")
    return tuple(sorted(line, key=lambda cell: cell.factor or 0.0))


def along_amplitude(
    some: Cells, model: str, profile: str = "multiple-holds", upto: float = AMPLITUDES[-1]
) -> Cells:
    """Cells at factor 0.5 against the chirp's amplitude, part-passive; errors as of `cell_at`."""
    return tuple(cell_at(some, model, profile, a) for a in AMPLITUDES if a <= upto)


def along_profile(some: Cells, model: str, names: Sequence[str] = PROFILES) -> Cells:
    """Cells at the chosen chirp, part-passive, of these profiles; errors as of `cell_at`."""
    return tuple(cell_at(some, model, name, CHOSEN_AMPLITUDE) for name in names)


def cell_at(
    some: Cells, model: str, profile: str, amplitude: float, task: str = "part-passive"
) -> GridCell:
    """The cell at factor 0.5 and this amplitude; of several subjects the first.

    Raises
    ------
    NotThereError
        Its fit failed.
    """
    factor = CHOSEN_FACTOR if amplitude else None
    here = select(some, model=model, profile=profile, task=task, amplitude=amplitude, factor=factor)
    if not here:
        raise NotThereError(f"no fit of the {model} model with {profile} at {amplitude:g} rad")
    return here[0]


def normalised(some: Sequence[GridCell]) -> dict[str, FloatArray]:
    """SEM of every parameter over its mean over these cells, shape (n,); NaN where there is none.

    The thesis's measure (Figures 11 to 14), by which parameters of different units compare.
    """
    names = dict.fromkeys(name for cell in some for name in cell.sem)
    curves = {}
    for name in names:
        values = np.array([cell.sem.get(name, np.nan) for cell in some])
        curves[name] = values / mean(values)
    return curves


def mean(values: FloatArray) -> float:
    """Mean of the values that there are; NaN where there is none."""
    there = values[~np.isnan(values)]
    return float(there.mean()) if there.size else np.nan


def scores(some: Sequence[GridCell]) -> FloatArray:
    """Mean over the parameters of `normalised`, shape (n,): below 1 is better than the others."""
    values = np.array(list(normalised(some).values()))
    there = ~np.isnan(values)
    total: FloatArray = np.where(there, values, 0.0).sum(axis=0) / there.sum(axis=0)
    return total


def ranked(values: Mapping[str, float]) -> list[str]:
    """Names by their values, the lowest first."""
    return sorted(values, key=lambda name: values[name])
