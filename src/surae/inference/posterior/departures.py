"""Which departures the data ask for: the evidence of every set of them, and the best solved anew.

All that are common are in first, the sizes of the latents learnt from the data. Rare ones are
looked for one by one. Where errors of the drives are likelier than none, their size is learnt
before the choice, if every muscle has an electrode.
"""

from collections.abc import Mapping, Sequence
from dataclasses import dataclass, replace

import numpy as np

from surae.inference.evidence import Subset, subsets, with_likely
from surae.inference.metres import filmed_paths
from surae.inference.noise import NoiseModel
from surae.inference.posterior.empirical_bayes import (
    BEGIN,
    ERRORS,
    NEARLY_NONE,
    Reached,
    learnt,
    learnt_noise,
    rested,
)
from surae.inference.posterior.family import FIRST_HZ, RATE_HZ, Family
from surae.inference.posterior.log_posterior import LogPosterior, Point
from surae.inference.posterior.look_back import LESS, followed, unless_worse
from surae.inference.posterior.valleys import ROUNDED
from surae.model.laboratory import DEPARTURES, LAWS, RARE, group_of

#: Active state over which it reaches zero at the first rate, of envelopes from elsewhere [N].
_ROUNDED = 12.0
#: Standard deviation of the drives' errors that is weighed against none, where its search begins
#: (a leg with 0.075 asked for none at 0.11, clean raw EMG for some at 0.05); and times the least.
_ERROR = 0.08
_ANY = 1.05
#: What is to be gained in −2 ln p where sets are weighed: weights are not of the path then.
_WEIGHED = 0.01
#: Part of the torque's changes that parameters alone have to follow before: of a model that follows
#: less, what is left is not the EMG's.
_FOLLOWED = 0.8
#: Odds beforehand that a leg or laboratory has a departure.
_ODDS = 0.3
#: Probability from which the joint's spring, of which the ankle's stiffness is made, is in, and a
#: plate beside it, whose weight goes with the angle as the spring does.
_LIKELY = 0.1
#: What a rare departure has to gain in −2 ln Z from one point, very strong evidence (Kass and
#: Raftery, JASA 90 (1995) 773), and the standard deviations by which it has to be there.
_ASKED = 10.0
_MOVED = 3.0
#: Departures beside it, but for these two, from which a rare one is left out: of virtual legs that
#: depart in all ways at once half of what was then called known was false. Not where parameters
#: alone follow the torque better with it by more than the search may lose.
_SEVERAL = 2
_PLAIN = ("reflex", "spring")


@dataclass(frozen=True, slots=True)
class Chosen:
    """The posterior with what the data ask for, and its mode."""

    posterior: LogPosterior
    mode: Point
    sets: tuple[Subset, ...]  #: All sets of departures, the chosen one first.
    names: tuple[str, ...]  #: What their modes are of.
    moved: float  #: How far the last round of the search went, in standard deviations.


def choose(family: Family, values: Mapping[str, float], noise: Sequence[NoiseModel]) -> Chosen:
    """Choose from values without departures, and the noise that they leave."""
    full, point, possible = _with_all(family, values, noise)
    sets = with_likely(_scored(full, point, possible), "spring", "plate", _LIKELY)
    likely = family.like(full, sets[0].groups)
    mode = sets[0].mode
    best = likely.descend(likely.like(full, mode), *point.latents_at(mode), tolerance=0.1)
    names = full.names
    del full, point  # their rows are large
    if likely.fast is None and not family.is_perfect:
        learned = learnt(*_with_noise_of_drives(likely, best), 1)
        likely, best = unless_worse(learned, (likely, best), family.at_rate(RATE_HZ))
    likely, best, moved = rested(likely, best)
    return Chosen(likely, best, sets, names, moved)


def _with_all(
    family: Family, values: Mapping[str, float], noise: Sequence[NoiseModel]
) -> tuple[LogPosterior, Point, tuple[str, ...]]:
    """The posterior with all departures that are to be weighed, its mode, and which they are."""
    possible = family.possible([g for g in DEPARTURES if g not in (*family.known, *RARE)])
    sizes = NEARLY_NONE if family.is_still else BEGIN
    rest = ROUNDED if all(r.own_envelopes for r in family.original.inputs) else _ROUNDED
    post = family.posterior(possible, FIRST_HZ, noise, sizes, rest=rest)
    if post.rectified and not family.is_still:  # what that noise does is no error of the model
        post = post.having(fast=0.0)
    point = post.descend(post.start(values), tolerance=1.0)
    post, point = learnt(post, point, 2, white=True, tolerance=0.3)
    full = family.posterior(possible, RATE_HZ, post.noise, post.sizes)
    full = full.having(fast=post.fast)
    post.observed.forget()
    point = full.descend(full.like(post, point.z), point.c, tolerance=0.3)
    full, point = learnt(full, point, tolerance=_WEIGHED)
    if rare := _rare(family, full, point, possible):
        every = (*possible, *rare)
        more = family.like(full, every)
        there = more.descend(more.like(full, point.z), point.c, point.w, tolerance=0.3)
        more, there = learnt(more, there, tolerance=_WEIGHED)
        beside = {*_scored(more, there, every)[0].groups} - {*rare, *_PLAIN}
        recordings = full.problem.inputs
        gained = followed((more, there), recordings) - followed((full, point), recordings)
        if len(beside) < _SEVERAL or gained > LESS:
            full = more
            point = there
            possible = every
    # which departures there are would hide behind them; what muscles do that no electrode hears is
    # loud under effort as well, and no error of another's EMG
    if not (family.is_still or family.original.has_unheard) and _errs(full, point):
        inputs = family.at_rate(RATE_HZ)
        if followed((full, point), inputs) > _FOLLOWED:
            full, point = unless_worse(_with_errors_of_drives(full, point), (full, point), inputs)
            full, point = learnt(full, point, tolerance=_WEIGHED)
    return full, point, possible


def _scored(post: LogPosterior, point: Point, groups: Sequence[str]) -> tuple[Subset, ...]:
    """All sets of these groups, of one quadratic."""
    positions: dict[str, list[int]] = {group: [] for group in groups}
    off: dict[int, float] = {}
    scored = filmed_paths(post.problem.inputs)  # no departure: a film shows them
    for j, name in enumerate(post.names):
        if name in scored:
            continue
        if name in post.beliefs and (group := group_of(name)) in positions:
            positions[group].append(j)
            off[j] = post.beliefs[name].off
    return subsets(post.laplace(point), positions, off, odds=dict.fromkeys(groups, _ODDS))


def _rare(
    family: Family, full: LogPosterior, point: Point, groups: tuple[str, ...]
) -> tuple[str, ...]:
    """Rare departures that the data ask for, each alone beside these, from one point."""
    there = family.possible(RARE)
    more = family.like(full, (*groups, *there))
    z = more.like(full, point.z)
    of = [group_of(name) for name in more.names]
    for j, name in enumerate(more.names):
        z[j] = more.beliefs[name].off if of[j] in there else z[j]
    sets = {s.groups: s for s in _scored(more, more.again(replace(point, z=z)), there)}
    gained = {}
    for group in there:
        alone = sets[group,]
        at = [j for j, each in enumerate(of) if each == group]
        if np.any(alone.mode[at] - z[at] > _MOVED * np.sqrt(alone.variance[at])):
            gained[group] = sets[()].evidence - alone.evidence
    asked = sorted((g for g in gained if gained[g] > _ASKED), key=lambda g: -gained[g])
    laws = [group for group in asked if group in LAWS]
    return tuple(group for group in asked if group not in laws[1:])


def _with_noise_of_drives(post: LogPosterior, point: Point) -> Reached:
    """The posterior in which drives have the noise of their envelopes, and its mode."""
    if post.fast is not None:
        return post, point
    post = post.having(fast=0.0)
    return post, post.descend(point.z, point.c, tolerance=0.1)


def _errs(post: LogPosterior, point: Point) -> bool:
    """Whether errors of the drives are likelier than their noise alone, as this point has it."""
    none = post if post.fast is not None else post.having(fast=0.0)
    there = none.again(replace(point, w=point.w if none is post else none.expected()))
    some = none.with_errors(_ERROR)
    return some.evidence(some.again(there)) < none.evidence(there)


def _with_errors_of_drives(begun: LogPosterior, point: Point) -> Reached:
    """The errors of the drives, at the muscles' frequencies as great as the data ask for."""
    post, there = _with_noise_of_drives(begun, point)
    # the evidence of each is with white noise that it leaves itself
    quiet = post.having(noise=learnt_noise(post, there, white=True, anew=True))
    at = quiet.descend(there.z, there.c, there.w, evaluations=8, tolerance=0.1)
    quiet = quiet.having(noise=learnt_noise(quiet, at, white=True, anew=True))
    none = quiet.evidence(quiet.again(at))
    # slow latents begin anew, for they have followed what is fast
    some = begun.having(fast=_ERROR, sizes=BEGIN)
    some, where = learnt(some, some.descend(point.z, tolerance=0.3), tolerance=0.1)
    # errors of the least size are none: theirs is another prior, of noise that is known
    there_are = (some.fast or 0.0) > _ANY * ERRORS[0] and some.evidence(where) < none
    return (some, where) if there_are else (post, there)
