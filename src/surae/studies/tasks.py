"""The fits of a study: tasks of plain settings, and a pure function from one to its outcome."""

import hashlib
import json
import time
import zlib
from collections.abc import Mapping
from contextlib import suppress
from dataclasses import asdict, dataclass, replace
from functools import cache, lru_cache
from importlib.metadata import PackageNotFoundError, version
from pathlib import Path
from typing import Any

from surae._version import __version__
from surae.base.errors import ComputationError
from surae.base.records import from_plain, to_plain
from surae.protocol import Trajectory, generate
from surae.protocol.effort import effort
from surae.studies.study import OPTIONS, Value, motion, rise

_PACKAGE = Path(__file__).resolve().parents[1]
#: Folders whose code a result depends on.
_COMPUTING = ("signals", "model", "protocol", "inference", "studies")
_LIBRARIES = ("numba", "numpy", "scipy")


@cache
def fingerprint() -> str:
    """Hash of surae's version, the sources that compute, and the libraries they use."""
    digest = hashlib.sha256(__version__.encode())
    for name in _LIBRARIES:
        with suppress(PackageNotFoundError):  # part of a bundle without metadata
            digest.update(f"{name} {version(name)}\n".encode())
    for folder in _COMPUTING:
        for source in sorted((_PACKAGE / folder).rglob("*.py")):
            digest.update(source.relative_to(_PACKAGE).as_posix().encode())
            digest.update(source.read_bytes())
    digest.update(Path(__file__).read_bytes())  # what plans and keeps them changes none
    return digest.hexdigest()


#: Sixty-four motions, of 0.3 MB each, are kept by a worker.
_motion = lru_cache(64)(generate)
#: Seeds of subjects: unlike for every seed of a study and number of a subject.
_SUBJECTS = 1_000_000


@dataclass(frozen=True, slots=True, kw_only=True)
class FitTask:
    """One fit, by everything that its numbers depend on."""

    #: `protocol`, `task`, `chirp_amplitude`, `rate_hz`: the motion and the effort; see
    #: `surae.protocol.Protocol`.
    protocol: str
    task: str
    chirp_amplitude: float
    chirp_rate: float | None  #: None without a chirp, where it is irrelevant.
    rate_hz: float
    duration: float | None = None  #: None for the profile's own; `passive_seconds` for the task's.
    passive_seconds: float | None = None
    population: str  #: Population of the virtual subject.
    subject: int  #: Number of the subject, from 1.
    noise: float  #: Noise of EMG and torque, a fraction of each signal's mean magnitude.
    repeat: int  #: Number of the noise's realisation, from 1; without noise all are the same.
    seed: int  #: Seed of the study: of its subjects and of the fit's random starts.
    starts: int  #: Starts of the fit.
    model: str  #: The model that simulates,
    fitted: str | None = None  #: and the one that is fitted; None for the same.
    options: tuple[tuple[str, Value], ...]  #: Its options that the study gives.

    @property
    def key(self) -> str:
        """Hash of the settings and of the program that computes them."""
        text = json.dumps([fingerprint(), asdict(self)], sort_keys=True)
        return hashlib.sha256(text.encode()).hexdigest()


@dataclass(frozen=True, slots=True)
class TaskEstimate:
    """One estimated parameter: value, standard error (None where there is none) and truth."""

    name: str
    value: float | None
    sem: float | None
    true: float


@dataclass(frozen=True, slots=True)
class TaskOutcome:
    """What became of a task."""

    #: "converged", "at-bounds", "failed": As of a fit; "failed" too where there was none.
    status: str
    message: str  #: What happened, in a sentence or two.
    #: `vaf`, `ipde`: as of an assessment; None where there is none.
    vaf: float | None = None
    ipde: float | None = None
    #: The estimated parameters; none where there was no fit.
    estimates: tuple[TaskEstimate, ...] = ()
    seconds: float = 0.0  #: Time that it took.


def task_of(combination: Mapping[str, Any]) -> FitTask:
    """The task of a study's combination; those that differ in nothing that matters share one."""
    options = tuple((name, combination[name]) for name in OPTIONS if name in combination)
    rest = {name: value for name, value in combination.items() if name not in OPTIONS}
    rest["chirp_rate"] = None if rest["chirp_amplitude"] == 0.0 else rise(combination)
    rest.pop("chirp_factor", None)
    if rest["noise"] == 0.0:
        rest["repeat"] = 1
    return FitTask(**rest, options=options)


def outcome_of(key: str, settings: Mapping[str, Any]) -> dict[str, Any]:
    """Run the task of some settings, as `run_task` does, wherever it may be; the outcome, plain."""
    task = from_plain(FitTask, settings)
    if task.key != key:
        raise ComputationError(
            "a worker has another surae, or other libraries, than the run: install the same "
            "everywhere and run the same command again: what is finished is kept"
        )
    return dict(to_plain(run_task(task)))


def run_task(task: FitTask) -> TaskOutcome:
    """Simulate the task's trial, fit it and judge the fit.

    The same task gives the same bits anywhere, but for `seconds`. Whatever goes wrong is an
    outcome with a reason; only the user's Ctrl-C is raised.
    """
    begin = time.perf_counter()
    try:
        outcome = _fit(task)
    except Exception as error:
        if isinstance(error.__cause__ or error.__context__, KeyboardInterrupt):
            raise KeyboardInterrupt from None  # compiled code makes it a SystemError
        outcome = TaskOutcome("failed", " ".join(f"{type(error).__name__}: {error}".split()))
    return replace(outcome, seconds=time.perf_counter() - begin)


def _fit(task: FitTask) -> TaskOutcome:
    from surae.estimators import LeastSquaresOptions
    from surae.inference import assess, make_problem, solve
    from surae.model import ModelOptions, get_model
    from surae.settings import FitSettings
    from surae.studies.populations import virtual_subject
    from surae.studies.virtual import virtual_trial

    options = ModelOptions.of(**dict(task.options))
    spec = get_model(task.model)
    drawn = virtual_subject(_SUBJECTS * task.seed + task.subject, task.population, tendons=True)
    # A tendon of the subject's own only where it is estimated: what is fixed is fixed rightly.
    tendons = {name: value for name, value in drawn.tendons.items() if name in spec.free}
    subject = replace(drawn, tendons=tendons)
    # Another noise in every motion, effort and repeat; models and their options share it.
    cell = [task.protocol, task.task, task.chirp_amplitude, task.chirp_rate, task.rate_hz]
    trial = virtual_trial(
        subject,
        _trajectory(task),
        model=task.model,
        options=options,
        noise=task.noise,
        seed=zlib.crc32(json.dumps([*cell, task.repeat]).encode()),
    )
    settings = FitSettings(task.fitted or task.model, options, seed=task.seed)
    if isinstance(settings.estimator, LeastSquaresOptions):  # a posterior has starts of its own
        settings = FitSettings.of(settings, starts=task.starts)
    result = solve(make_problem([trial], settings))
    if result.solution.is_interrupted:
        raise KeyboardInterrupt
    assessment = assess(result)
    truth = subject.truth(task.model, options)
    return TaskOutcome(
        result.status,
        result.message,
        assessment.vaf,
        assessment.ipde,
        tuple(
            TaskEstimate(name, p.value, p.sem, truth[name])
            for name, p in assessment.parameters.items()
            if p.free and name in truth  # of `auto` the laboratory's are not
        ),
    )


def _trajectory(task: FitTask) -> Trajectory:
    """The motion, shared by all tasks that have it, with the task's own effort."""
    settings = motion(asdict(task))
    still = _motion(replace(settings, task="passive", passive_seconds=None))
    target = effort(still.time, settings.effort_task)
    return replace(still, settings=settings, effort=target)
