"""What is claimed of a perturbed leg: whether a reflex is there, and which numbers stand."""

from collections.abc import Mapping
from dataclasses import dataclass, field, replace

from surae.base.words import N_, Message
from surae.nerve.cascade import BOUNDS
from surae.nerve.fitting import Fitted
from surae.nerve.identify import Cascade
from surae.nerve.judged import Number
from surae.nerve.other_structures import MISFIT
from surae.nerve.perturbed_records import ReflexPath
from surae.nerve.presence import LEAST_SHARE, NATS, NONE_SEEN, OVER_NONE, OVER_OTHER, Weighed
from surae.nerve.samples import Samples
from surae.nerve.yielding import BLURRED, DEVICE_YIELDS, LEG_DRIVES, TOO_FREE, TOO_MUCH, Loop

#: Of directions of movement, by their sign.
DIRECTIONS = {1: "dorsiflexion", -1: "plantarflexion"}
#: By how many of its deviations torque may stay behind at its ends: of 24 legs (qa to qj) at most
#: 0.08; 0.3 to 0.9 where a fifth of it or more was limited, and then filtered.
BEHIND = 0.15


def judged(
    weighed: Weighed,
    share: Number,
    fitted: Fitted,
    direction: int,
    samples: Samples,
    unseen: tuple[float, float],
) -> ReflexPath:
    """The verdict on a reflex, by what it predicts: never by its size alone."""
    word = DIRECTIONS[direction]
    if samples.one_sided:
        return ReflexPath(
            "cannot tell", None, Message(N_("the foot moved fast in one direction only"))
        )
    bounds = {"delay", "threshold"} & set(fitted.at_bound)
    at_bound = {n for n in bounds if n == "delay" or fitted.values["threshold"] > 0.5}
    better = (
        weighed.over_none > OVER_NONE and weighed.over_other > OVER_OTHER and weighed.nats > NATS
    )
    if better and share.value >= LEAST_SHARE and not at_bound:
        why = Message(
            N_(
                "a reflex to {way} predicts torque that was not fitted better than "
                "none (z = {none:.1f}) and than the other direction (z = {other:.1f})"
            ),
            way=Message(word),
            none=weighed.over_none,
            other=weighed.over_other,
        )
        return ReflexPath("present", word, why)  # type: ignore[arg-type]
    if unseen[0] < NONE_SEEN and not better:
        return ReflexPath(
            "none seen",
            None,
            Message(
                N_("a reflex makes at most {most:.2g} % of the torque’s variance"), most=unseen[0]
            ),
        )
    if better:
        if share.value < LEAST_SHARE:
            but = N_("something answers stretch to {way}, but its share is below half a percent")
        elif "delay" in at_bound:
            but = N_(
                "something answers stretch to {way}, but its delay lies at the end of its range"
            )
        else:
            but = N_(
                "something answers stretch to {way}, but its threshold lies at the end of its range"
            )
        return ReflexPath("cannot tell", None, Message(but, way=Message(word)))
    return ReflexPath(
        "cannot tell",
        None,
        Message(
            N_(
                "neither direction predicts torque that was not fitted better (z = "
                "{none:.1f} over none, {other:.1f} over the other), and up to "
                "{most:.2g} % of the variance may be a reflex’s"
            ),
            none=weighed.over_none,
            other=weighed.over_other,
            most=unseen[0],
        ),
    )


@dataclass(frozen=True, slots=True)
class Claimed:
    """What is claimed of a leg."""

    reflex: ReflexPath
    numbers: Mapping[str, Number]  #: Of measures; those of a reflex only where one is present.
    hidden: Mapping[str, tuple[float, float]]  #: What a reflex may have that is not seen.
    why: Message  #: Why what has no number has none.
    #: Why a number that could be estimated is not told, by its name.
    refused: Mapping[str, Message] = field(default_factory=dict)


def in_loop(claims: Claimed, loop: Loop, cascade: Cascade) -> Claimed:
    """What is claimed where the leg may move its device: nothing that both make together."""
    driven = cascade.numbers["intrinsic_viscosity"].high < 0.0
    if driven or not loop.told:
        why = Message(LEG_DRIVES if driven else DEVICE_YIELDS)
        return Claimed(ReflexPath("cannot tell", None, why), {}, {}, why)
    if not loop.yields:
        return claims
    why = Message(TOO_MUCH, part=100.0 * loop.free)
    numbers = {
        name: loop.widened(number)
        for name, number in claims.numbers.items()
        if not name.startswith("reflex_")
    }
    hides = claims.reflex.verdict == "none seen" and BLURRED * cascade.unseen[0] > NONE_SEEN
    if loop.free > TOO_FREE or hides:
        return Claimed(ReflexPath("cannot tell", None, why), numbers, {}, why)
    return replace(claims, numbers=numbers, hidden={}, why=why)


def claimed(cascade: Cascade, reflex: ReflexPath, behind: float) -> Claimed:
    """What is claimed, where the torque stays `behind` by a part of its largest."""
    numbers = cascade.numbers
    below = [n for n in ("intrinsic_stiffness", "inertia") if numbers[n].value <= 0.0]
    if below:  # the search lost its way, or the torque's sign is wrong: nothing is claimed
        ended = N_(
            "the fit ended at inertia below zero, which no leg has: look at the torque’s sign"
        )
        if below[0] != "inertia":
            ended = N_(
                "the fit ended at stiffness below zero, which no leg has: look at the torque’s sign"
            )
        why = Message(ended)
        return Claimed(ReflexPath("cannot tell", None, why), {}, {}, why)
    if behind > BEHIND:
        numbers = {name: number.allowing(behind) for name, number in numbers.items()}
    if reflex.verdict != "present" and (behind > BEHIND or cascade.misfit > MISFIT):
        doubt = N_(
            "the equations miss something that the torque shows, maybe a reflex of another kind"
        )
        if behind > BEHIND:
            doubt = N_("the torque stays behind at its largest")
        reflex = ReflexPath("cannot tell", None, Message(doubt))
        none = N_("no reflex is claimed ({verdict})")
        return Claimed(reflex, numbers, {}, Message(none, verdict=Message(reflex.verdict)))
    hidden = {
        "reflex_share": (0.0, cascade.unseen[0]),
        "reflex_gain": (0.0, cascade.unseen[1]),
        "reflex_delay": (1e3 * BOUNDS["delay"][0], 1e3 * BOUNDS["delay"][1]),
    }
    none = N_("no reflex is claimed ({verdict}); the interval is what one may have unseen")
    return Claimed(reflex, numbers, hidden, Message(none, verdict=Message(reflex.verdict)))
