"""What a source of uncertainty is: a record, also for distributions that bring one of their own."""

import math
from collections.abc import Mapping
from dataclasses import dataclass, field
from typing import Literal, NamedTuple

from surae.base.frozen import FrozenDict
from surae.model.parameter import Parameter

#: Part of the variance by what two trials share that differs between them: it shifts estimates
#: otherwise where movement and effort differ. Set on twelve virtual legs (decision 16).
SHARED = 0.15


class Fill(NamedTuple):
    """How a source is drawn: a colour of the palette and a hatch; together they are its own."""

    colour: Literal["surface", "measured", "ink", "series-1", "series-2", "series-3", "series-6"]
    hatch: Literal["", "/", "\\", "x", "-", "|", "+", "."] = ""


@dataclass(frozen=True, slots=True)
class Gaussian:
    """The prior of a nuisance."""

    #: `mean`, `sd`: in the parameter's unit.
    mean: float
    sd: float
    off: float = 0.0  #: The value at which there is no such nuisance.

    def on_logarithm(self) -> "Gaussian":
        """That of the logarithm which has the same mean and standard deviation."""
        spread = math.sqrt(math.log1p((self.sd / self.mean) ** 2))
        return Gaussian(math.log(self.mean) - 0.5 * spread**2, spread)


@dataclass(frozen=True, slots=True)
class Nuisance:
    """The parameters that a source is estimated by; in a model as a whole or not at all."""

    group: str  #: Its name in `nuisances`.
    parameters: tuple[str, ...]
    prior: Gaussian
    unit: str  #: What the prior is in, for readers.
    because: str  #: Where the prior comes from.
    #: What makes it another: the next trial, or electrodes and foot mounted anew.
    anew: Literal["never", "trial", "mounting"] = "never"
    of_leg: bool = False  #: Whether it belongs to the leg, and not to what measures it.
    #: Whether it is of a device that holds the foot: torques of inverse dynamics have none.
    of_device: bool = False
    #: Priors of single parameters that differ from `prior`.
    prior_of: Mapping[str, Gaussian] = field(default_factory=FrozenDict)
    #: Priors where the geometry is the person's own, see `geometry_of` of a fit.
    measured: Mapping[str, Gaussian] = field(default_factory=FrozenDict)
    departs: bool = False  #: Whether it is in the model only where the data ask for it.
    rare: bool = False  #: Whether it is looked for by itself before it is weighed with all others.


@dataclass(frozen=True, slots=True)
class UncertaintySource:
    """One source of uncertainty."""

    name: str  #: In FIT.json.
    label: str  #: What reports and the workbench call it.
    meaning: str  #: What it is.
    advice: str  #: What would make it smaller, an imperative within a sentence.
    look: Fill
    nuisance: Nuisance | None = None  #: None where nothing is estimated for it.
    leg: tuple[str, ...] = ()  #: Parameters of the leg whose ignorance is this source, too.
    fresh: bool = False  #: Whether another trial has it anew, though no nuisance stands for it.
    #: Parts of its variance that another trial has anew, and another mounting of electrodes and
    #: foot, where these are known.
    again: tuple[float, float] | None = None
    #: Whether it can be known, so that the budget says how narrow an interval then is.
    knowable: bool = True
    again_by: str = ""  #: `advice` where one statement alone is there: a second one.
    #: Parameters that a plugin adds to models for it, each the factor of a torque (`Added`).
    adds: tuple[Parameter, ...] = ()

    @property
    def parameters(self) -> tuple[str, ...]:
        """All parameters that it is made of."""
        return (*self.leg, *(self.nuisance.parameters if self.nuisance else ()))

    @property
    def anew(self) -> float:
        """Part of its variance that another trial of the leg has anew."""
        return self.anew_when(mounted=False)

    def anew_when(self, *, mounted: bool) -> float:
        """Part of its variance that another trial has anew, electrodes and foot mounted or not."""
        if self.again is not None:
            return self.again[mounted]
        when = self.nuisance.anew if self.nuisance else "trial" if self.fresh else "never"
        if when == "trial" or (mounted and when == "mounting"):
            return 1.0
        return SHARED
