"""What is known of the parameters before a measurement: priors of a population, with sources.

A prior is a Gaussian on the logarithm: two thirds of the population are believed to lie between
median/exp(spread) and median·exp(spread). Medians lie in the middle of the ranges from which
virtual subjects are drawn. Spreads are at least as wide as those ranges, and wider where people are
known to differ more, since a default must not decide what the data should.

A fit that is told the population takes its priors from `KNOWN`. The EMG weights have none there:
they depend on electrodes and skin as much as on the muscle. The length parameters and stiffnesses
hold for equation (9) as printed, not for virtual work.

A posterior, which has no bounds, needs a prior of every parameter and is told no population. It
takes that of health with its spread `WIDENED`, so that patients lie within it and it reaches about
as far as a fit's bounds, and where health has no entry one of `WIDE` or `WIDE_VIRTUAL_WORK`.
"""

from collections.abc import Mapping, Sequence
from dataclasses import dataclass, replace

import numpy as np

from surae.errors import InputError
from surae.filed import filed
from surae.model import ModelOptions
from surae.model.tendon import SLACK_TIB, SLACK_TRI

#: Below this part of its median a parameter's prior no longer changes: its logarithm would not end.
_SMALLEST = 1e-6


@filed(sparse=("straight",))
@dataclass(frozen=True, slots=True)
class Prior:
    """What is known of a parameter beforehand: a Gaussian on its logarithm."""

    median: float  #: Expected value, in the parameter's unit.
    #: Standard deviation of the logarithm; for small ones, the relative standard deviation.
    spread: float
    #: The Gaussian is on the parameter itself, `spread` in its unit: a nuisance of the laboratory.
    straight: bool = False

    def row(self, value: float) -> tuple[float, float]:
        """Standard deviations that a value is away from the median, its derivative first."""
        if self.straight:
            return 1.0 / self.spread, (value - self.median) / self.spread
        value = max(value, _SMALLEST * self.median)
        return 1.0 / (self.spread * value), float(np.log(value / self.median)) / self.spread

    def drawn(self, rng: np.random.Generator) -> "Prior":
        """The prior about a median that is drawn from it, as a bootstrap asks for."""
        away = self.spread * float(rng.standard_normal())
        median = self.median + away if self.straight else self.median * float(np.exp(away))
        return replace(self, median=median)


def checked_prior(name: str, pair: object, free: Sequence[str]) -> Prior:
    """The prior that a median and a spread make, of one of the free parameters."""
    if name not in free:
        raise InputError(
            f"prior of {name}: it is not estimated; free parameters: {', '.join(free)}"
        )
    if not isinstance(pair, Sequence | np.ndarray) or len(pair) != 2:
        raise InputError(f"prior of {name} is {pair!r}; give its median and its spread")
    median, spread = pair
    for value in (median, spread):
        number = isinstance(value, int | float | np.number) and not isinstance(value, bool)
        if not number or not 0 < value < np.inf:
            raise InputError(f"prior of {name} is {pair!r}; median and spread must be above zero")
    return Prior(float(median), float(spread))


@dataclass(frozen=True, slots=True)
class Known:
    """A parameter's prior, and where it comes from."""

    median: float
    spread: float
    source: str


_CHUNG = (
    "triceps passive torque at 10° dorsiflexion, 6.2 ± 3.6 Nm healthy, 9.5 ± 4.8 Nm spastic "
    "(Chung et al. 2004, Arch. Phys. Med. Rehabil. 85), through equations (8) and (9)"
)
_WARD = (
    "middle of equation (9)'s range; fibre lengths of legs differ by about 20 % in the triceps and "
    "11 % in the tibialis anterior (Ward et al. 2009, Clin. Orthop. Relat. Res. 467)"
)
_SHORTER = "shorter than in health (van de Poll 2015, 2.5.4); spread as in health"
_ASSUMED = "assumed, around the thesis's starting values (van de Poll 2015); no measurement known"
_FILTER = "about 2 Hz, near critical damping (van de Poll 2015, Table 1); spread assumed"
_TOE = "Table 2 (van de Poll 2015), after Thelen 2003; spread assumed"

#: By population and parameter; SI units as in the parameter tables, ε0 in metres.
KNOWN: dict[str, dict[str, Known]] = {
    "healthy": {
        "m": Known(2.0, 0.30, "foot 1.45 % of 50 … 100 kg (Winter 2009), footplate about 1 kg"),
        "k_tri": Known(198.0, 0.20, _CHUNG),
        "k_tib": Known(108.0, 0.30, _ASSUMED),
        "x0_tri": Known(0.0170, 0.12, _CHUNG),
        "x0_tib": Known(0.0645, 0.12, _ASSUMED),
        "tau_rel": Known(2.45, 0.90, _ASSUMED),
        "k_rel": Known(0.346, 0.55, _ASSUMED),
        "l0_tri": Known(0.0447, 0.20, _WARD),
        "l0_tib": Known(0.0794, 0.15, _WARD),
        "f0": Known(1.96, 0.25, _FILTER),
        "beta": Known(0.98, 0.25, _FILTER),
        "dlt_tri": Known(0.0374, 0.45, "430 ± 200 N/mm (Peltonen et al. 2010, J. Exp. Biol. 213)"),
        "dlt_tib": Known(
            0.0120, 0.45, "161 N/mm (Maganaris and Paul 1999, J. Physiol. 521); spread assumed"
        ),
        "pt_tri": Known(0.283, 0.35, _TOE),
        "pt_tib": Known(0.283, 0.35, _TOE),
    },
}
KNOWN["patient"] = KNOWN["healthy"] | {
    "m": Known(1.58, 0.30, "less than in health (van de Poll 2015, 2.5.4)"),
    "k_tri": Known(211.0, 0.20, _CHUNG),
    "k_tib": Known(139.0, 0.30, _ASSUMED),
    "x0_tri": Known(0.0155, 0.12, _CHUNG),
    "x0_tib": Known(0.0600, 0.12, _ASSUMED),
    "l0_tri": Known(0.0378, 0.20, _SHORTER),
    "l0_tib": Known(0.0671, 0.15, _SHORTER),
    "dlt_tri": Known(
        0.0561, 0.45, "42 % less stiff than in health (Zhao et al. 2015, J. Appl. Physiol. 118)"
    ),
}

#: By how much the spread of health is widened for a leg of which nothing is known.
WIDENED = 1.5

_ELECTRODES = "up to about 80 Nm at envelopes of 6·10⁻⁴ V (van de Poll 2015, Figures 9, 18 to 20)"
_TABLE = "Table 2 (van de Poll 2015); spread assumed"
_TRAVEL = "for the muscles' larger travel by virtual work; spread assumed, no measurement known"
#: Of a leg of which nothing is known, for parameters that health has no entry for.
WIDE: dict[str, Known] = {
    "g1": Known(6e5, 1.0, _ELECTRODES),
    "g2": Known(1e6, 1.0, _ELECTRODES),
    "g3": Known(1e6, 1.0, _ELECTRODES),
    "g4": Known(1e6, 1.0, _ELECTRODES),
    "kt_tri": Known(4.0, 0.4, _TABLE),
    "kt_tib": Known(4.0, 0.4, _TABLE),
    "fmax_tri": Known(8e3, 0.3, _TABLE),
    "fmax_tib": Known(1.4e3, 0.3, _TABLE),
    "emd": Known(0.03, 0.7, "20 to 100 ms with the surface EMG (Cavanagh and Komi 1979); assumed"),
    "reflex_tri": Known(2e3, 1.5, "assumed: some Nm at a stretch of 3 rad/s; none known"),
    "reflex_tib": Known(2e3, 1.5, "assumed: some Nm at a stretch of 3 rad/s; none known"),
    "reflex_delay": Known(0.05, 0.4, "short latency 40 ms and the muscle's own delay; assumed"),
    "b_tri": Known(500.0, 1.5, "assumed, around the start of the model of 2010; none known"),
}
WIDE |= {f"e{number}": WIDE[f"g{number}"] for number in (1, 2, 3, 4)}
#: Those that take the EMG as it is.
_WEIGHTS = ("g1", "g2", "g3", "g4", "e1", "e2", "e3", "e4")
#: Instead of what holds for equation (9) as printed.
WIDE_VIRTUAL_WORK: dict[str, Known] = {
    "k_tri": Known(60.0, 0.6, _TRAVEL),
    "k_tib": Known(70.0, 0.6, _TRAVEL),
    "x0_tri": Known(0.030, 0.6, _TRAVEL),
    "x0_tib": Known(0.075, 0.6, _TRAVEL),
    "l0_tri": Known(0.080, 0.4, _TRAVEL),
    "l0_tib": Known(0.105, 0.4, _TRAVEL),
}
#: An EMG weight where the envelope is normalised: the force [N] at its full effort.
WIDE_NORMALISED = Known(1e3, 1.0, "assumed, a muscle's force at full effort; no measurement known")

#: Those that hold for equation (9) as printed only.
_PRINTED_GEOMETRY = ("k_tri", "k_tib", "x0_tri", "x0_tib", "l0_tri", "l0_tib")
#: Slack length that turns ε0 in metres into a strain.
_SLACK = {"dlt_tri": SLACK_TRI, "dlt_tib": SLACK_TIB}


def population_priors(
    population: str, options: ModelOptions | None = None
) -> dict[str, tuple[float, float]]:
    """Median and spread of every parameter that has a prior under these options, by name.

    Parameters
    ----------
    population : str
        A name of `KNOWN`.
    options : ModelOptions, optional
        Virtual work leaves out lengths and stiffnesses; ε0 is a strain where it is to be read so.

    Raises
    ------
    InputError
        The population is not known.
    """
    options = options or ModelOptions()
    if population not in KNOWN:
        known = ", ".join(KNOWN)
        raise InputError(f"no priors of population {population!r}; known populations: {known}")
    strain = options.tendon_strain == "slack-length"
    return {
        name: (prior.median / (_SLACK.get(name, 1.0) if strain else 1.0), prior.spread)
        for name, prior in KNOWN[population].items()
        if options.travel == "thesis" or name not in _PRINTED_GEOMETRY
    }


def wide_priors(
    options: ModelOptions | None = None, emg_unit: str = "V"
) -> dict[str, tuple[float, float]]:
    """Median and spread of every parameter that is above zero, of a leg nothing is known of.

    With virtual work lengths and stiffnesses are others; ε0 is a strain where it is to be read so.
    Weights of a normalised envelope are forces.
    """
    options = options or ModelOptions()
    health = population_priors("healthy", options)
    wide = {name: (median, WIDENED * spread) for name, (median, spread) in health.items()}
    wide["f"] = wide["f0"]  # the model of 2010 calls it so
    own = dict(WIDE)
    if options.travel == "virtual-work":
        own |= WIDE_VIRTUAL_WORK
    if emg_unit == "1":
        own |= dict.fromkeys(_WEIGHTS, WIDE_NORMALISED)
    return wide | {name: (prior.median, prior.spread) for name, prior in own.items()}


def population_of(
    priors: Mapping[str, tuple[float, float]], options: ModelOptions
) -> dict[str, str]:
    """The population whose default each prior is, by parameter; of those that are a default."""
    best: dict[str, str] = {}
    for population in KNOWN:
        known = population_priors(population, options)
        same = {name: population for name, pair in priors.items() if known.get(name) == pair}
        if len(same) > len(best):  # the populations share some: the one that explains most
            best = same
    return best
