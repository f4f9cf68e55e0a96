"""Which fits are asked for, in full and in quick mode, as settings of jobs."""

from collections.abc import Iterator
from dataclasses import dataclass
from typing import Any

from surae_thesis.cohort.members import (
    ACTIVE_PROTOCOL,
    COMPLETED,
    FAST_PROTOCOL,
    PASSIVE_PROTOCOL,
    REPETITIONS,
    SUBJECTS,
    CohortSubject,
    make_cohort,
)
from surae_thesis.cohort.trials import FITTED_HZ, REMOVABLE
from surae_thesis.section import Context

#: Models of the thesis by its numbers.
MODELS = {
    "1.0": "muscle",
    "2.0": "muscle-tendon",
    "2.1": "muscle-tendon-strain",
    "2.2": "muscle-tendon-toe",
}
ACTIVE = (ACTIVE_PROTOCOL, FAST_PROTOCOL)
#: What is left out in turn to see what it costs; all together last.
EVERYTHING = tuple(REMOVABLE)
#: Rate of the thesis's muscle-tendon model (4.4) [Hz].
EXPLICIT_HZ = 1000.0

Settings = dict[str, Any]
#: Protocol and repetition of a recording.
Trial = tuple[str, int]


@dataclass(frozen=True, slots=True)
class Size:
    """How much is computed.

    Attributes
    ----------
    seed : int
        Of the cohort and of the fits' random starts.
    subjects, repetitions : int
        Of the cohort.
    models : tuple of str
        Numbers of the thesis's models.
    rate_hz : float
        Of the fits [Hz].
    starts : int
        Of each fit.
    baseline : int
        Virtual subjects of the simulations that standard errors are compared with.
    """

    seed: int
    subjects: int
    repetitions: int
    models: tuple[str, ...]
    rate_hz: float
    starts: int
    baseline: int

    @classmethod
    def of(cls, context: Context) -> "Size":
        """Of the whole cohort, or of a few fits that pass through the same code."""
        if context.quick:
            return cls(context.seed, 3, 2, ("1.0", "2.0"), 128.0, 1, 2)
        return cls(context.seed, SUBJECTS, REPETITIONS, tuple(MODELS), FITTED_HZ, 4, 10)

    @property
    def members(self) -> tuple[CohortSubject, ...]:
        """The cohort."""
        return make_cohort(self.seed, self.subjects)


def single_fits(size: Size) -> dict[str, Settings]:
    """The thesis's fits: every model to every recording alone.

    The fit of repetition 1 predicts the others, and from the multiple holds the ramp and hold.
    """
    jobs = {}
    for number, member in enumerate(size.members):
        for protocol in member.completed:
            for repetition in range(1, size.repetitions + 1):
                told = list(_predicted(size, protocol)) if repetition == 1 else []
                for model in size.models:
                    jobs[f"{model} {member.id} {protocol} {repetition}"] = fit_settings(
                        size, number, [(protocol, repetition)], model, predicted=told
                    )
    return jobs


def _predicted(size: Size, protocol: str) -> Iterator[Trial]:
    for repetition in range(2, size.repetitions + 1):
        yield protocol, repetition
    if protocol == ACTIVE_PROTOCOL:
        for repetition in range(1, size.repetitions + 1):
            yield PASSIVE_PROTOCOL, repetition


def spared_fits(size: Size) -> dict[str, Settings]:
    """Repetition 1 without one imperfection in turn, and without all: what each costs."""
    models = ("1.0",) if len(size.models) < len(MODELS) else ("1.0", "2.0")
    cases = {name: (name,) for name in REMOVABLE} | {"all": EVERYTHING}
    jobs = {}
    for number, member in enumerate(size.members):
        for protocol in (PASSIVE_PROTOCOL, ACTIVE_PROTOCOL):
            for model in models:
                if protocol == PASSIVE_PROTOCOL and model != "1.0":
                    continue
                for name, without in cases.items():
                    jobs[f"{model} {member.id} {protocol} without {name}"] = fit_settings(
                        size, number, [(protocol, 1)], model, without=without,
                        predicted=[(protocol, 2)], starts=min(size.starts, 2),
                    )  # fmt: skip
    return jobs


def fit_settings(
    size: Size,
    number: int,
    trials: list[Trial],
    model: str,
    *,
    free: tuple[str, ...] = (),
    without: tuple[str, ...] = (),
    predicted: list[Trial] | None = None,
    rate_hz: float | None = None,
    starts: int | None = None,
    options: dict[str, str] | None = None,
) -> Settings:
    """Settings of `surae_thesis.cohort.work.fit_job`."""
    return {
        "seed": size.seed,
        "member": number,
        "trials": [list(one) for one in trials],
        "model": MODELS[model],
        "free": list(free),
        "without": list(without),
        "predicted": [list(one) for one in predicted or ()],
        "rate_hz": rate_hz or size.rate_hz,
        "starts": starts or size.starts,
        "options": options or {},
    }


def explicit_fits(size: Size) -> dict[str, Settings]:
    """Repetition 1 with the thesis's integrator of the tendon, explicit, at its rate of 1000 Hz."""
    return _first_fits(size, EXPLICIT_HZ, {"integrator": "explicit-euler"})


def strain_fits(size: Size) -> dict[str, Settings]:
    """Repetition 1 with the ε0 of Table 2 as a strain of the slack length."""
    return _first_fits(size, size.rate_hz, {"tendon_strain": "slack-length"})


def _first_fits(size: Size, rate_hz: float, options: dict[str, str]) -> dict[str, Settings]:
    """Model 2.0 to repetition 1 of every protocol, 2.1 and 2.2 to that of the multiple holds."""
    return {
        f"{model} {member.id} {protocol} 1": fit_settings(
            size, number, [(protocol, 1)], model, predicted=list(_predicted(size, protocol)),
            rate_hz=rate_hz, starts=1, options=options,
        )
        for number, member in enumerate(size.members)
        for protocol in member.completed
        for model in size.models
        if model == "2.0" or (model != "1.0" and protocol == ACTIVE_PROTOCOL)
    }  # fmt: skip


def strengths(size: Size) -> dict[str, Settings]:
    """Settings of `surae_thesis.cohort.work.strength_job` by subject."""
    return {
        member.id: {
            "seed": size.seed, "member": number, "protocol": ACTIVE_PROTOCOL,
            "rate_hz": size.rate_hz,
        }
        for number, member in enumerate(size.members)
    }  # fmt: skip


def baselines(size: Size) -> dict[str, Settings]:
    """Settings of `surae_thesis.cohort.work.baseline_job` by model and protocol."""
    return {
        f"{model} {protocol}": {
            "seed": size.seed,
            "protocol": protocol,
            "model": MODELS[model],
            "subjects": size.baseline,
            "rate_hz": size.rate_hz,
        }
        for model in size.models
        for protocol in COMPLETED
        if protocol != PASSIVE_PROTOCOL
    }
