"""`model="auto"`: the mode of one posterior, and which departures the data ask for.

1. Values without departures, from thinned data (`surae.inference.posterior.valleys`).
2. The choice of departures, their sizes and that of the latents learnt (`departures`).
3. Where latents took what parameters can follow, the choice again without them (`look_back`).
4. What makes the mode unsure, source by source (`laplace`, `at_mode`).
"""

import time
from dataclasses import replace

from surae.base.frozen import FrozenDict
from surae.base.progress import SearchProgress
from surae.base.threads import one_blas_thread
from surae.base.words import Message
from surae.inference.interrupt import postponed_interrupt
from surae.inference.least_squares.minimise import Outcome
from surae.inference.least_squares.starts import Follow
from surae.inference.posterior.at_mode import summed
from surae.inference.posterior.departures import Chosen, choose
from surae.inference.posterior.empirical_bayes import RESTS
from surae.inference.posterior.family import Family
from surae.inference.posterior.look_back import LESS, followed, simplest
from surae.inference.posterior.valleys import first
from surae.inference.problem import FitProblem
from surae.inference.relaxed.cut import with_rest
from surae.inference.result import FitResult, Stage
from surae.model.laboratory import RIGID


def fit_family(
    problem: FitProblem, *, progress: SearchProgress | None = None, follow: Follow | None = None
) -> FitResult:
    """Find the mode of a leg's posterior and all that makes it unsure.

    The problem is of the family's compliant model; which nuisances may be in, its settings say.
    `progress` is called with stages that are done, how many there are, and −2 ln p; `follow` with
    every better point of a descent: the model, all its parameters, and −2 ln p but for a constant,
    which is another one for each posterior that the search makes. Ctrl-C keeps the rigid model by
    least squares.
    """
    begin = time.perf_counter()
    family = Family(with_rest(problem), follow)
    with one_blas_thread(), postponed_interrupt():
        try:
            result = _result(family, progress)
        except KeyboardInterrupt:
            result = _stopped(family)
    return replace(result, seconds=time.perf_counter() - begin)


def _result(family: Family, progress: SearchProgress | None) -> FitResult:
    """Search, choose, look back, and sum up."""
    stages: list[Stage] = []

    def done(name: str, number: int, cost: float) -> None:
        """Add a stage."""
        spent = family.evaluations - sum(stage.evaluations for stage in stages)
        capped = family.capped - sum(stage.capped for stage in stages)
        stages.append(Stage(name, spent, float(cost), capped))
        if progress is not None:
            progress(number, 2, lowest)

    def chosen_from(name: str) -> tuple[Chosen, float]:
        """What the data ask for, and the part of the torque that parameters alone follow."""
        chosen = choose(family, values, noise)
        done(name, 2, chosen.mode.cost)
        return chosen, followed((chosen.posterior, chosen.mode), family.inputs)

    values, noise, met = first(family)
    lowest = min(cost for cost, _ in met)
    done("starts", 1, lowest)
    plain, most = simplest(family)
    chosen, share = chosen_from("departures")
    if share < most - LESS:
        # latents have taken what parameters can follow: without them, and from where these do
        family.hold_still()
        values = plain
        again, other = chosen_from("again")
        if other > share:
            chosen = again
            share = other
    rests = chosen.moved < RESTS
    outcome = str(Outcome.CONVERGED if rests else Outcome.ITERATIONS)
    result = summed(chosen, family, met, stages, outcome)
    if result.posterior is not None:
        with_plain = replace(result.posterior, simplest=FrozenDict(plain))
        result = replace(result, solution=with_plain)
    if family.original.options.tissue is not None:
        result = replace(result, message=Message("ended/rest-tissue", message=result.message))
    if not rests:
        more = Message("ended/moving", message=result.message, moved=chosen.moved)
        result = replace(result, message=more)
    if share >= most - LESS or result.status == "failed":
        return result
    message = Message("ended/lost", share=100 * share, most=100 * most, model=RIGID)
    return replace(result, status="failed", message=message)


def _stopped(family: Family) -> FitResult:
    """What is kept where the user stopped: the rigid model, nothing weighed."""
    plain = family.rigid(family.inputs, priors=FrozenDict())
    code = "ended/rigid-without" if family.original.priors else "ended/rigid"
    solution = replace(plain.solution, outcome=str(Outcome.INTERRUPTED))
    return replace(plain, message=Message(code), solution=solution)
