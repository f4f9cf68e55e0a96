"""Rigid or elastic: what a comparison of models on the same data found, as plain data."""

from collections.abc import Mapping, Sequence
from dataclasses import dataclass
from enum import StrEnum

from surae.assessment.adequacy import Adequacy
from surae.assessment.comparison.held_out import HeldOut
from surae.estimation import FitSettings
from surae.frozen import Comparable
from surae.records import Saved


class TendonEvidence(StrEnum):
    """What the data say of the tendons."""

    RIGID = "rigid-suffices"
    COMPLIANT = "compliance-supported"
    OPEN = "cannot-tell"


@dataclass(frozen=True, slots=True, eq=False)
class ModelScore(Comparable):
    """One model on the data."""

    #: `model`, `title`: its name, and what it is called in tables.
    model: str
    title: str
    rigid: bool  #: Whether it is without tendons.
    #: `status`, `message`: of its fit to all data.
    status: str
    message: str
    at_bound: tuple[str, ...]  #: Estimated parameters that lie at a bound.
    n_free: int  #: Estimated parameters.
    #: `vaf`, `rmse`: of its fit to all data [%, Nm]; None where the model gave no finite torque.
    vaf: float | None
    rmse: float | None
    #: `aicc`, `aicc_plain`: Akaike's criterion with the effective number of samples, and with the
    #: nominal one; None where the samples are too few for the parameters, or the fit failed.
    aicc: float | None
    aicc_plain: float | None
    #: `delta`, `delta_plain`: how much worse than the best of the models.
    delta: float | None
    delta_plain: float | None
    held_out: HeldOut | None  #: Prediction of data it was not fitted to.
    held_out_note: str  #: Why there is none; else empty.
    values: Mapping[str, float]  #: All its parameters, fitted to all data.
    adequacy: Adequacy  #: Whether that fit is good enough for a comparison to mean something.


def best_of(scores: Sequence[ModelScore], *, rigid: bool) -> ModelScore | None:
    """The rigid, or compliant, model with the lowest AICc; None where none of them has one."""
    best: ModelScore | None = None
    for score in scores:
        if score.rigid is not rigid or score.aicc is None:
            continue
        if best is None or best.aicc is None or score.aicc < best.aicc:
            best = score
    return best


@dataclass(frozen=True, slots=True)
class ParameterChange:
    """A parameter that a compliant model estimates otherwise than the rigid one."""

    #: `model`, `parameter`, `unit`: the compliant model, and the parameter both share.
    model: str
    parameter: str
    unit: str
    #: `rigid`, `compliant`: the two estimates.
    rigid: float
    compliant: float
    percent: float | None  #: Change from the rigid model's estimate [%]; None where that is zero.
    #: Half the width of the wider of the two 95 % intervals; the change exceeds it.
    half_width: float


@dataclass(frozen=True, slots=True, eq=False)
class Comparison(Comparable, Saved):
    """Models on the same data, and what follows for the tendons.

    Attributes
    ----------
    finding : TendonEvidence or None
        None while the comparison is not complete.
    conclusion : str
        The finding in one or two plain sentences, with its figures.
    rule : str
        How the finding follows from the figures.
    cautions : tuple of str
        What weakens it, one sentence each.
    models : tuple of ModelScore
        Every model whose fit to all data was completed.
    changes : tuple of ParameterChange
        Parameters that matter to whoever took the rigid model's, the largest change first.
    missing : tuple of str
        What was not done, as the user stopped it.
    recordings : tuple of str
        What was fitted.
    n : int
        Samples that count.
    n_effective : float or None
        Independent samples they are worth, from the residual of the model with the best plain AICc.
    scheme : str
        How data were held out.
    folds : tuple of str
        What was left out in turn.
    settings : FitSettings
        What every model was asked, as far as it has the parameters.
    seconds : float
        Wall time.
    versions : mapping of str to str
        Versions of surae and of what its numbers depend on.
    """

    finding: TendonEvidence | None
    conclusion: str
    rule: str
    cautions: tuple[str, ...]
    models: tuple[ModelScore, ...]
    changes: tuple[ParameterChange, ...]
    missing: tuple[str, ...]
    recordings: tuple[str, ...]
    n: int
    n_effective: float | None
    scheme: str
    folds: tuple[str, ...]
    settings: FitSettings
    seconds: float
    versions: Mapping[str, str]

    @property
    def scores(self) -> dict[str, ModelScore]:
        """The models by name."""
        return {score.model: score for score in self.models}

    @property
    def compliant(self) -> ModelScore | None:
        """The best muscle-tendon model, which the conclusion is about."""
        return best_of(self.models, rigid=False)
