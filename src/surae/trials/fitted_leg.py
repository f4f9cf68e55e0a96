"""A leg whose trials were fitted: what came of each and of all together, as its page shows it."""

from collections.abc import Mapping
from dataclasses import dataclass, field

from surae.base.frozen import FrozenDict
from surae.inference import AssessedFit, Assessment
from surae.nerve.leg import Nerve
from surae.quality import Quality
from surae.settings import FitSettings
from surae.trials.strength import Effort
from surae.trials.trial_set import Crossed, TrialSet


@dataclass(frozen=True, slots=True)
class FittedLeg:
    """What came of the trials of a leg."""

    session: TrialSet  #: Its trials; of a result read from a folder without their signals.
    settings: FitSettings  #: Of every fit.
    fits: Mapping[str, AssessedFit] = field(default_factory=FrozenDict)  #: By trial.
    joint: AssessedFit | None = None  #: Of all trials in `joined` together.
    joined: tuple[str, ...] = ()
    #: Trials without a fit, and fits that were left out of the joint one: why. ``"joint"``: why
    #: there is none.
    failed: Mapping[str, str] = field(default_factory=FrozenDict)
    #: What was found in each trial.
    quality: Mapping[str, Quality] = field(default_factory=FrozenDict)
    #: How the fit of a trial (the first name) follows another.
    predictions: Mapping[str, Mapping[str, Crossed]] = field(default_factory=FrozenDict)
    #: How the joint fit follows each trial.
    joint_predictions: Mapping[str, Crossed] = field(default_factory=FrozenDict)
    interrupted: bool = False  #: Whether the user stopped it.
    #: What slow and fast stretches and perturbations say of reflexes; None without such trials.
    nerve: Nerve | None = None
    #: Efforts of the trials of maximal effort.
    maximal_efforts: tuple[Effort, ...] = ()

    def __post_init__(self) -> None:
        """Make the mappings read-only."""
        for name in ("fits", "failed", "quality", "joint_predictions"):
            object.__setattr__(self, name, FrozenDict(getattr(self, name)))
        crossed = {name: FrozenDict(row) for name, row in self.predictions.items()}
        object.__setattr__(self, "predictions", FrozenDict(crossed))

    @property
    def alone(self) -> dict[str, Assessment]:
        """What each trial's own fit is worth."""
        return {trial: fit.assessment for trial, fit in self.fits.items()}

    @property
    def together(self) -> Assessment | None:
        """What the joint fit is worth."""
        return None if self.joint is None else self.joint.assessment

    @property
    def main(self) -> AssessedFit | None:
        """The fit that stands for the leg: that of all together, or the only one."""
        return self.joint or (next(iter(self.fits.values())) if len(self.fits) == 1 else None)
