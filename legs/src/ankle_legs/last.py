"""Families for the last count alone. Who makes or tunes an estimate does not open this file.

Sizes are what physiology and laboratories report; each class names its source. The numbers of the
families tell nothing, so that a table of scores does not either.
"""

from __future__ import annotations

from dataclasses import dataclass
from typing import ClassVar

import numpy as np
from numba import njit

from ankle_legs import look
from ankle_legs.leg import Departure, Draw, Run, between, drawn
from ankle_legs.look import FORCE_PER_VOLT, STRONGEST
from ankle_legs.muscle import Array, Muscle, integrate

BANDWIDTH = dict.fromkeys(("f0", "beta"), "no one second-order filter makes this activation")
Departures = tuple[Departure, ...]


@njit(cache=True)
def _gripped(x: Array, reach: float) -> Array:
    """Return Dahl's friction state of a course: it follows x and yields at +-reach."""
    state = np.zeros(x.size)
    for i in range(1, x.size):
        d = x[i] - x[i - 1]
        state[i] = (state[i - 1] + d) / (1 + abs(d) / reach)
    return state


@njit(cache=True)
def _chased(x: Array, rise: float, fall: float) -> Array:
    """Return x after a lag of first order that is another upwards than downwards [steps]."""
    out = x.copy()
    for i in range(1, x.size):
        lag = rise if x[i] > out[i - 1] else fall
        out[i] = out[i - 1] + (x[i] - out[i - 1]) / (1 + lag)
    return out


@njit(cache=True)
def _worked(x: Array, active: Array, forget: float) -> Array:
    """Return the stretch since activity began; it is forgotten at rest [steps]."""
    state = np.zeros(x.size)
    for i in range(1, x.size):
        kept = state[i - 1] * (1 - (1 - active[i]) / forget)
        state[i] = kept + active[i] * (x[i] - x[i - 1])
    return state


@njit(cache=True)
def _bonds(x: Array, rebuild: float, breaking: float) -> Array:
    """Return the share of resting bonds: movement breaks them, stillness rebuilds them [steps]."""
    state = np.ones(x.size)
    for i in range(1, x.size):
        torn = abs(x[i] - x[i - 1]) / breaking
        state[i] = (state[i - 1] + 1 / rebuild) / (1 + 1 / rebuild + torn)
    return state


def _course(rng: np.random.Generator, run: Run, every: float) -> Array:
    """Return a smooth random course with an sd of about one, a new value each ``every`` seconds."""
    knots = np.arange(0, run.times[-1] + 2 * every, every)
    return np.interp(run.times, knots, rng.normal(size=knots.size))


@dataclass(frozen=True)
class Sigmoid(Departure):
    """Force rises steeply, then saturates over EMG (Woods and Bigland-Ritchie 1983)."""

    unscored: ClassVar[dict[str, str]] = FORCE_PER_VOLT
    steepness: Array = between(1.2, 1.9, 4, none=None)
    half: Array = between(0.5, 1.0, 4, none=None)
    share: float = between(1, 1)

    def excite(self, run: Run) -> None:
        peak = np.maximum(run.excitation.max(axis=1), 50)
        for i in range(4):
            u, n, c = run.excitation[i] / peak[i], self.steepness[i], self.half[i]
            bent = u**n * (1 + c**n) / (u**n + c**n)
            run.excitation[i] = peak[i] * (self.share * bent + (1 - self.share) * u)


@dataclass(frozen=True)
class History(Departure):
    """Force is enhanced after active stretch, depressed after shortening (Herzog 2004)."""

    loops: ClassVar[bool] = True
    unscored: ClassVar[dict[str, str]] = STRONGEST
    enhanced: float = between(0.5, 1.2)  # share of force per stretch of l0
    depressed: float = between(0.4, 0.9)

    def load(self, run: Run) -> None:
        if not run.active.any():
            return
        for i, muscle in enumerate(run.subject.muscles()):
            active = np.clip(run.active[i] / (0.1 * run.active[i].max() + 1e-9), 0, 1)
            stretch = _worked(run.length[i], active, 0.4 / run.step) / muscle.l0
            effect = np.where(stretch > 0, self.enhanced, self.depressed) * stretch
            run.gain[i] *= np.clip(1 + effect, 0.7, 1.3)


@dataclass(frozen=True)
class Fatigue(Departure):
    """The same EMG makes less force as work goes on (Bigland-Ritchie et al. 1986)."""

    unscored: ClassVar[dict[str, str]] = FORCE_PER_VOLT
    loss: Array = between(
        0.15, 0.35, 2
    )  # by the trial's end, per group of ta and of the three others

    def excite(self, run: Run) -> None:
        for rows, loss in ((slice(0, 1), self.loss[0]), (slice(1, 4), self.loss[1])):
            dose = np.cumsum(run.effort[rows].sum(axis=0))
            dose /= max(dose[-1], 1e-9)
            run.excitation[rows] = run.excitation[rows] * (1 - loss * -np.expm1(-2 * dose) / 0.865)


@dataclass(frozen=True)
class Shift(Departure):
    """An electrode comes loose: what it shows jumps, once or twice."""

    unscored: ClassVar[dict[str, str]] = FORCE_PER_VOLT
    size: float = between(0.2, 0.45)  # of the jump's logarithm

    def measure(self, run: Run) -> None:
        for i in run.rng.permutation(4)[: run.rng.integers(1, 4)]:
            at, sign = run.rng.uniform(0.25, 0.75) * run.times[-1], run.rng.choice([-1, 1])
            run.seen[i] *= np.exp(sign * self.size * np.clip((run.times - at) / 0.2, 0, 1))


@dataclass(frozen=True)
class Skin(Departure):
    """The muscle slides under its electrode: amplitude depends on the angle (Farina 2006)."""

    unscored: ClassVar[dict[str, str]] = FORCE_PER_VOLT
    sizes: Array = between(0.1, 0.25, 4, signed=True)  # at the ends of the range

    def measure(self, run: Run) -> None:
        low, high = run.subject.range
        run.seen *= 1 + self.sizes[:, None] * (2 * (run.ankle - low) / (high - low) - 1)


@dataclass(frozen=True)
class Thixotropy(Departure):
    """After rest a passive muscle resists its first stretch (Proske et al. 1993)."""

    unscored: ClassVar[dict[str, str]] = {"dissipated_energy": "it depends on rest before"}
    force: float = between(20, 60)  # of the triceps; the tibialis has 0.4 of it [N]
    reach: float = between(0.0008, 0.002, none=None)  # of path at which bonds yield [m]
    rebuild: float = between(2, 6, none=None)  # [s]

    def load(self, run: Run) -> None:
        for i, size in enumerate((self.force, 0.4 * self.force)):
            bonds = _bonds(run.path[i], self.rebuild / run.step, 3 * self.reach)
            run.extra[i] += size * bonds * _gripped(run.path[i], self.reach) / self.reach


@dataclass(frozen=True)
class LoadedArm(Departure):
    """Moment arms grow as the muscle pulls (Maganaris et al. 1998, 1999)."""

    loops: ClassVar[bool] = True
    unscored: ClassVar[dict[str, str]] = STRONGEST
    sizes: Array = between(0.1, 0.3, 2)  # at the leg's largest force

    def load(self, run: Run) -> None:
        for i, size in enumerate(self.sizes):
            largest = run.subject.torque[i] / run.arm[i].mean()
            run.arm[i] = run.arm[i] * (1 + size * np.minimum(run.force[i] / largest, 1.3))


@dataclass(frozen=True)
class Silent(Departure):
    """Deep flexors and toe extensors have no electrode and pull along, not quite in step."""

    unscored: ClassVar[dict[str, str]] = STRONGEST | dict.fromkeys(
        ("g1", "g2", "g3", "g4"), "muscles without an electrode pull with these"
    )
    shares: Array = between(0.06, 0.14, 2)  # of the group's largest torque

    def measure(self, run: Run) -> None:
        one, rng = np.ones(run.times.size), run.rng
        levels = (run.effort[1:].sum(axis=0), run.effort[0])
        for i, (level, share) in enumerate(zip(levels, self.shares, strict=True)):
            course = np.clip(1 + 0.5 * _course(rng, run, 2.0), 0, 2)
            alone = np.clip(_course(rng, run, 1.5) - 1.0, 0, 1) * np.any(level)
            drive = run.delayed(level * course + 0.5 * alone, run.mounting.delay)
            muscle = Muscle(1.0, 9.0, 2.0, 0.3, rng.uniform(0.045, 0.055), 2.5, 1.0)
            path = 0.05 + (0.025, -0.03)[i] * run.ankle
            force = integrate(run.step, path, drive, one, 0 * one, muscle.constants())[1]
            run.torque += (1, -1)[i] * share * run.subject.torque[i] * force


@dataclass(frozen=True)
class Skew(Departure):
    """The EMG amplifier's clock is its own: it drifts, or loses a packet."""

    seconds: float = between(0.02, 0.06, signed=True)  # by the trial's end
    lost: float = between(0, 1, none=None)

    def measure(self, run: Run) -> None:
        u = run.times / run.times[-1]
        late = self.seconds * (u > run.rng.uniform(0.3, 0.7) if self.lost < 0.4 else u)
        run.seen = np.array([np.interp(run.times - late, run.times, row) for row in run.seen])


@dataclass(frozen=True)
class Slip(Departure):
    """The heel creeps in its strap and comes back late: compliance with hysteresis."""

    loops: ClassVar[bool] = True
    springs: float = between(0.5, 1.5)  # at the leg's common torque [deg]
    slips: float = between(1.0, 2.5)
    yields: float = between(8, 20, none=None)  # [Nm]

    def turn(self, run: Run) -> None:
        held = _gripped(run.torque, self.yields) / self.yields
        bend = self.slips * held + self.springs * run.torque / (0.7 * run.subject.torque[0])
        run.ankle = run.ankle - np.radians(run.lagged(bend, 0.04))


@dataclass(frozen=True)
class Knee(Departure):
    """The knee gives as the triceps pulls, and drifts: the gastrocnemius slackens."""

    loops: ClassVar[bool] = True
    unscored: ClassVar[dict[str, str]] = (
        STRONGEST
        | {"slack": "the knee moves it"}
        | dict.fromkeys(
            ("passive", "end", "torque_rise", "quick", "neutral", "optim"), "the knee moves it"
        )
    )
    bend: float = between(4, 10)  # at the leg's largest force [deg]
    drift: float = between(-6, 6)

    def load(self, run: Run) -> None:
        largest = run.subject.torque[0] / run.arm[0].mean()
        knee = self.bend * run.force[0] / largest + self.drift * run.times / run.times[-1]
        run.path[0] -= 0.45 * 0.025 * np.radians(knee)


@dataclass(frozen=True)
class Optimum(Departure):
    """The optimal length is longer at low activation (Rack and Westbury 1969)."""

    loops: ClassVar[bool] = True
    unscored: ClassVar[dict[str, str]] = STRONGEST | dict.fromkeys(
        ("l0_tri", "l0_tib"), "the optimal length depends on activation"
    )
    size: float = between(0.08, 0.18)

    def load(self, run: Run) -> None:
        if not run.active.any():
            return
        for i, muscle in enumerate(run.subject.muscles()):
            level = np.clip(run.active[i] / max(run.active[i].max(), 50.0), 0, 1)
            best = muscle.l0 * (1 + self.size * (1 - level))
            width = np.where(run.length[i] < muscle.l0, muscle.short_width, muscle.long_width)
            there, then = (run.length[i] - best) ** 2, (run.length[i] - muscle.l0) ** 2
            run.gain[i] *= np.clip(np.exp((then - there) / (width * muscle.l0**2)), 0.2, 3)


@dataclass(frozen=True)
class Lingering(Departure):
    """Muscles let go more slowly than they take hold (Zajac 1989)."""

    unscored: ClassVar[dict[str, str]] = BANDWIDTH
    rise: float = between(0.01, 0.025)  # [s]
    fall: float = between(0.05, 0.1)

    def excite(self, run: Run) -> None:
        steps = (self.rise / run.step, self.fall / run.step)
        run.excitation = np.array([_chased(row, *steps) for row in run.excitation])


@dataclass(frozen=True)
class Creep(Departure):
    """Passive tissue relaxes over a wide spectrum of times (Fung 1993)."""

    loops: ClassVar[bool] = True
    unscored: ClassVar[dict[str, str]] = dict.fromkeys(
        ("tau_rel", "k_rel"), "the passive muscle relaxes in several times"
    )
    sizes: Array = between(0.1, 0.3, 2)
    quick: float = between(0.15, 0.4, none=None)  # [s]
    slow: float = between(15, 40, none=None)

    def load(self, run: Run) -> None:
        if not run.length.any():
            return
        for i, muscle in enumerate(run.subject.muscles()):
            elastic = np.exp(muscle.k * (run.length[i] - muscle.x0)) / (1 + muscle.k_rel)
            for size, seconds in zip(self.sizes, (self.quick, self.slow), strict=True):
                run.extra[i] += size * (elastic - run.lagged(elastic, seconds))


@dataclass(frozen=True)
class Recruitment(Departure):
    """From burst to burst other parts of a muscle work than those under its electrode."""

    unscored: ClassVar[dict[str, str]] = FORCE_PER_VOLT
    size: float = between(0.1, 0.2)
    every: float = between(1, 2, none=None)  # [s]

    def excite(self, run: Run) -> None:
        for i in range(4):
            levels = run.rng.normal(size=int(run.times[-1] / self.every) + 2)
            held = levels[(run.times / self.every).astype(int)]
            factor = np.exp(self.size * run.lagged(held, 0.1))
            run.excitation[i] = run.excitation[i] * factor


@dataclass(frozen=True)
class Wander(Departure):
    """The torque sensor warms up, effort trembles, cables are pulled."""

    wander: float = between(0.5, 1.5)  # [Nm]
    tremor: float = between(0.005, 0.02)  # share of the active torque
    pulled: float = between(1e-4, 3e-4)  # [V]

    def measure(self, run: Run) -> None:
        course = _course(run.rng, run, 5.0)
        phase = 2 * np.pi * np.cumsum(9.5 + _course(run.rng, run, 0.5)) * run.step
        size = self.tremor * run.subject.torque[0] * run.effort.sum(axis=0)
        run.torque += self.wander * course + size * np.sin(phase)
        for at in run.rng.uniform(2, run.times[-1] - 2, 5):
            width = run.rng.uniform(0.05, 0.2)
            bump = np.exp(-(((run.times - at) / width) ** 2))
            run.seen[run.rng.integers(4)] += self.pulled * bump


@dataclass(frozen=True)
class Backlash(Departure):
    """Gears have play, and the torque cell has hysteresis."""

    play: float = between(0.4, 1.2)  # half of it [deg]
    hysteresis: float = between(0.01, 0.02)  # share of the torque's range

    def turn(self, run: Run) -> None:
        run.ankle = run.ankle - self.play / 2 * _gripped(run.plate, np.radians(2.0))

    def measure(self, run: Run) -> None:
        span = float(np.ptp(run.torque))
        run.torque += self.hysteresis * span * _gripped(run.torque, span / 6) / (span / 6)


SINGLE = (
    *(Slip, Sigmoid, Lingering, Silent, Thixotropy, Skin, History, Recruitment, Knee, Fatigue),
    *(LoadedArm, Backlash, Creep, Shift, Optimum, Wander, Skew),
)


def _some(rng: np.random.Generator, n: int, low: float, high: float) -> Departures:
    """Draw n kinds at random strengths."""
    chosen = rng.permutation(len(SINGLE))[:n]
    return tuple(d for i in chosen for d in drawn(SINGLE[i])(rng, rng.uniform(low, high)))


def _with_look(rng: np.random.Generator, s: float) -> Departures:
    """Draw one kind and one of those that one may look at."""
    kinds = [look.FAMILIES[name] for name in "bcdefghj"]
    chosen = kinds[rng.integers(len(kinds))]
    return (*chosen(rng, s * float(rng.uniform(0.5, 1))), *_some(rng, 1, 0.5, 1.0))


@dataclass(frozen=True)
class Ligament(Departure):
    """Ligaments and capsule stiffen exponentially towards both ends (Riener and Edrich 1999)."""

    torque: float = between(0.6, 2.0)  # at the end of the leg's range [Nm]
    steepness: float = between(4, 9, none=None)  # [1/rad]
    other: float = between(0.2, 0.8, none=None)  # share of it at the other end
    damping: float = between(0, 0.15)  # [Nm s/rad]
    ends: ClassVar[tuple[float, float]] = (-0.75, 0.45)

    def rest(self, angle: Array) -> Array:
        up = np.exp(self.steepness * (angle - self.ends[1]))
        down = np.exp(-self.steepness * (angle - self.ends[0]))
        return np.asarray(self.torque * (up - self.other * down))

    def resist(self, angle: Array, step: float) -> Array:
        return self.rest(angle) + self.damping * np.gradient(angle, step)


@dataclass(frozen=True)
class Friction(Departure):
    """The hinge rubs: dry friction that yields within a degree."""

    size: float = between(0.3, 1.2)  # [Nm]
    reach: float = between(0.004, 0.015, none=None)  # [rad]

    def resist(self, angle: Array, step: float) -> Array:
        del step
        return self.size * _gripped(angle, self.reach) / self.reach


@dataclass(frozen=True)
class Swapped(Departure):
    """Two cables are swapped."""

    unscored: ClassVar[dict[str, str]] = FORCE_PER_VOLT
    which: float = between(0, 3, none=None)

    def measure(self, run: Run) -> None:
        i, j = ((1, 2), (2, 3), (0, 3))[int(self.which)]
        run.seen[[i, j]] = run.seen[[j, i]]


@dataclass(frozen=True)
class Heads(Departure):
    """The calf's heads have optimal lengths of their own (Ward et al. 2009)."""

    loops: ClassVar[bool] = True
    unscored: ClassVar[dict[str, str]] = STRONGEST | {"l0_tri": "each head has its own"}
    apart: float = between(0.1, 0.2)  # of the optimal length, between the heads

    def load(self, run: Run) -> None:
        if not run.length.any():
            return
        muscle = run.subject.muscles()[0]
        x, width = run.length[0] / muscle.l0, muscle.short_width

        def lift(best: float) -> Array:
            return np.asarray(np.exp(-((x - best) ** 2) / width))

        both = 0.55 * lift(1 - 0.45 * self.apart) + 0.45 * lift(1 + 0.55 * self.apart)
        run.gain[0] *= np.clip(both / lift(1.0), 0.2, 3)


NEW = (
    *(look.Spring, look.Damper, look.Zero, look.Softening, look.Lag, look.Poor, look.Pennate),
    *(look.Reclined, Ligament, Friction, Swapped, Heads),
)


def _two_new(rng: np.random.Generator, _: float) -> Departures:
    """Draw two kinds; what shows through sensors comes last."""
    chosen = sorted(rng.permutation(len(NEW))[:2].tolist())
    return tuple(d for i in chosen for d in drawn(NEW[i])(rng, rng.uniform(0.5, 1.0)))


MORE: tuple[Draw, ...] = (
    drawn(Friction),
    drawn(look.Zero, look.Softening),
    drawn(Ligament),
    drawn(look.Spring, look.Damper, look.Untared),
    drawn(look.Lag, look.Poor),
    drawn(look.Pennate, Heads),
    drawn(Swapped),
    _two_new,
)
MIXED: tuple[Draw, ...] = (
    lambda rng, _: _some(rng, 2, 0.4, 1.0),
    lambda rng, _: _some(rng, 4, 0.3, 0.5),
    _with_look,
)
FAMILIES: dict[str, Draw] = {
    f"l-{i}": draw for i, draw in enumerate((*(drawn(kind) for kind in SINGLE), *MIXED), start=1)
}
FAMILIES |= {f"l-{len(FAMILIES) + i}": draw for i, draw in enumerate(MORE, start=1)}
