"""Other structures than the chosen one, and what they say of every number and its interval."""

from collections.abc import Iterator, Mapping
from dataclasses import dataclass, field, replace
from typing import Literal

import numpy as np

from surae.base.words import N_, Message
from surae.nerve.cascade import Structure
from surae.nerve.fitting import Fitted, Noise, Problem
from surae.nerve.judged import INTRINSIC, REFLEX, Judged, Number, Of, share

#: Sums of whitened squares by which a structure must be better to be taken in (z of 4 or 3), and
#: by which one that is worse is still possible (z of 2).
BETTER = 8.0
POSSIBLE = 4.5
#: The same, of a structure with more in it: what chance gains by two parameters.
CHANCE = 2.0
#: z of the gain of responses without equations, from which the equations miss something.
MISFIT = 5.0
#: Length that a reflex may answer beside velocity [1/s]: in sines of 0.3, 0.8 and 2 Hz both then
#: weigh alike.
LENGTHS = (2.0, 5.0, 12.0)
#: Thresholds at which a reflex is held [rad/s]: gain trades off with them, and not in a line.
BEYOND = (0.0, 0.1, 0.2, 0.35, 0.5)
PLAIN = Structure(N_("inertia, viscosity, stiffness"))
RELAXING = Structure(N_("tissue that relaxes (Zener)"), 1)
TWO = Structure(N_("tissue that relaxes at two rates"), 2)
#: Filters of the torque's channel, by their order.
_FILTERS = (
    N_("a torque channel without a filter"),
    N_("a torque channel with one pole"),
    N_("a torque channel with two poles"),
)

#: How another structure counts in an interval; see `OtherStructures`.
Counts = Literal["whole", "shifted", "value"]


@dataclass(frozen=True, slots=True)
class OtherStructures:
    """Numbers with what other structures say in their intervals, and the stiffness of each.

    Simpler ones that describe the torque about as well count with their intervals, richer ones that
    describe it better than chance by their values with the interval of the chosen one: their own is
    endless where a branch is hardly seen. Where the equations are known to miss something, good
    description no longer tells which is true: then named ones count by their values alone.

    True equations give the same numbers however frequencies are weighed: by what they differ from
    those of equal weights, beyond chance, every number may be wrong to both sides (Hausman 1978).
    """

    problem: Problem
    chosen: Fitted
    numbers: Mapping[str, Number]  #: Of the chosen structure.
    rival: Fitted  #: With a reflex where there is none, and the other way round.
    misfit: float  #: z of what responses without equations explain beyond the equations.
    widened: dict[str, Number] = field(default_factory=dict)  #: Numbers, wider by each rival.
    stiffness: dict[str, Number] = field(default_factory=dict)  #: Of each that counts, by its name.

    def weighed(self) -> tuple[dict[str, Number], dict[str, Number]]:
        """All of them weighed: the numbers, and the stiffness of each structure that counts."""
        self.widened.update(self.numbers)
        self.stiffness[self.chosen.structure.name] = self.numbers["intrinsic_stiffness"]
        self._structures()
        if self.chosen.structure.direction:
            self._reflexes()
        else:
            again = self.problem.fit(self.rival.structure, self.rival.values)
            if self._gain(again) > CHANCE and again.values["gain"] > 0.0:
                self._admit(again, N_("with a reflex that is not shown"), "whole")
        self._weights()
        return self.widened, self.stiffness

    def _gain(self, fitted: Fitted) -> float:
        """By how much another describes the torque better."""
        return self.chosen.loss - fitted.loss

    def _structures(self) -> None:
        """Simpler and richer structures."""
        chosen = self.chosen.structure
        for structure, label in _others(chosen):
            fitted = self.problem.fit(structure, self.chosen.values)
            more = len(structure.names) - len(chosen.names)
            if more <= 0 and self._gain(fitted) > -POSSIBLE:
                self._admit(fitted, label, "whole")
            elif more > 0 and self._gain(fitted) > CHANCE * more / 2:
                self._admit(fitted, label, "shifted")
            elif self.misfit > MISFIT and structure.branches:
                self._admit(fitted, label, "value")

    def _reflexes(self) -> None:
        """Reflexes that begin at other velocities, or answer something else than velocity."""
        for beyond in BEYOND:
            held = replace(self.chosen.structure, threshold=False, beyond=beyond)
            fitted = self.problem.fit(held, self.chosen.values)
            if self._gain(fitted) > -POSSIBLE:
                speed = np.rad2deg(beyond)
                label = Message(N_("a reflex beyond {speed:.0f} °/s"), speed=speed)
                self._admit(fitted, label, "value")
        for fitted, law in _other_laws(self.problem, self.chosen):
            if self._gain(fitted) > -POSSIBLE:
                self._admit(fitted, law, "shifted")
            elif self.misfit > MISFIT:
                self._admit(fitted, law, "value")

    def _weights(self) -> None:
        """The chosen structure with all frequencies weighed alike."""
        noise = self.problem.noise
        alike = Problem(self.problem.pieces, Noise(noise.f, noise.f**2))
        again = alike.fit(self.chosen.structure, self.chosen.values)
        judged = Judged(alike, again)
        if self.misfit > MISFIT:
            self._admit(again, N_("all frequencies weighed alike"), "value", judged)
        computed = self._computed()
        for name, number in self.numbers.items():
            other = judged.number(name, computed[name])
            apart = abs(other.value - number.value)
            chance = 0.5 * (other.high - other.low)
            beyond = float(np.sqrt(max(apart**2 - chance**2, 0.0)))
            part = beyond / max(abs(number.value), 1e-12)
            self.widened[name] = self.widened[name].allowing(part)

    def _computed(self) -> dict[str, Of]:
        """How every number is computed, those of a reflex too."""
        return INTRINSIC | REFLEX | {"reflex_share": lambda f: share(self.problem.pieces, f)}

    def _admit(
        self, fitted: Fitted, label: str, counts: Counts, judged: Judged | None = None
    ) -> None:
        """Take what another structure says into the intervals."""
        judged = judged or Judged(self.problem, fitted)
        for name, of in self._comparable(fitted).items():
            other = judged.number(name, of)
            half = self.numbers[name].high - self.numbers[name].value
            low, high = {
                "whole": (other.low, other.high),
                "shifted": (other.value - half, other.value + half),
                "value": (other.value, other.value),
            }[counts]
            self.widened[name] = self.widened[name].with_(low, high)
            if name == "intrinsic_stiffness":
                self.stiffness[label] = Number(other.value, low, high)

    def _comparable(self, fitted: Fitted) -> Mapping[str, Of]:
        """The numbers that mean the same in another structure."""
        tables: Mapping[str, Of] = INTRINSIC
        if fitted.structure.direction and self.chosen.structure.direction:
            tables = self._computed()
            if not fitted.structure.threshold:
                tables = {name: of for name, of in tables.items() if name != "reflex_threshold"}
                at = float(np.rad2deg(fitted.structure.beyond))
                threshold = self.widened["reflex_threshold"]
                self.widened["reflex_threshold"] = threshold.with_(at, at)
        # a slow branch that is hardly seen is viscosity of another frequency
        if fitted.structure.branches > 1 and self._gain(fitted) < BETTER:
            tables = {"intrinsic_stiffness": INTRINSIC["intrinsic_stiffness"]}
        return tables


def _others(chosen: Structure) -> Iterator[tuple[Structure, str]]:
    """Structures that differ from a chosen one by one thing, and what they are called."""
    for branches, name in enumerate((PLAIN.name, RELAXING.name, TWO.name)):
        if branches != chosen.branches and branches - chosen.branches < 2:
            yield replace(chosen, branches=branches, name=name), name
    yield replace(chosen, late=False), N_("torque that is not late")
    for order, label in enumerate(_FILTERS):
        if order != chosen.order:
            yield replace(chosen, order=order), label
    if chosen.direction:
        yield replace(chosen, third=True), N_("a reflex of third order")


def _other_laws(problem: Problem, chosen: Fitted) -> list[tuple[Fitted, str]]:
    """The same with a reflex to velocity and length, and with one to force."""
    structure = chosen.structure
    v = chosen.values
    lengths = [problem.fit(replace(structure, length=each), v) for each in LENGTHS]
    lead = v["viscosity"] / max(v["stiffness"], 1e-9)
    return [
        (min(lengths, key=lambda fitted: fitted.loss), N_("a reflex to velocity and length")),
        (problem.fit(replace(structure, lead=max(lead, 0.0)), v), N_("a reflex to force")),
    ]
