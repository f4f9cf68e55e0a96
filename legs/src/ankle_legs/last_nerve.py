"""Perturbed and stretched legs for the last count alone. Who makes an estimate does not open it."""

from __future__ import annotations

from dataclasses import replace

import numpy as np

from ankle_legs import perturbed, stretched
from ankle_legs.joint import Intrinsic, Reflex
from ankle_legs.perturbed import Ankle, Family
from ankle_legs.stretched import Stretches

LAW = dict.fromkeys(("reflex_gain",), "no one gain on the velocity makes this reflex")
AMPLITUDE = dict.fromkeys(
    ("intrinsic_stiffness", "intrinsic_viscosity"), "it depends on the movement's size"
)


def _own(a: Ankle, **changed: float) -> Ankle:
    return replace(a, own=replace(a.own, **changed))


def _each(a: Ankle, **changed: float) -> tuple[Reflex, ...]:
    return tuple(replace(r, **changed) for r in a.reflexes)


def two_branches(rng: np.random.Generator, a: Ankle) -> Ankle:
    """Stiffness relaxes in two times, as tissue with a spectrum does (Fung 1993)."""
    a = perturbed.relaxing(rng, a)
    return _own(
        a,
        branch_2=a.own.stiffness * float(rng.uniform(0.1, 0.3)),
        seconds_2=float(rng.uniform(0.04, 0.12)),
    )


def bridges(rng: np.random.Generator, a: Ankle) -> Ankle:
    """Bridges hold and yield: stiffness falls with the size of the movement (Kearney 1982)."""
    a = _own(
        a,
        hold=a.own.stiffness * float(rng.uniform(0.15, 0.5)),
        reach=float(rng.uniform(4e-3, 0.012)),
    )
    return replace(a, unscored=AMPLITUDE)


def spindles(rng: np.random.Generator, a: Ankle) -> Ankle:
    """Spindles answer with a power of the velocity, and more where stretched (Houk et al. 1981)."""
    power, slope = float(rng.uniform(0.4, 0.7)), float(rng.uniform(0, 15))
    return replace(a, reflexes=_each(a, power=power, slope=slope), unscored=LAW)


def saturating(rng: np.random.Generator, a: Ankle) -> Ankle:
    """The reflex saturates, and the tissue relaxes."""
    a = perturbed.relaxing(rng, a)
    return replace(a, reflexes=_each(a, ceiling=float(rng.uniform(0.5, 1.2))), unscored=LAW)


def both(rng: np.random.Generator, a: Ankle) -> Ankle:
    """Calf and tibialis both answer."""
    weak = float(rng.uniform(0.3, 0.7))
    pair = tuple(
        r
        for one in a.reflexes
        for r in (replace(one, gain=1.0), replace(one, gain=weak, sign=-one.sign))
    )
    return replace(a, reflexes=pair)


def tiring(rng: np.random.Generator, a: Ankle) -> Ankle:
    """The reflex fades as it is repeated, and stiffness changes with it."""
    return replace(perturbed.changing(rng, a), fading=float(rng.uniform(0.2, 0.6)))


def thinning(rng: np.random.Generator, a: Ankle) -> Ankle:
    """Viscosity falls with speed, as muscle's does."""
    a = _own(a, drag=float(rng.uniform(0.3, 1.0)))
    return replace(a, unscored={"intrinsic_viscosity": "it depends on speed"})


def restless(rng: np.random.Generator, a: Ankle) -> Ankle:
    """A person who interferes: bursts of effort, tremor, drift."""
    a = replace(a, bursts=int(rng.integers(3, 8)), tremor=float(rng.uniform(0.05, 0.2)))
    return replace(a, drift=3 * a.drift)


def filtered(rng: np.random.Generator, a: Ankle) -> Ankle:
    """The torque cell is filtered low and late, the tissue relaxes, the motor yields."""
    a = perturbed.yielding(rng, perturbed.relaxing(rng, a))
    how = {"late": float(rng.uniform(0, 0.004)), "cutoff": float(rng.uniform(40, 70))}
    return replace(a, channels=replace(a.channels, **how))


def small(rng: np.random.Generator, a: Ankle) -> Ankle:
    """Movements are small and coarsely measured, the stiffness is bent."""
    a = perturbed.bent(rng, perturbed.coarse(rng, a))
    return replace(a, amplitude=float(rng.uniform(0.012, 0.02)))


def slack(rng: np.random.Generator, a: Ankle) -> Ankle:
    """A relaxed ankle: soft, well damped, with a light foot on a heavy sensor."""
    k, sensor = float(rng.uniform(12, 30)), float(rng.uniform(0.01, 0.03))
    viscosity = float(rng.uniform(0.4, 1.0))
    return replace(a, own=Intrinsic(a.foot + sensor, viscosity, k), noise=0.5 * a.noise)


KINDS: tuple[Family, ...] = (
    *(spindles, restless, two_branches, small, both, filtered, bridges, slack),
    *(tiring, saturating, thinning),
)


def _pair(rng: np.random.Generator, a: Ankle) -> Ankle:
    first, second = rng.permutation(len(KINDS))[:2]
    a = KINDS[first](rng, a)
    known = a.unscored
    a = KINDS[second](rng, a)
    return replace(a, unscored={**known, **a.unscored})


PERTURBED: dict[str, Family] = {
    f"ql-{i}": kind for i, kind in enumerate((*KINDS, perturbed.mixed, _pair), start=1)
}


def _tissue(s: Stretches, **changed: float) -> Stretches:
    return replace(s, tissue=replace(s.tissue, **changed))


def _answer(s: Stretches, **changed: float) -> Stretches:
    return replace(s, answer=replace(s.answer, **changed))


def clonic(rng: np.random.Generator, s: Stretches) -> Stretches:
    """Beats of 5.5 Hz follow the stretch."""
    return _answer(stretched.tonic(rng, s), clonus=float(rng.uniform(0.4, 0.8)))


def gripping(rng: np.random.Generator, s: Stretches) -> Stretches:
    """Still tissue holds before it yields (thixotropy)."""
    return _tissue(s, grip=float(rng.uniform(0.4, 1.5)))


def thin(rng: np.random.Generator, s: Stretches) -> Stretches:
    """Viscous torque grows less than the speed."""
    return _tissue(s, power=float(rng.uniform(0.35, 0.7)), viscosity=float(rng.uniform(0.4, 0.9)))


def rooted(rng: np.random.Generator, s: Stretches) -> Stretches:
    """The threshold falls with a root of the velocity: no straight line over it."""
    root = float(rng.uniform(0.5, 0.75))
    same = s.answer.falls * s.speeds[-1] ** (1 - root)
    return _answer(s, root=root, falls=same)


def answering(rng: np.random.Generator, s: Stretches) -> Stretches:
    """The person answers most stretches, after a reaction time."""
    return _answer(s, late=float(rng.uniform(1, 4)))


def habituating(rng: np.random.Generator, s: Stretches) -> Stretches:
    """The reflex fades over the session, the tissue softens."""
    s = _tissue(s, softening=float(rng.uniform(0.15, 0.35)))
    return _answer(s, habit=float(rng.uniform(0.2, 0.5)))


def poor_electrodes(rng: np.random.Generator, s: Stretches) -> Stretches:
    """EMG clips, is small beside its rest, and the tibialis's electrode hears the calf."""
    return replace(
        s,
        volts=float(rng.uniform(4e-6, 1e-5)),
        clip=float(rng.uniform(4e-5, 1.2e-4)),
        crosstalk=0.3,
    )


def deaf(rng: np.random.Generator, s: Stretches) -> Stretches:
    """No EMG, and no reflex: tissue that is stiff, viscous and relaxes slowly or fast."""
    s = stretched.quiet(rng, stretched.stiff(rng, s))
    return replace(
        _tissue(s, relaxes=float(rng.uniform(0.3, 0.6)), seconds=float(rng.uniform(0.08, 0.4))),
        emg="none",
    )


STRETCHED: dict[str, stretched.Family] = {
    f"sl-{i}": kind
    for i, kind in enumerate(
        (
            answering,
            thin,
            poor_electrodes,
            clonic,
            rooted,
            gripping,
            deaf,
            habituating,
            stretched.any_of_these,
        ),
        start=1,
    )
}
