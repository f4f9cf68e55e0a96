"""The claims on standard errors, torque parts, the mass and dependencies (3.2.1 to 3.2.5)."""

from collections.abc import Callable, Iterator, Sequence
from statistics import fmean, median

import numpy as np

from surae.reproduction.claims import Claim, Finding, judged, unchecked
from surae.reproduction.cohort.evidence import Evidence, costs
from surae.reproduction.cohort.judge_vaf import QUICK
from surae.reproduction.cohort.results import Fits
from surae.studies.cohort import ACTIVE_PROTOCOL, PASSIVE_PROTOCOL

#: The two groups whose dependency the thesis looks at (4.2.2).
PASSIVE = ("k_tri", "k_tib", "x0_tri", "x0_tib", "tau_rel", "k_rel")
ACTIVE = ("g1", "g2", "g3", "g4", "l0_tri", "l0_tib", "f0", "beta")
_WEIGHTS, _FILTER = ("g1", "g2", "g3", "g4"), ("f0", "beta")
_SCALE = (
    "The standard error scales with what the fit leaves and with the parameter itself: the "
    "simulations leave 5 % noise, these fits {rest:.1f} % of the torque's root mean square."
)


def error_findings(evidence: Evidence) -> Iterator[Finding]:
    """Standard errors over those of the simulations, then the rest."""
    fits = evidence.fits
    yield from _snsem_rigid(fits)
    yield from _snsem_tendon(fits)
    yield from _mass_snsem(fits)
    yield from _parts(evidence)
    yield _mass(evidence)
    yield _block(fits)
    yield _lengths(fits)


def spectra_finding(differences: Sequence[float]) -> Finding:
    """Whether repetitions' spectra differ; mean absolute differences by pair [dB]."""
    claim = Claim(
        name="spectra-of-repetitions-differ",
        source="4.4, Figure 40",
        text="The torque's power spectra of a subject's repetitions differ.",
        number="three curves, several dB apart",
        rule="The mean absolute difference of two repetitions, 0.25 to 5 Hz, exceeds 1 dB.",
    )
    apart = fmean(differences)
    return judged(
        claim, apart > 1.0, f"{apart:.1f} dB (mean of {len(differences)} pairs)",
        why="The effort of these repetitions happens to be alike: it varies by 15 % in the cohort.",
        remark="Here the effort was made to differ by repetition: this shows no more than that it "
        "suffices.", figure="figure-40",
    )  # fmt: skip


def _medians(fits: Fits, model: str) -> dict[str, float]:
    """Median snSEM over the recordings of the multiple holds, by parameter."""
    if model not in fits.size.models:
        return {}
    found = fits.snsem(model, ACTIVE_PROTOCOL)
    return {name: median(several) for name, several in found.items() if several}


def _left(fits: Fits, model: str) -> str:
    """What a fit leaves of the torque, for comparison with the simulations' noise."""
    rest = [100.0 - p.value for p in fits.vaf(model, ACTIVE_PROTOCOL)]
    return _SCALE.format(rest=100.0 * float(np.sqrt(median(rest) / 100.0)))


def _snsem_rigid(fits: Fits) -> Iterator[Finding]:
    found, why, figure = _medians(fits, "1.0"), _left(fits, "1.0"), "figure-21"
    inside = [n for n, value in found.items() if 1.0 <= value <= 10.0]
    yield judged(
        Claim(
            name="snsem-muscle-one-to-ten", source="3.2.1, 4.2.1, Figure 21",
            text="Most snSEM of model 1.0 lie between 1 and 10.", number="1 … 10",
            rule="Multiple holds: the medians of more than half of the parameters lie in 1 … 10.",
        ),
        len(inside) > len(found) / 2,
        f"{len(inside)} of {len(found)}; from {min(found.values()):.2g} to "
        f"{max(found.values()):.2g}",
        why=why, figure=figure,
    )  # fmt: skip
    yield _higher(
        "snsem-muscle-weights-high", "3.2.1, Figure 21",
        "In model 1.0 the EMG weights have the highest snSEM.", "up to 150",
        "The median of the medians of g1 … g4 is above that of the other parameters.",
        found, _WEIGHTS, lambda a, b: a > b, why, figure,
    )  # fmt: skip
    yield _higher(
        "snsem-muscle-filter-low", "3.2.1, Figure 21",
        "In model 1.0 f0 and beta have the lowest snSEM.", "below 1",
        "The median of the medians of f0 and beta is below that of the other parameters.",
        found, _FILTER, lambda a, b: a < b, why, figure,
    )  # fmt: skip


def _higher(
    name: str, source: str, text: str, number: str, rule: str, found: dict[str, float],
    group: Sequence[str], holds: Callable[[float, float], bool], why: str, figure: str,
) -> Finding:  # fmt: skip
    claim = Claim(name=name, source=source, text=text, number=number, rule=rule)
    some = [found[n] for n in group if n in found]
    others = [value for n, value in found.items() if n not in group]
    if not some or not others:
        return unchecked(claim, "No fit gives these standard errors.", figure=figure)
    ours = f"{median(some):.2g} against {median(others):.2g}"
    return judged(claim, holds(median(some), median(others)), ours, why=why, figure=figure)


def _snsem_tendon(fits: Fits) -> Iterator[Finding]:
    rigid, tendon, why = _medians(fits, "1.0"), _medians(fits, "2.0"), _left(fits, "2.0")
    middle = median(tendon.values())
    yield judged(
        Claim(
            name="snsem-tendon-about-one", source="3.2.2, 4.2.2, Figure 26",
            text="The snSEM of model 2.0 are about 1.", number="about 1",
            rule="Multiple holds: the median of the parameters' medians lies in 0.5 … 2.",
        ),
        0.5 <= middle <= 2.0, f"{middle:.2g}", why=why, figure="figure-26",
    )  # fmt: skip
    yield judged(
        Claim(
            name="snsem-tendon-below-muscle", source="3.2.2, Figures 21 and 26",
            text="The snSEM of model 2.0 are lower than those of 1.0.", number="a lot lower",
            rule="Multiple holds: the median of the parameters' medians is lower.",
        ),
        middle < median(rigid.values()),
        f"{middle:.2g} against {median(rigid.values()):.2g}",
        why=f"Each is divided by its own model's simulations. {why}", figure="figure-26",
    )  # fmt: skip
    for model, what, figure, text, number in (
        ("2.1", "strain", "figure-33", "generally higher than", "higher, but for the weights"),
        ("2.2", "toe", "figure-34", "similar to", "very similar"),
    ):
        claim = Claim(
            name=f"snsem-{what}-{text.split(maxsplit=1)[0]}",
            source="3.2.4, 3.2.5, " + figure.title().replace("-", " "),
            text=f"The snSEM of model {model} are {text} those of 2.0.", number=number,
            rule="More than half of the fifteen medians are higher."
            if model == "2.1"
            else "The median ratio of the fifteen medians lies in 0.5 … 2.",
        )  # fmt: skip
        found = _medians(fits, model)
        both = [found[n] / tendon[n] for n in tendon if n in found]
        if not both:
            yield unchecked(claim, QUICK, figure=figure)
            continue
        share = fmean(r > 1.0 for r in both)
        ok = share > 0.5 if model == "2.1" else 0.5 <= median(both) <= 2.0
        yield judged(
            claim, ok, f"median ratio {median(both):.2g}, higher in {100 * share:.0f} %",
            why=_left(fits, model), figure=figure,
        )  # fmt: skip


def _mass_snsem(fits: Fits) -> Iterator[Finding]:
    for model, figure in (("2.1", "figure-33"), ("2.2", "figure-34")):
        claim = Claim(
            name=f"snsem-mass-highest-{model.replace('.', '-')}", source="3.2.4, 3.2.5",
            text=f"Of the snSEM of model {model}, that of the mass is the highest.",
            number="5.9 (2.1)", rule="Multiple holds: its median is the highest.",
        )  # fmt: skip
        found = _medians(fits, model)
        if "m" not in found:
            yield unchecked(claim, QUICK, figure=figure)
            continue
        rest = max((value, name) for name, value in found.items() if name != "m")
        yield judged(
            claim, found["m"] > rest[0], f"{found['m']:.1f}; next {rest[1]} with {rest[0]:.1f}",
            why=_left(fits, model), figure=figure,
            remark="The device's filter takes most of the chirp that tells the mass in the "
            "simulations.",
        )  # fmt: skip


def _parts(evidence: Evidence) -> Iterator[Finding]:
    fits = evidence.fits
    sizes = [found["sizes"] for _, _, found in fits.of("1.0", ACTIVE_PROTOCOL)]

    def most(part: str) -> float:
        return float(max(one[part] for one in sizes if one[part] is not None))

    measured = [one["measured"] for one in evidence.strengths.values()]
    rigid = [one["rigid"] for one in evidence.strengths.values()]
    strength = (
        f"The cohort's subjects reach {min(measured):.0f} to {max(measured):.0f} Nm. The strength "
        "of the population is meant for rigid tendons, on which the same legs and efforts would "
        f"reach {min(rigid):.0f} to {max(rigid):.0f} Nm: on compliant tendons the same "
        "effort gives less. It was not adapted to the claim."
    )
    for name, part, number, text, low, high in (
        ("active-up-to-80", "neural", "80 Nm", "Active torque reaches about 80 Nm.", 60.0, 100.0),
        ("passive-up-to-10", "tissue", "10 Nm", "Passive torque reaches about 10 Nm.", 5.0, 15.0),
    ):
        yield judged(
            Claim(
                name=name, source="3.2.1, Figures 18 to 20", text=text, number=number,
                rule=f"Model 1.0, multiple holds: the largest is {low:g} to {high:g} Nm.",
            ),
            low <= most(part) <= high, f"{most(part):.1f} Nm", why=strength, figure="figure-19",
        )  # fmt: skip
    ratio = [one["inertial"] / one["neural"] for one in sizes if one["neural"]]
    yield judged(
        Claim(
            name="inertia-small", source="3.2.1, Figures 18 to 20",
            text="The inertial torque is very small.", number="hardly visible",
            rule="Model 1.0, multiple holds: its largest is below 10 % of the active torque's.",
        ),
        max(ratio) < 0.1, f"{100 * max(ratio):.1f} % at most, {100 * median(ratio):.1f} % (median)",
        why=f"The inertial torque reaches {most('inertial'):.1f} Nm, what mass and chirp make it; "
        f"it is the active torque that is small. {strength}", figure="figure-19",
    )  # fmt: skip
    for model, figure in (("1.0", "figure-19"), ("2.0", "figure-25")):
        short = [
            found["sizes"]["short_at_peaks"]
            for _, _, found in fits.of(model, ACTIVE_PROTOCOL)
            if found["sizes"]["short_at_peaks"] is not None
        ]
        share = fmean(one > 0.0 for one in short)
        yield judged(
            Claim(
                name=f"peaks-not-reached-{model.replace('.', '-')}",
                source=f"3.2.1, 3.2.2, {figure.title().replace('-', ' ')}",
                text=f"The torque of model {model} does not reach the measured peaks.",
                number="visible at the peaks",
                rule="Multiple holds: over the largest 5 % of the torque, it falls short in more "
                "than half of the recordings.",
            ),
            share > 0.5,
            f"short in {100 * share:.0f} % of {len(short)}, by {100 * fmean(short):.1f} % (mean)",
            why=costs(evidence, model, ACTIVE_PROTOCOL), figure=figure,
        )  # fmt: skip


def _mass(evidence: Evidence) -> Finding:
    fits = evidence.fits
    bound: dict[str, list[bool]] = {}
    for protocol in (PASSIVE_PROTOCOL, ACTIVE_PROTOCOL):
        for _, _, found in fits.of("1.0", protocol):
            bound.setdefault(protocol, []).append(found["parameters"]["m"]["at_bound"])
    share = fmean(bound[ACTIVE_PROTOCOL])
    errors = [
        abs(found["parameters"]["m"]["value"] / found["parameters"]["m"]["true"] - 1.0)
        for _, _, found in fits.of("1.0", ACTIVE_PROTOCOL)
        if found["parameters"]["m"]["value"] is not None
    ]
    return judged(
        Claim(
            name="mass-at-bounds", source="4.2.1",
            text="The mass ends at its bound in almost all subjects.", number="almost all",
            rule="Model 1.0, multiple holds: at its bound in more than half of the recordings.",
        ),
        share > 0.5,
        f"{100 * share:.0f} % of the multiple holds, "
        f"{100 * fmean(bound[PASSIVE_PROTOCOL]):.0f} % of the ramp and hold",
        why="In the cohort gravity tells the mass: the foot's weight at the ankle is part of the "
        f"model, equation (7), and true of the legs; the estimate is {100 * median(errors):.0f} % "
        "off (median). That its equations describe the foot is what the cohort takes for granted, "
        "and what the thesis's bounds put in doubt.", figure="figure-19",
    )  # fmt: skip


def _block(fits: Fits) -> Finding:
    largest, at_bound = [], []
    for _, _, found in fits.of("2.0", ACTIVE_PROTOCOL):
        names, matrix = found["correlation"]["names"], np.array(found["correlation"]["matrix"])
        rows = [names.index(n) for n in PASSIVE if n in names]
        columns = [names.index(n) for n in ACTIVE if n in names]
        at_bound.append(len(PASSIVE) - len(rows))
        if rows and columns:
            largest.append(float(np.abs(matrix[np.ix_(rows, columns)]).max()))
    return judged(
        Claim(
            name="passive-active-covariances", source="3.2.2, Figure 28",
            text="Some covariances between passive and active parameters are high.",
            number="high in the red box",
            rule="Model 2.0, multiple holds: the largest |correlation| of the block exceeds 0.5 in "
            "more than half of the recordings.",
        ),
        fmean(one > 0.5 for one in largest) > 0.5,
        f"{median(largest):.2f} (median), {min(largest):.2f} to {max(largest):.2f}",
        why=f"It exceeds 0.5 in {100 * fmean(one > 0.5 for one in largest):.0f} % of the "
        f"recordings. {median(at_bound):g} of the {len(PASSIVE)} passive parameters (median) have "
        "no covariance, being at a bound or inseparable: that leaves fewer pairs.",
        figure="figure-28",
    )  # fmt: skip


def _lengths(fits: Fits) -> Finding:
    pairs = [("l0_tri", "k_tri"), ("l0_tri", "x0_tri"), ("l0_tib", "k_tib"), ("l0_tib", "x0_tib")]
    found: dict[tuple[str, str], list[float]] = {pair: [] for pair in pairs}
    for _, _, fit in fits.of("2.0", ACTIVE_PROTOCOL):
        names, matrix = fit["correlation"]["names"], fit["correlation"]["matrix"]
        for a, b in pairs:
            if a in names and b in names:
                found[a, b].append(abs(matrix[names.index(a)][names.index(b)]))
    said = {pair: median(several) for pair, several in found.items() if several}
    claim = Claim(
        name="optimal-lengths-depend", source="3.2.2, 4.2.2, Figure 28",
        text="Optimal lengths depend on the stiffness and slack length of their muscle.",
        number="high",
        rule="Model 2.0, multiple holds: the median |correlation| of one of the pairs exceeds 0.5.",
    )  # fmt: skip
    if not said:
        return unchecked(claim, "No fit has both parameters off their bounds.", figure="figure-28")
    ours = ", ".join(f"{a}–{b} {value:.2f}" for (a, b), value in said.items())
    return judged(
        claim, max(said.values()) > 0.5, ours,
        why="One of the pairs exceeds 0.5 in single recordings, none in the median: the largest is "
        f"{max(max(several) for several in found.values() if several):.2f}.", figure="figure-28",
    )  # fmt: skip
