"""What all trials of a leg together show of each electrode: what a trial is judged against.

Whether an electrode lives, a muscle rests or a spike matters is a question of levels, and skin,
amplifier and unit make these anything. A relaxed trial beside one with effort says which level is
rest and which is effort; a trial alone is judged against itself.
"""

from collections.abc import Iterable, Mapping
from dataclasses import dataclass, replace

import numpy as np

from surae.base.frozen import FrozenDict
from surae.base.units import FloatArray
from surae.quality.numeric import quantiles, smooth
from surae.recording import Recording

#: Where an envelope is judged by its level, it is averaged over this [s]: rectified noise then
#: varies by some 15 % and a burst of one second is still seen.
SLOW = 0.2
#: Largest over lowest level of a muscle whose activity varies; rectified noise alone has 1.6.
VARIES = 3.0
#: Largest over lowest level up to which a channel is of one strength: noise has 1.6.
ONE_STRENGTH = 2.0
#: An electrode whose largest level is below this part of the strongest's is without contact:
#: muscles of one leg differ by a factor of ten at most.
SILENT = 0.01
#: Activity as a part of the largest of the leg's trials that a relaxed muscle stays below.
RELAXED = 0.06
#: Standard deviation of Gaussian noise over its mean size.
RMS = float(np.sqrt(np.pi / 2.0))


@dataclass(frozen=True, slots=True)
class Electrode:
    """Levels of one electrode in all trials of a leg, in the unit of its channel."""

    rest: float  #: Lowest level of a trial that it exceeds in nearly all of the time.
    top: float  #: Largest level of a trial that it exceeds in 2 % of the time.
    peak: float  #: Distance from the channel's median that 1 % of a trial's samples exceed.
    trials: int = 1  #: In how many trials it is not constant.

    @property
    def works(self) -> bool:
        """Whether it has shown a muscle that was active and at rest."""
        return self.top >= VARIES * self.rest and self.top > 0.0

    def beside(self, other: "Electrode") -> "Electrode":
        """The same with what other trials show."""
        return Electrode(
            min(self.rest, other.rest),
            max(self.top, other.top),
            max(self.peak, other.peak),
            self.trials + other.trials,
        )


@dataclass(frozen=True, slots=True)
class Electrodes:
    """What is known of every electrode of a leg."""

    levels: Mapping[str, Electrode]  #: By muscle; of those that are constant in all trials none.
    trials: int = 1  #: How many trials were looked at.

    def __post_init__(self) -> None:
        """Make the mapping read-only."""
        object.__setattr__(self, "levels", FrozenDict(self.levels))

    @property
    def strongest(self) -> float:
        """Largest level of any electrode."""
        return max((each.top for each in self.levels.values()), default=0.0)

    def works(self, muscle: str) -> bool:
        """Whether an electrode has shown its muscle's effort in some trial."""
        level = self.levels.get(muscle)
        return level is not None and level.works and level.top >= SILENT * self.strongest

    def rests(self, muscle: str, top: float) -> bool:
        """Whether a muscle is relaxed in a trial in which its level comes up to `top`."""
        level = self.levels[muscle]
        return not self.works(muscle) or top < max(RELAXED * level.top, VARIES * level.rest)

    def in_units(self, before: Recording, after: Recording) -> "Electrodes":
        """The same for a recording of which channels were brought to other units."""
        levels = dict(self.levels)
        for muscle, level in levels.items():
            pair = [of.channels.get(f"emg_{muscle}") for of in (before, after)]
            was, now = (0.0 if each is None else float(np.ptp(each.values)) for each in pair)
            if 0.0 < was != now:
                rest, top, peak = (now / was * each for each in (level.rest, level.top, level.peak))
                levels[muscle] = replace(level, rest=rest, top=top, peak=peak)
        return replace(self, levels=levels)


def electrodes_of(
    recording: Recording, envelopes: Mapping[str, FloatArray], rate: float
) -> Electrodes:
    """What one recording shows of its electrodes, by envelopes of their muscles at a rate [Hz]."""
    levels = {}
    for muscle, envelope in envelopes.items():
        slow = smooth(envelope, round(SLOW * rate))
        values = recording.channels[f"emg_{muscle}"].values
        low, middle, high = quantiles(values, 0.01, 0.5, 0.99)
        rest, top = quantiles(slow, 0.05, 0.98)
        levels[muscle] = Electrode(rest, top, max(high - middle, middle - low))
    return Electrodes(levels)


def together(trials: Iterable[Electrodes]) -> Electrodes | None:
    """What several trials of a leg show of its electrodes; None of none."""
    every = list(trials)
    levels: dict[str, Electrode] = {}
    for trial in every:
        for muscle, level in trial.levels.items():
            levels[muscle] = level.beside(levels[muscle]) if muscle in levels else level
    return Electrodes(levels, len(every)) if every else None
