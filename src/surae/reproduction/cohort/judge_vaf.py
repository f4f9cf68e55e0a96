"""The claims on how well models follow and predict the torque: means (3.2.1 to 3.2.5)."""

from collections.abc import Callable, Iterator
from dataclasses import dataclass

from surae.reproduction.claims import Claim, Finding, judged, unchecked
from surae.reproduction.cohort.evidence import (
    Evidence,
    costs,
    described,
    explicit_numbers,
    higher,
    integrator,
    onto_explicit,
)
from surae.reproduction.cohort.results import (
    Fits,
    Point,
    onto_passive,
    validation,
    values,
)
from surae.studies.cohort import ACTIVE_PROTOCOL, FAST_PROTOCOL, PASSIVE_PROTOCOL

_PROTOCOLS = {
    PASSIVE_PROTOCOL: "ramp and hold",
    ACTIVE_PROTOCOL: "multiple holds",
    FAST_PROTOCOL: "multi-sine with holds",
}
#: Why a claim is not checked.
QUICK = "The quick run leaves it out; run all of it."


@dataclass(frozen=True, slots=True)
class _Level:
    """A mean VAF of the thesis [%]; it holds within `within` points."""

    model: str
    protocol: str
    mean: float
    within: float
    source: str
    figure: str
    more: str = ""


_FITS = (
    _Level("1.0", PASSIVE_PROTOCOL, 99.9, 0.5, "3.2.1, Figure 17", "figure-17"),
    _Level("1.0", ACTIVE_PROTOCOL, 95.0, 3.0, "3.2.1, Figure 17", "figure-17", "; ≥ 90"),
    _Level("1.0", FAST_PROTOCOL, 93.0, 3.0, "3.2.1, Figure 17", "figure-17", "; down to 85"),
    _Level("2.0", PASSIVE_PROTOCOL, 99.6, 0.5, "3.2.2, Figure 23", "figure-23", "; all > 99"),
    _Level("2.0", ACTIVE_PROTOCOL, 90.0, 3.0, "3.2.2, Figure 23", "figure-23", "; down to 76"),
    _Level("2.0", FAST_PROTOCOL, 93.0, 3.0, "3.2.2, Figure 23", "figure-23", "; down to 87"),
    _Level("2.1", ACTIVE_PROTOCOL, 94.3, 3.0, "3.2.4, Figure 32", "figure-32"),
    _Level("2.2", ACTIVE_PROTOCOL, 91.7, 3.0, "3.2.5, Figure 32", "figure-32"),
)
_VALIDATIONS = (
    _Level("1.0", ACTIVE_PROTOCOL, 90.4, 5.0, "3.2.3, Figure 29", "figure-29", "; lowest 68"),
    _Level("1.0", FAST_PROTOCOL, 83.1, 5.0, "3.2.3, Figure 29", "figure-29", "; lowest 50"),
    _Level("2.0", ACTIVE_PROTOCOL, 82.6, 5.0, "3.2.3, Figure 29", "figure-29", "; lowest 59"),
    _Level("2.0", FAST_PROTOCOL, 82.0, 5.0, "3.2.3, Figure 29", "figure-29", "; lowest 51"),
    _Level("2.1", ACTIVE_PROTOCOL, 88.5, 5.0, "3.2.4, Figure 35", "figure-35", "; lowest 70"),
    _Level("2.2", ACTIVE_PROTOCOL, 85.4, 5.0, "3.2.5, Figure 35", "figure-35", "; lowest 55"),
)
_ONTO = (
    _Level("1.0", PASSIVE_PROTOCOL, 94.0, 5.0, "3.2.3, Figure 30", "figure-30"),
    _Level("2.0", PASSIVE_PROTOCOL, 90.0, 5.0, "3.2.3, Figure 30", "figure-30"),
)


def thesis_mean(kind: str, model: str, protocol: str) -> float | None:
    """The thesis's mean VAF of ``"fit"``, ``"validation"`` or ``"onto"``; None if it has none."""
    table = {"fit": _FITS, "validation": _VALIDATIONS, "onto": _ONTO}[kind]
    found = (one.mean for one in table if (one.model, one.protocol) == (model, protocol))
    return next(found, None)


def vaf_findings(evidence: Evidence) -> Iterator[Finding]:
    """Each mean that the thesis gives: of fits, of predictions, of predictions of the passive."""
    for one in _FITS:
        yield _level(
            evidence, one, "vaf", "VAF of model {model} on the {protocol}",
            lambda f, level: f.vaf(level.model, level.protocol),
        )  # fmt: skip
    for one in _VALIDATIONS:
        yield _level(
            evidence, one, "validation",
            "VAF of repetitions 2 and 3 of the {protocol}, predicted by model {model} from 1",
            lambda f, level: validation(f, level.model, level.protocol),
        )  # fmt: skip
    for one in _ONTO:
        yield _level(
            evidence, one, "onto",
            "VAF of the {protocol} predicted by model {model} from the multiple holds",
            lambda f, level: onto_passive(f, level.model),
        )  # fmt: skip


def _level(
    evidence: Evidence,
    one: _Level,
    kind: str,
    text: str,
    points: Callable[[Fits, _Level], list[Point]],
) -> Finding:
    claim = Claim(
        name=f"{kind}-{one.model.replace('.', '-')}-{one.protocol}",
        source=one.source,
        text=text.format(model=one.model, protocol=_PROTOCOLS[one.protocol]) + ".",
        number=f"mean {one.mean:g} %{one.more}",
        rule=f"The cohort's mean lies within {one.within:g} points of {one.mean:g} %.",
    )
    found = points(evidence.fits, one)
    if not found:
        return unchecked(claim, QUICK, figure=one.figure)
    mean = float(values(found).mean())
    return judged(
        claim, abs(mean - one.mean) <= one.within, described(found),
        why=_why(evidence, one, kind, mean), figure=one.figure,
    )  # fmt: skip


def _why(evidence: Evidence, one: _Level, kind: str, mean: float) -> str:
    """Refits that say what the difference comes from."""
    texts = []
    if one.model != "1.0":
        texts.append(
            onto_explicit(evidence, one.model)
            if kind == "onto"
            else explicit_numbers(evidence, one.model, one.protocol)
            if kind == "vaf"
            else integrator(evidence, one.model)
        )
    if one.protocol == PASSIVE_PROTOCOL:
        texts.append(costs(evidence, "1.0", PASSIVE_PROTOCOL))
        if kind == "vaf":
            texts.append(
                "The passive torque is small, so that torque noise weighs heavily; a VAF of "
                "99.9 % leaves no room for it in the thesis's recordings."
            )
    elif mean > one.mean:
        texts.append(higher(evidence, one.model, one.protocol))
    else:
        texts.append(costs(evidence, "1.0", ACTIVE_PROTOCOL))
    return " ".join(text for text in texts if text) or QUICK
