"""The studies that the simulation section runs, their fits as cells, and readings of the noise.

The thesis samples the muscle-tendon model at 1000 Hz since its explicit scheme is stiff (4.4); the
implicit one is not, so that both models run at the muscle model's 125 Hz here.
"""

from collections.abc import Iterable, Mapping, Sequence
from dataclasses import dataclass, replace
from typing import Any

import numpy as np

import surae
from surae import ComputationError, ModelInputs
from surae.protocol import Protocol, chirp_rate, generate
from surae.studies import VirtualSubject, virtual_subject, virtual_trial
from surae.units import FloatArray
from surae_thesis.claims import INTEGRATOR, NotThereError
from surae_thesis.section import Context, Row

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
#: Virtual subjects on whom the grid's conclusions are tried again.
_SUBJECTS, _QUICK_SUBJECTS = 10, 5
_QUICK_FACTORS = (0.05, 0.2, 0.35, 0.5, 0.6)
#: What a study of the thesis has in common.
_COMMON: Mapping[str, object] = {
    "model": MODELS, "protocol": PROFILES, "chirp_amplitude": AMPLITUDES,
    "chirp_factor": CHOSEN_FACTOR, "task": "part-passive", "population": "healthy",
    "noise": NOISE, "rate_hz": RATE_HZ, "seed": 1, "starts": 2,
}  # fmt: skip


@dataclass(frozen=True, slots=True)
class TorqueSize:
    """Mean magnitude, size of the mean, and root mean square of a torque without noise [Nm]."""

    magnitude: float
    mean: float
    rms: float


@dataclass(frozen=True, slots=True)
class Cell:
    """One fit of a study that gave estimates.

    Attributes
    ----------
    model, profile, task : str
        Model, basic profile and EMG task.
    amplitude : float
        Of the chirp [rad].
    factor : float or None
        Of the chirp; None without chirp.
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


Cells = tuple[Cell, ...]


@dataclass(frozen=True, slots=True)
class Study:
    """All cells under one reading of the noise.

    Attributes
    ----------
    grid : tuple of Cell
        Profiles by amplitudes by factors by tasks by models, one healthy subject.
    noise : tuple of Cell
        Repeats of the noise, muscle model.
    patients : tuple of Cell
        The grid at fewer factors, part-passive, with a patient's parameters.
    others : tuple of Cell
        Amplitudes at factor 0.5, part-passive, for more healthy subjects.
    explicit : mapping of int to tuple of Cell
        The muscle-tendon model by the thesis's explicit scheme, by sampling rate.
    failed : int
        Rows of the grid that gave no fit.
    """

    grid: Cells
    noise: Cells
    patients: Cells
    others: Cells
    explicit: Mapping[int, Cells]
    failed: int = 0


def studies(context: Context) -> tuple[dict[str, Study], list[Row]]:
    """The cells under each reading, and as the thesis integrated; and the table of the grid."""
    quick, rows = context.quick, {}
    asked: dict[str, dict[str, object]] = {
        "grid": {"chirp_factor": _QUICK_FACTORS if quick else FACTORS, "task": TASKS},
        "patients": {
            "population": "patient",
            "chirp_factor": (0.1, 0.3, 0.5, 0.6) if quick else FACTORS[::2],
        },
        "strain": {"model": "muscle-tendon", "tendon_strain": "slack-length"},
        **{
            f"explicit-{rate}": {
                "model": "muscle-tendon",
                "integrator": "explicit-euler",
                "rate_hz": rate,
                **(
                    {"protocol": ("multiple-holds", "multi-sine"), "chirp_amplitude": (0.2, 0.3)}
                    if quick and rate == EXPLICIT_HZ
                    else {}
                ),
            }
            for rate in (RATE_HZ, EXPLICIT_HZ)
        },
        "others": {"subjects": _QUICK_SUBJECTS if quick else _SUBJECTS},
    }
    for name, factors in asked.items():
        text = _toml({**_COMMON, "seed": context.seed, **factors})
        rows[name] = context.study(f"simulation-{name}", text)
    grid, patients, others = (
        _with_torques(context, name, cells(rows[name]), population)
        for name, population in (
            ("grid", "healthy"), ("patients", "patient"), ("others", "healthy"),
        )
    )  # fmt: skip
    explicit = {rate: cells(rows[f"explicit-{rate}"]) for rate in (RATE_HZ, EXPLICIT_HZ)}
    failed = sum(row["status"] == "failed" for row in rows["grid"])
    equal = {model: _equal_level(select(grid, model=model)) for model in MODELS}
    noise = _noise_cells(context, equal["muscle"])

    def read(some: Cells, reading: str) -> Cells:
        return tuple(under(cell, reading, equal[cell.model]) for cell in some)

    views = {
        reading: Study(
            grid=read(grid, reading),
            noise=noise[reading],
            patients=read(patients, reading),
            others=read(others, reading),
            explicit=explicit,
            failed=failed,
        )
        for reading in READINGS
    }
    for name, some in ((STRAIN, cells(rows["strain"])), (INTEGRATOR, explicit[EXPLICIT_HZ])):
        views[name] = Study(some, (), (), (), explicit)
    return views, rows["grid"]


def _toml(factors: Mapping[str, object]) -> str:
    return "".join(f"{key} = {_value(value)}\n" for key, value in factors.items())


def _value(value: object) -> str:
    if isinstance(value, tuple):
        return f"[{', '.join(map(_value, value))}]"
    return f'"{value}"' if isinstance(value, str) else repr(value)


def cells(rows: Iterable[Row]) -> Cells:
    """The distinct fits of a study's table; failed ones are left out."""
    distinct: dict[tuple[object, ...], Cell] = {}
    for row in rows:
        if row["status"] == "failed" or row["vaf"] is None:
            continue
        names = [key.removesuffix("_true") for key in row if key.endswith("_true")]
        names = [name for name in names if row[name] is not None]
        cell = Cell(
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


def _equal_level(grid: Cells) -> float:
    """The noise that is equal in every cell: the mean over them [Nm]."""
    sizes = [NOISE * cell.torque.magnitude for cell in grid if cell.torque is not None]
    return float(np.mean(sizes)) if sizes else np.nan


def level(torque: TorqueSize, reading: str, equal: float) -> float:
    """Standard deviation of the torque's noise by a reading [Nm]."""
    return {MAGNITUDE: NOISE * torque.magnitude, SIGNED: NOISE * torque.mean, EQUAL: equal}[reading]


def under(cell: Cell, reading: str, equal: float) -> Cell:
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


def _with_torques(context: Context, name: str, some: Cells, population: str) -> Cells:
    """Cells with the size of their torque without noise, simulated again."""
    groups: dict[str, list[Cell]] = {}
    for cell in some:
        label = f"{cell.model} {cell.profile} {cell.task} {cell.subject}"
        groups.setdefault(label, []).append(cell)
    jobs = {
        label: {
            "model": members[0].model,
            "profile": members[0].profile,
            "task": members[0].task,
            "population": population,
            "truth": dict(members[0].truth),
            "chirps": [[cell.amplitude, cell.factor] for cell in members],
        }
        for label, members in groups.items()
    }
    sizes = context.calls(f"simulation-torque-{name}", torque_sizes, jobs)
    return tuple(
        replace(cell, torque=TorqueSize(*size))
        for label, members in groups.items()
        for cell, size in zip(members, sizes[label], strict=True)
    )


def torque_sizes(
    model: str,
    profile: str,
    task: str,
    population: str,
    truth: Mapping[str, float],
    chirps: Sequence[Sequence[float | None]],
) -> list[list[float]]:
    """`TorqueSize` of the torque at chirps (amplitude, factor)."""
    subject = VirtualSubject(population, 0, truth)
    trials = [_trial(subject, model, profile, task, a or 0.0, s) for a, s in chirps]
    return [_size(trial) for trial in trials]


def _size(trial: ModelInputs) -> list[float]:
    torque = np.zeros(1) if trial.torque is None else trial.torque
    rms = float(np.sqrt(np.mean(torque**2)))
    return [float(np.abs(torque).mean()), abs(float(torque.mean())), rms]


def _trial(
    subject: VirtualSubject, model: str, profile: str, task: str, amplitude: float,
    factor: float | None, noise: float = 0.0, seed: int = 0,
) -> ModelInputs:  # fmt: skip
    chirp = {"chirp_rate": chirp_rate(factor)} if amplitude and factor else {}
    motion: dict[str, Any] = {"profile": profile, "task": task, "rate_hz": float(RATE_HZ), **chirp}
    trajectory = generate(Protocol(chirp_amplitude=amplitude, **motion))
    return virtual_trial(subject, trajectory, model=model, noise=noise, seed=seed)


def _noise_cells(context: Context, equal: float) -> dict[str, Cells]:
    """Repeats of the noise, fitted under every reading: muscle model, part-passive, 0.1 rad."""
    factors = (0.3, 0.5, 0.6) if context.quick else NOISE_FACTORS
    places = [(p, factor, r) for r in READINGS for p in PROFILES for factor in factors]
    jobs = {
        f"{profile} {factor} {reading}": {
            "seed": context.seed, "profile": profile, "factor": factor, "reading": reading,
            "equal": equal,
        }
        for profile, factor, reading in places
    }  # fmt: skip
    made = context.calls("simulation-noise", noise_fits, jobs)
    some: dict[str, list[Cell]] = {reading: [] for reading in READINGS}
    for (profile, factor, reading), fits in zip(places, made.values(), strict=True):
        some[reading] += [
            Cell(
                "muscle", profile, "part-passive", NOISE_AMPLITUDE, factor, 1, number, fit["vaf"],
                fit["ipde"], fit["sem"], fit["off"], {},
            )
            for number, fit in enumerate(fits, 1)
            if fit is not None
        ]  # fmt: skip
    return {reading: tuple(several) for reading, several in some.items()}


def noise_fits(
    seed: int, profile: str, factor: float, reading: str, equal: float
) -> list[dict[str, Any] | None]:
    """Fits of one trial under repeats of its noise; None for one that failed."""
    subject = virtual_subject(1_000_000 * seed + 1)
    place = (subject, "muscle", profile, "part-passive", NOISE_AMPLITUDE, factor)
    clean = _trial(*place)
    size = TorqueSize(*_size(clean))
    part = level(size, reading, equal) / level(size, MAGNITUDE, equal)
    fits: list[dict[str, Any] | None] = []
    for repeat in range(1, REPEATS + 1):
        noisy = _trial(*place, noise=NOISE, seed=repeat)
        assert clean.torque is not None  # a simulation has one
        assert noisy.torque is not None
        torque: FloatArray = clean.torque + part * (noisy.torque - clean.torque)
        try:
            fit = surae.fit(
                replace(noisy, torque=torque), "muscle", starts=2, seed=seed, quality=()
            )
        except ComputationError:
            fits.append(None)
            continue
        estimates = {name: p for name, p in fit.parameters.items() if p.free}
        fits.append(
            {
                "vaf": float(fit.vaf),
                "ipde": None if fit.ipde is None else float(fit.ipde),
                "sem": {n: float(p.sem) for n, p in estimates.items() if p.sem is not None},
                "off": {
                    n: float(p.value / subject.parameters[n] - 1.0) for n, p in estimates.items()
                },
            }
        )
    return fits


def select(some: Iterable[Cell], **values: object) -> Cells:
    """The cells with these values of their attributes."""
    return tuple(
        cell for cell in some if all(getattr(cell, key) == value for key, value in values.items())
    )


def there(some: Iterable[Cell], model: str, **values: object) -> Cells:
    """As `select`; NotThereError without any."""
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
) -> Cell:
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


def normalised(some: Sequence[Cell]) -> dict[str, FloatArray]:
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


def scores(some: Sequence[Cell]) -> FloatArray:
    """Mean over the parameters of `normalised`, shape (n,): below 1 is better than the others."""
    values = np.array(list(normalised(some).values()))
    there = ~np.isnan(values)
    total: FloatArray = np.where(there, values, 0.0).sum(axis=0) / there.sum(axis=0)
    return total


def ranked(values: Mapping[str, float]) -> list[str]:
    """Names by their values, the lowest first."""
    return sorted(values, key=lambda name: values[name])
