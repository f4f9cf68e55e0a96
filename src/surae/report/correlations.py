"""The correlation of the estimates in words."""

from dataclasses import dataclass

from surae.assessment import Assessment
from surae.report.formatting import NO_NUMBER, signed, significant

#: Correlation from which a pair of parameters is named.
_STRONG = 0.9
#: Pairs that are named at most.
_PAIRS = 6


@dataclass(frozen=True, slots=True)
class CorrelationSection:
    """Correlations of the estimates."""

    #: Parameters of rows and columns; fewer than two when there is nothing to show.
    names: tuple[str, ...]
    matrix: tuple[tuple[float, ...], ...]  #: Normalised covariance.
    #: `passive`, `active`: the rows and columns of the outlined block.
    passive: tuple[str, ...]
    active: tuple[str, ...]
    #: `ipde`, `note`: equation (35), its largest possible value, and which parameters it leaves out
    #: or why there is none.
    ipde: str
    note: str
    pairs: tuple[str, ...]  #: The strongest pairs in words.
    alt: str  #: The figure in words.


def correlation_section(assessment: Assessment) -> CorrelationSection:
    """Describe the correlations: the map, the strongest pairs and the IPDE."""
    names = assessment.covariance.names
    matrix = assessment.covariance.correlation
    group = {p.name: p.group for p in assessment.parameters.values()}
    k = len(names)
    ranked = sorted(
        ((float(matrix[i, j]), names[i], names[j]) for i in range(k) for j in range(i + 1, k)),
        key=lambda pair: -abs(pair[0]),
    )
    strong = [pair for pair in ranked if abs(pair[0]) >= _STRONG]
    pairs = tuple(f"{a} – {b}: {signed(r, 3)}" for r, a, b in strong[:_PAIRS])
    if len(strong) > _PAIRS:
        pairs += (f"and {len(strong) - _PAIRS} more",)
    ipde = NO_NUMBER
    if assessment.ipde is not None:
        ipde = (
            f"{significant(assessment.ipde, 3)} (0 if independent, at most "
            f"{significant((k * (k - 1) / 2) ** 0.5, 3)} for these {k} parameters)"
        )
    strongest = f"; strongest {ranked[0][1]} with {ranked[0][2]}" if ranked else ""
    return CorrelationSection(
        names=names,
        matrix=tuple(tuple(row) for row in matrix.tolist()),
        passive=tuple(name for name in names if group[name] == "passive"),
        active=tuple(name for name in names if group[name] == "active"),
        ipde=ipde,
        note=assessment.ipde_note,
        pairs=pairs,
        alt=(
            f"Heat map of the correlations of {k} estimated parameters{strongest}"
            f"{f' ({signed(ranked[0][0], 3)})' if ranked else ''}; the block of passive against "
            "active parameters is outlined."
        ),
    )
