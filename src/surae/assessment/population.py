"""What is known of a leg's parameters before it is measured: the priors of the posterior.

A prior is a Gaussian on a parameter's logarithm. The medians are what the literature and the
thesis expect of an adult leg; the spreads are about twice those between people, healthy and
spastic together, so that a recording which says something of a parameter is not contradicted. They
take the place of the bounds, which a posterior does not have.
"""

from collections.abc import Mapping
from dataclasses import dataclass

from surae.errors import InputError
from surae.estimation import FitProblem
from surae.estimation.problem import checked_prior
from surae.model import adapted

#: Median and spread, the standard deviation of the logarithm, of an adult leg; SI units.
POPULATION: Mapping[str, tuple[float, float]] = {
    # Foot and footplate; the thesis allows 1.2 … 3 kg.
    "m": (2.0, 0.25),
    # Passive torque at 10° dorsiflexion 6.2 ± 3.6 Nm healthy, 9.5 ± 4.8 Nm spastic (Chung 2004):
    # k_tri near 200 1/m with x0_tri of 0.014 … 0.018 m.
    "k_tri": (200.0, 0.5),
    "x0_tri": (0.016, 0.3),
    "k_tib": (110.0, 0.5),
    "x0_tib": (0.064, 0.3),
    # 1 … 10 s and 0.1 … 0.6 (thesis).
    "tau_rel": (3.0, 1.0),
    "k_rel": (0.3, 0.8),
    # Force per volt depends on electrodes and skin as much as on the muscle.
    "g1": (6e5, 1.0),
    "g2": (1e6, 1.0),
    "g3": (1e6, 1.0),
    "g4": (1e6, 1.0),
    # 0.040 … 0.050 and 0.07 … 0.09 m healthy, a fifth less in patients (thesis 2.5.4).
    "l0_tri": (0.045, 0.25),
    "l0_tib": (0.080, 0.25),
    "f0": (2.0, 0.5),
    "beta": (1.0, 0.4),
    # Tendons: thesis Table 2.
    "dlt_tri": (0.04, 0.5),
    "dlt_tib": (0.04, 0.5),
    "pt_tri": (0.3, 0.4),
    "pt_tib": (0.3, 0.4),
    "kt_tri": (4.0, 0.4),
    "kt_tib": (4.0, 0.4),
    "fmax_tri": (8e3, 0.3),
    "fmax_tib": (1.4e3, 0.3),
    # The model of 2010.
    "e1": (6e5, 1.0),
    "e2": (1e6, 1.0),
    "e3": (1e6, 1.0),
    "e4": (1e6, 1.0),
    "f": (2.0, 0.5),
    "b_tri": (500.0, 1.5),
}
#: Where muscles move with their arms, they travel further: other lengths, smaller stiffnesses.
VIRTUAL_WORK: Mapping[str, tuple[float, float]] = {
    "k_tri": (60.0, 0.6),
    "k_tib": (70.0, 0.6),
    "x0_tri": (0.030, 0.6),
    "x0_tib": (0.075, 0.6),
    "l0_tri": (0.080, 0.4),
    "l0_tib": (0.105, 0.4),
}
#: ε0 as a part of the slack length.
SLACK_LENGTH: Mapping[str, tuple[float, float]] = {"dlt_tri": (0.10, 0.5), "dlt_tib": (0.035, 0.5)}
#: Force at a full normalised envelope.
NORMALISED: tuple[float, float] = (1e3, 1.0)


@dataclass(frozen=True, slots=True)
class Belief:
    """What is known of one parameter beforehand.

    Attributes
    ----------
    median, spread : float
        Median, and standard deviation of the logarithm; of the parameter itself, in its unit,
        where it may be negative.
    log : bool
        Whether it is on the logarithm.
    origin : {"population", "fit", "given"}
        Whether it is of the table, was a prior of the fit, or was given for the posterior.
    """

    median: float
    spread: float
    log: bool
    origin: str


def beliefs(
    problem: FitProblem, given: Mapping[str, tuple[float, float]] | None = None
) -> dict[str, Belief]:
    """The prior of every free parameter: given now, else given to the fit, else of the table.

    Parameters
    ----------
    problem : FitProblem
        The question; its options and EMG unit say what a parameter means.
    given : mapping of str to (median, spread), optional
        Priors that take the place of others.

    Raises
    ------
    InputError
        One given is of an unknown or fixed parameter, or not of two numbers above zero.
    """
    table = adapted(problem.spec.parameters, problem.options, problem.inputs[0].emg_unit)
    medians = dict(POPULATION)
    if problem.options.geometry == "virtual-work":
        medians |= VIRTUAL_WORK
    if problem.options.tendon_strain == "slack-length":
        medians |= SLACK_LENGTH
    medians |= {name: NORMALISED for name, p in table.items() if p.unit == "N"
                and name in problem.spec.weights}  # fmt: skip
    found = {}
    for name in problem.free:
        p = table[name]
        if p.signed:
            # Its bounds as two standard deviations to either side.
            found[name] = Belief((p.lower + p.upper) / 2, (p.upper - p.lower) / 4, False,
                                 "population")  # fmt: skip
        else:
            found[name] = Belief(*medians[name], True, "population")
    for name, prior in problem.priors.items():
        found[name] = Belief(prior.median, prior.spread, True, "fit")
    for name, pair in (given or {}).items():
        prior = checked_prior(name, pair, problem.free)
        if table[name].signed:
            raise InputError(f"prior of {name}: it is on a logarithm, and {name} may be negative")
        found[name] = Belief(prior.median, prior.spread, True, "given")
    return found
