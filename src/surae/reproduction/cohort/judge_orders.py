"""The claims on how well models follow and predict the torque: comparisons (3.2.1 to 3.2.5)."""

from collections.abc import Callable, Iterator

import numpy as np

from surae.reproduction.claims import Claim, Finding, judged, unchecked
from surae.reproduction.cohort.evidence import (
    Evidence,
    costs,
    described,
    integrator,
    onto_explicit,
)
from surae.reproduction.cohort.judge_vaf import QUICK
from surae.reproduction.cohort.results import (
    Point,
    clearly_lower,
    onto_passive,
    paired,
    validation,
    values,
)
from surae.studies.cohort import ACTIVE_PROTOCOL, FAST_PROTOCOL, PASSIVE_PROTOCOL
from surae.units import FloatArray


def order_findings(evidence: Evidence) -> Iterator[Finding]:
    """What follows or predicts the torque better than what."""
    fits, holds, fast, passive = evidence.fits, ACTIVE_PROTOCOL, FAST_PROTOCOL, PASSIVE_PROTOCOL
    scheme = integrator(evidence) or QUICK

    yield _ordered(
        "passive-followed-best", "3.2.1, Figure 17",
        "Model 1.0 follows the passive ramp and hold better than the active protocols.",
        "99.9 % over 95 and 93 %", "The mean VAF of the ramp and hold is the highest of the three.",
        [fits.vaf("1.0", p) for p in (passive, holds, fast)],
        lambda a, b, c: values(a).mean() > max(values(b).mean(), values(c).mean()),
        costs(evidence, "1.0", passive), "figure-17",
    )  # fmt: skip
    yield _change(
        "tendon-fits-worse", "3.2.2, Figures 17 and 23",
        "With set tendon parameters, model 2.0 follows the multiple holds less well than 1.0.",
        "90 % against 95 %", "The median over recordings of VAF(2.0) − VAF(1.0) is negative.",
        paired(fits.vaf("1.0", holds), fits.vaf("2.0", holds)), lambda d: d < 0.0,
        scheme, "figure-23",
    )  # fmt: skip
    yield _change(
        "tendon-same-on-multi-sine", "3.2.2, 4.2, Figures 17 and 23",
        "On the multi-sine with holds, models 1.0 and 2.0 are similar.",
        "93 % both", "The median over recordings of VAF(2.0) − VAF(1.0) is within ±1 point.",
        paired(fits.vaf("1.0", fast), fits.vaf("2.0", fast)), lambda d: abs(d) <= 1.0,
        scheme, "figure-23",
    )  # fmt: skip
    for model, what, number in (("2.1", "strain", "94.3"), ("2.2", "toe force", "91.7")):
        yield _change(
            f"free-{what.replace(' ', '-')}-fits-better", "3.2.4, 3.2.5, Figure 32",
            f"Freeing the tendon's {what} raises the VAF on the multiple holds.",
            f"{number} % against 90 %",
            f"The median over recordings of VAF({model}) − VAF(2.0) is positive.",
            paired(fits.vaf("2.0", holds), fits.vaf(model, holds)), lambda d: d > 0.0,
            scheme, "figure-32",
        )  # fmt: skip
    yield _change(
        "strain-over-toe", "4.2.2, Figure 32",
        "Freeing the strain fits better than freeing the toe force.", "94.3 % against 91.7 %",
        "The median over recordings of VAF(2.1) − VAF(2.2) is positive.",
        paired(fits.vaf("2.2", holds), fits.vaf("2.1", holds)), lambda d: d > 0.0,
        scheme, "figure-32",
    )  # fmt: skip
    yield _change(
        "strain-equals-muscle", "4.2.2, Figures 17 and 32",
        "Model 2.1 follows the multiple holds as well as model 1.0.", "94.3 % against 95 %",
        "The median over recordings of VAF(2.1) − VAF(1.0) is within ±1 point.",
        paired(fits.vaf("1.0", holds), fits.vaf("2.1", holds)), lambda d: abs(d) <= 1.0,
        scheme, "figure-32",
    )  # fmt: skip
    yield _remarked(evidence)
    yield _ordered(
        "prediction-below-fit", "3.2.3, Figure 29",
        "Predicted repetitions have a lower VAF than fitted ones.", "90.4 % against 95 % (1.0)",
        "Model 1.0, multiple holds: the mean VAF of predictions is below that of fits.",
        [validation(fits, "1.0", holds), fits.vaf("1.0", holds)],
        lambda a, b: values(a).mean() < values(b).mean(), costs(evidence, "1.0", holds),
        "figure-29",
    )  # fmt: skip
    yield _change(
        "muscle-predicts-better", "3.2.3, Figure 29",
        "Model 1.0 predicts the other repetitions of the multiple holds better than 2.0.",
        "90.4 % against 82.6 %", "The median over predictions of VAF(2.0) − VAF(1.0) is negative.",
        paired(validation(fits, "1.0", holds), validation(fits, "2.0", holds)), lambda d: d < 0.0,
        scheme, "figure-29",
    )  # fmt: skip
    yield _ordered(
        "multi-sine-predicted-worse", "3.2.3, Figure 29",
        "Model 1.0 predicts the multi-sine with holds less well than the multiple holds.",
        "83.1 % against 90.4 %",
        "The mean VAF of predictions is lower, by more than twice the standard error.",
        [validation(fits, "1.0", fast), validation(fits, "1.0", holds)],
        clearly_lower, _who_completed(evidence), "figure-29",
    )  # fmt: skip
    for model, what in (("2.1", "strain"), ("2.2", "toe force")):
        yield _change(
            f"free-{what.replace(' ', '-')}-predicts-better", "4.2, Figures 29 and 35",
            f"Freeing the tendon's {what} makes predictions better.",
            f"{'88.5' if model == '2.1' else '85.4'} % against 82.6 %",
            f"The median over predictions of VAF({model}) − VAF(2.0) is positive.",
            paired(validation(fits, "2.0", holds), validation(fits, model, holds)),
            lambda d: d > 0.0, scheme, "figure-35",
        )  # fmt: skip
    yield _change(
        "muscle-predicts-passive-better", "3.2.3, Figure 30",
        "From the multiple holds, model 1.0 predicts the ramp and hold better than 2.0.",
        "94 % against 90 %", "The median over predictions of VAF(2.0) − VAF(1.0) is negative.",
        paired(onto_passive(fits, "1.0"), onto_passive(fits, "2.0")), lambda d: d < 0.0,
        " ".join([onto_explicit(evidence, "2.0"), costs(evidence, "1.0", passive)]), "figure-30",
    )  # fmt: skip


def _ordered(
    name: str, source: str, text: str, number: str, rule: str, points: list[list[Point]],
    holds: Callable[..., bool], why: str, figure: str,
) -> Finding:  # fmt: skip
    claim = Claim(name=name, source=source, text=text, number=number, rule=rule)
    if not all(points):
        return unchecked(claim, QUICK, figure=figure)
    ours = " against ".join(described(one) for one in points)
    return judged(claim, bool(holds(*points)), ours, why=why, figure=figure)


def _change(
    name: str, source: str, text: str, number: str, rule: str, change: FloatArray,
    holds: Callable[[float], bool], why: str, figure: str,
) -> Finding:  # fmt: skip
    claim = Claim(name=name, source=source, text=text, number=number, rule=rule)
    if not len(change):
        return unchecked(claim, QUICK, figure=figure)
    middle, share = float(np.median(change)), float(np.mean(change < 0.0))
    ours = (
        f"{middle:+.2f} points (median), {change.mean():+.2f} (mean); negative in "
        f"{100 * share:.0f} % of {len(change)}"
    )
    return judged(claim, holds(middle), ours, why=why, figure=figure)


def _remarked(evidence: Evidence) -> Finding:
    """Whether low VAFs are those of subjects with a remark."""
    claim = Claim(
        name="outliers-are-misaligned-or-twisted",
        source="4.2.1, Figure 17",
        text="Low VAFs are of subjects whose knee moved or whose ankle was misaligned.",
        number="the outliers of Figure 17",
        rule="Model 1.0, multiple holds: the mean VAF of these subjects is below the others', by "
        "more than twice the standard error of the difference.",
    )
    noted = {member.id for member in evidence.fits.members if member.remarks}
    points = evidence.fits.vaf("1.0", ACTIVE_PROTOCOL)
    some = [p for p in points if p.subject in noted]
    others = [p for p in points if p.subject not in noted]
    if not some or not others:
        return unchecked(claim, QUICK, figure="figure-17")
    return judged(
        claim,
        clearly_lower(some, others),
        f"{described(some, 2)} against {described(others, 2)}",
        why=costs(evidence, "1.0", ACTIVE_PROTOCOL),
        figure="figure-17",
    )


def _who_completed(evidence: Evidence) -> str:
    """Who did the third protocol, and whether the two protocols differ within these subjects."""
    fast = {p.subject for p in evidence.fits.vaf("1.0", FAST_PROTOCOL)}
    noted = sum(bool(m.remarks) for m in evidence.fits.members if m.id in fast)
    same = [p for p in validation(evidence.fits, "1.0", ACTIVE_PROTOCOL) if p.subject in fast]
    return (
        f"{len(fast)} subjects completed it, {noted} of them with a moving knee or a misaligned "
        "ankle, which the thesis names as the reason of its low values (two of its seven). The "
        f"same subjects' multiple holds are predicted with {described(same)}."
    )
