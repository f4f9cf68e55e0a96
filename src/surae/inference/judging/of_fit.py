"""What a fit says against its own numbers, from how it follows to what its nuisances hide."""

from collections.abc import Iterator, Sequence
from itertools import compress
from statistics import NormalDist

import numpy as np

from surae.base.normal import NORMAL
from surae.inference import FitResult
from surae.inference.judging.fascicles import fascicles_of
from surae.inference.judging.goodness import centred_r2, counted
from surae.inference.judging.of_data import STILL, effort, movement, range_moved
from surae.inference.judging.random_effects import farthest_apart
from surae.inference.judging.reasons import Reason, Scope, against
from surae.inference.judging.structure import structured
from surae.inference.posterior.conflict import SAID
from surae.inference.result import Mounting
from surae.model.laboratory import group_of
from surae.model.source import Gaussian
from surae.model.source_table import LABELS
from surae.model.statements import RARE
from surae.quality.timing import TOO_SHORT

#: Centred R² [%] below which a model does not describe the torque, and from which on it does well.
_NOT_FOLLOWED = 80.0
_FOLLOWED = 95.0
#: What only movement tells: relaxation, and the foot's mass beside a sensor's zero.
_OF_MOVEMENT = ("m", "tau_rel", "k_rel")
#: Part of the free parameters that may lie at a bound before nothing else is believed either.
_MOST_BOUND = 0.5
#: Standard deviations of its prior from which on a nuisance is odd.
_ODD = 2.9
#: Probability of a right statement so far from the torque, below which it is taken for wrong.
_WRONG = 1e-4
#: A recording that is followed so much worse than all together [% of R²] contradicts the others.
_CONTRADICTS = 5.0
#: Probability of zeros of the angle so far apart in trials of one mounting, below which it is said.
_MOVED = 0.01
#: What a hold may leave of its torque, in what recordings leave; of two virtual sets 1.2 and 1.7.
_LEAVES = 2.0
#: Standard deviation [mm] from which on a filmed fascicle departs by more than trackers drift.
_OFF_FILM = 2.5
#: Least softening that matters, and its standard deviations from which it is no chance: set on
#: four virtual legs that soften; of the other families of a fresh seed none came to both.
_SOFTENS = 0.06
_SURE = 2.5
#: Size of what no model has of the muscles' force, as a part of it, from which on it speaks against
#: the numbers: of 142 fits of virtual legs 136 have at most 0.019, six at least 0.035.
_UNEXPRESSED = 0.03


def of_fit(result: FitResult, r2: float) -> Iterator[Reason]:
    """All that a fit with so much of the torque's changes, `r2` [%], says against itself."""
    inputs = result.problem.inputs
    yield from followed(r2)
    yield from movement(inputs, result.problem.options.anatomy)
    yield from effort(result)
    yield from structured(inputs, result.residuals, r2)
    yield from _bounds(result)
    yield from (odd := list(_laboratory(result)))
    yield from _stated(result)
    yield from _agreement(result, r2)
    yield from _films(result)
    yield from _unlike(result, odd)


def followed(r2: float) -> Iterator[Reason]:
    """The torque's changes count, not its offset, which any gravity or zero explains."""
    if r2 < _NOT_FOLLOWED:
        yield against("not-followed", grave=True, r2=r2)
    elif r2 < _FOLLOWED:
        yield against("followed-roughly", r2=r2)


def _bounds(result: FitResult) -> Iterator[Reason]:
    """An estimate at its bound is where the search ended, not what the data say."""
    leg = [name for name in result.problem.free if group_of(name) is None]
    if all(range_moved([recording]) < STILL for recording in result.problem.inputs):
        leg = [name for name in leg if name not in _OF_MOVEMENT]  # which holds do not tell
    if bounded := [name for name in leg if name in result.at_bound]:
        grave = len(bounded) > _MOST_BOUND * len(leg)
        yield against("at-bound", grave=grave, names=", ".join(bounded))


def _laboratory(result: FitResult) -> Iterator[Reason]:
    """A laboratory that is odder than laboratories are stands for what the model leaves out."""
    posterior = result.posterior
    if posterior is None:
        return
    each = posterior.each
    joint = result.problem.options.anatomy
    meanings = {p.name: joint.worded(p.meaning) for p in result.problem.spec.parameters}
    stated = result.problem.settings.known
    odd = [
        f"{meanings[name]} ({name})"
        for name, belief in posterior.beliefs.items()
        if group_of(name) not in stated and _is_odd(each.get(name, (result.values[name],)), belief)
    ]
    if odd:
        yield against("implausible", names=", ".join(odd))


def _is_odd(values: Sequence[float], belief: Gaussian) -> bool:
    """Whether one of some values is farther from what was believed than the farthest mostly is.

    Of many trials one is farther out than one alone would be (Šidák 1967).
    """
    usual = NormalDist().cdf(_ODD) - NormalDist().cdf(-_ODD)
    most = NormalDist().inv_cdf(0.5 + 0.5 * usual ** (1.0 / len(values)))
    return max(abs(value - belief.mean) for value in values) >= most * belief.sd


def _stated(result: FitResult) -> Iterator[Reason]:
    """What was known beforehand, where the torque or its own steps say otherwise."""
    known = result.problem.settings.knowledge
    for doubt in () if known is None else known.doubts:
        yield against("said", text=doubt)
    for source, made in ({} if known is None else known.statements).items():
        if made.agrees is False:
            label = result.problem.options.anatomy.worded(LABELS[source])
            texts = made.texts
            yield against("disagree", label=label, first=texts[0], second=texts[1])
    contradicted = {} if result.posterior is None else result.posterior.contradicted
    for group, probability in sorted(contradicted.items()):
        label = result.problem.options.anatomy.worded(LABELS[group])
        if probability < RARE:
            scope = Scope.MUSCLES if group == "crosstalk" else Scope.ALL
            yield against("contradicted", grave=probability < _WRONG, scope=scope, label=label)


def _agreement(result: FitResult, r2: float) -> Iterator[Reason]:
    """Several recordings of a leg should follow one set of parameters alike.

    A hold's torque may hardly change: it is held against what the others leave too; in one that is
    strong the same share of the torque is more of it.
    """
    inputs = result.problem.inputs
    residuals = result.residuals
    pairs = list(map(counted, inputs, residuals))
    posterior = result.posterior
    # what a piece of a stride tells by itself is as unsure as what was before it
    long = [each.counted >= TOO_SHORT * each.rate_hz for each in inputs]
    alone = [] if posterior is None else list(compress(posterior.recordings, long))
    name, rare = farthest_apart(alone) if len(alone) > 1 else ("", 1.0)
    if rare < SAID:
        yield against("not-one-leg", name=name)
    yield from foot_moved(() if posterior is None else posterior.mountings)
    usual = float(np.median([np.sqrt(np.mean(e**2)) for _, e in pairs]))
    for recording, pair in zip(inputs, pairs, strict=True):
        r2_of = centred_r2([pair])
        name = recording.name
        grave = r2_of < _NOT_FOLLOWED
        error = float(np.sqrt(np.mean(pair[1] ** 2)))
        if range_moved([recording]) < STILL and len(inputs) > 1:
            if error > _LEAVES * usual and r2_of < r2 - _CONTRADICTS:
                yield against(
                    "hold-not-followed", grave=grave, trial=name, error=error, usual=usual
                )
        elif r2_of < r2 - _CONTRADICTS:
            yield against("trial-not-followed", grave=grave, trial=name, r2=r2_of)


def foot_moved(mountings: Sequence[Mounting]) -> Iterator[Reason]:
    """A foot that lies otherwise in one trial than a strapped foot turns by itself."""
    if mountings and mountings[0].probability < _MOVED:
        farthest = max(mountings, key=lambda each: abs(each.turned) / each.sd)
        half = NORMAL * farthest.sd
        yield against("foot-moved", trial=farthest.trial, turned=abs(farthest.turned), half=half)


def _films(result: FitResult) -> Iterator[Reason]:
    """Trackers drift by 1 to 2 mm: what departs by more is not how the muscle moves."""
    for film in fascicles_of(result):
        away = 1e3 * float(np.std(film.measured - film.modelled))
        if away > _OFF_FILM:
            code = "film-differs" if film.stretch.any() else "film-rigid"
            yield against(code, channel=film.channel, trial=film.recording, away=away)


def _unlike(result: FitResult, odd: Sequence[Reason]) -> Iterator[Reason]:
    """What is told is to hold for the leg as it stays; an odd laboratory hides what muscles do."""
    posterior = result.posterior
    if posterior is None:
        return
    for trial, (size, sd) in zip(result.problem.inputs, posterior.softening, strict=False):
        if size > max(_SOFTENS, _SURE * sd):
            yield against("softened", trial=trial.name, stiffer=100.0 * size)
    if not odd and (left := posterior.sizes.get("misfit", 0.0)) > _UNEXPRESSED:
        yield against("no-model", part=100.0 * left)
