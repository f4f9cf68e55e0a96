"""Which fits are asked for, in full and in quick mode, as settings of `work`'s jobs by label."""

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
#: Rate of the thesis's muscle-tendon model (4.4) [Hz].
EXPLICIT_HZ = 1000.0

Settings = dict[str, Any]
#: Protocol and repetition of a recording.
Trial = tuple[str, int]


@dataclass(frozen=True, slots=True)
class Size:
    """How much is computed: a cohort, and the rate [Hz] and starts of each fit.

    Standard errors are compared with those of `baseline` simulated subjects. The first `closer`
    subjects are looked at closer: fits by the explicit scheme, each of which takes as long as
    thirty others, and fits that are spared imperfections.
    """

    seed: int
    subjects: int = SUBJECTS
    repetitions: int = REPETITIONS
    rate_hz: float = FITTED_HZ
    starts: int = 4
    baseline: int = 10
    closer: int = 3

    @classmethod
    def of(cls, context: Context) -> "Size":
        """Make the size of the whole cohort, or of fewer fits that check every claim."""
        return cls(context.seed, 5, 2, 128.0, 1, 2, 1) if context.quick else cls(context.seed)

    @property
    def members(self) -> tuple[CohortSubject, ...]:
        """The cohort."""
        return make_cohort(self.seed, self.subjects)

    def recordings(self) -> Iterator[tuple[int, CohortSubject, str]]:
        """Number and data of every subject, and each protocol that it completed."""
        for number, member in enumerate(self.members):
            for protocol in member.completed:
                yield number, member, protocol


def fit_settings(
    size: Size, number: int, trials: list[Trial], model: str, **others: object
) -> Settings:
    """Settings of `work.fit_job`, with others than the usual ones of the size."""
    return {
        "seed": size.seed, "member": number, "trials": [list(trial) for trial in trials],
        "model": MODELS[model], "free": [], "without": [], "predicted": [],
        "rate_hz": size.rate_hz, "starts": size.starts, "options": {}, **others,
    }  # fmt: skip


def _predicted(size: Size, protocol: str) -> list[list[object]]:
    """What repetition 1 predicts: the others, and from the multiple holds the ramp and hold."""
    every = range(1, size.repetitions + 1)
    passive = [[PASSIVE_PROTOCOL, r] for r in every] if protocol == ACTIVE_PROTOCOL else []
    return [*([protocol, r] for r in every if r > 1), *passive]


def single_fits(size: Size) -> dict[str, Settings]:
    """The thesis's fits: every model to every recording alone."""
    return {
        f"{model} {member.id} {protocol} {repetition}": fit_settings(
            size, number, [(protocol, repetition)], model,
            predicted=_predicted(size, protocol) if repetition == 1 else [],
        )
        for number, member, protocol in size.recordings()
        for repetition in range(1, size.repetitions + 1)
        for model in MODELS
    }  # fmt: skip


def spared_fits(size: Size) -> dict[str, Settings]:
    """Repetition 1 without one imperfection in turn, and without all: what each costs."""
    cases = {name: [name] for name in REMOVABLE} | {"all": list(REMOVABLE)}
    return {
        f"{model} {member.id} {protocol} without {name}": fit_settings(
            size, number, [(protocol, 1)], model, without=without, starts=min(size.starts, 2)
        )
        for number, member, protocol in size.recordings()
        for model in ("1.0", "2.0")
        if number < size.closer
        if protocol == ACTIVE_PROTOCOL or (model, protocol) == ("1.0", PASSIVE_PROTOCOL)
        for name, without in cases.items()
    }


def explicit_fits(size: Size) -> dict[str, Settings]:
    """Repetition 1 with the thesis's integrator of the tendon, explicit, at its rate of 1000 Hz."""
    jobs = _first_fits(size, rate_hz=EXPLICIT_HZ, options={"integrator": "explicit-euler"})
    return {label: job for label, job in jobs.items() if job["member"] < size.closer}


def strain_fits(size: Size) -> dict[str, Settings]:
    """Repetition 1 with the ε0 of Table 2 as a strain of the slack length."""
    return _first_fits(size, options={"tendon_strain": "slack-length"})


def _first_fits(size: Size, **others: object) -> dict[str, Settings]:
    """Model 2.0 to repetition 1 of every protocol, 2.1 and 2.2 to that of the multiple holds."""
    return {
        f"{model} {member.id} {protocol} 1": fit_settings(
            size, number, [(protocol, 1)], model, predicted=_predicted(size, protocol), starts=1,
            **others,
        )
        for number, member, protocol in size.recordings()
        for model in MODELS
        if model == "2.0" or (model != "1.0" and protocol == ACTIVE_PROTOCOL)
    }  # fmt: skip


def strengths(size: Size) -> dict[str, Settings]:
    """Settings of `work.strength_job` by subject."""
    fixed = {"seed": size.seed, "protocol": ACTIVE_PROTOCOL, "rate_hz": size.rate_hz}
    return {member.id: {**fixed, "member": n} for n, member in enumerate(size.members)}


def baselines(size: Size) -> dict[str, Settings]:
    """Settings of `work.baseline_job` by model and protocol."""
    return {
        f"{model} {protocol}": {
            "seed": size.seed, "protocol": protocol, "model": MODELS[model],
            "subjects": size.baseline, "rate_hz": size.rate_hz,
        }
        for model in MODELS
        for protocol in COMPLETED
        if protocol != PASSIVE_PROTOCOL
    }  # fmt: skip
