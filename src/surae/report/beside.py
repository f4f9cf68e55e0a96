"""A prediction beside what knows no muscle: which was better, and what follows."""

from collections.abc import Sequence

from surae.base.formatting import listed, percentage
from surae.inference import Prediction
from surae.inference.judging.baselines import OWN

#: Share of the variance [%] by which one must be better to be called so.
_BETTER = 0.5
TEMPLATE = "the mean of the other recordings at the same phase"
RIDGE = "a ridge regression on angle, speed and EMG"


def beside(p: Prediction) -> str:
    """A sentence or two; empty where there is nothing to compare with, or it was not asked.

    Parameters
    ----------
    p : Prediction
        With its baselines.

    Returns
    -------
    str
        Shares of the variance, why one is missing, which was better, and what follows.
    """
    of = p.baselines
    if of.template_reason == OWN or (of.best is None and not of.template_reason):
        return ""
    pairs = [(TEMPLATE, of.template, of.template_reason), (RIDGE, of.ridge, of.ridge_reason)]
    known = [f"{name} {percentage(share)} %" for name, share, _ in pairs if share is not None]
    if p.simplest_vaf is not None:
        known.append(f"the muscle model without departures {percentage(p.simplest_vaf)} %")
    missing = [f"{name}: none, as {why}" for name, share, why in pairs if share is None and why]
    said = f"VAF of others: {', '.join([*known, *missing])}."
    return f"{said} {follows([p])}" if known else said


def of_movement(predictions: Sequence[Prediction]) -> str:
    """That a movement is another one, and what was done; empty where none is."""
    other = [p for p in predictions if p.simplest]
    if not other:
        return ""
    shares = listed([f"{100 * p.simplest:.0f} % of {p.name!r}" for p in other])
    return (
        "Angle and speed scatter otherwise than in the fit, which is of inverse dynamics and not "
        "adequate: what it explains of one movement need not be so in another. Its torque is "
        f"averaged with that of the muscle model without departures ({shares})."
    )


def follows(predictions: Sequence[Prediction]) -> str:
    """What follows of predictions beside those that know no muscle; empty without any."""
    compared = [p for p in predictions if p.baselines.best is not None]
    if not compared:
        return ""
    worse = [p for p in compared if (p.baselines.best or 0.0) > p.vaf - _BETTER]
    if not worse:
        return (
            f"The model is better ({_shares(compared)}): it knows what these do not. That its "
            "torque is right does not make each of its parameters right."
        )
    if len(worse) < len(compared):
        names = listed([repr(p.name) for p in worse])
        return (
            f"Of {names} a prediction without a model is as good or better: that the torque is "
            "predicted is no evidence of the parameters there."
        )
    return (
        f"A prediction without a model is as good or better ({_shares(compared)}): that the torque "
        "is predicted is no evidence of the parameters."
    )


def _shares(predictions: Sequence[Prediction]) -> str:
    """The model's share and that of the best without one, of each."""
    pairs = [(p.vaf, p.baselines.best or 0.0) for p in predictions]
    return ", ".join(f"{percentage(vaf)} % against {percentage(best)} %" for vaf, best in pairs)
