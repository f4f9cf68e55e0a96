"""Populations of virtual subjects: from which ranges their parameters are drawn, and why.

Every parameter is drawn uniformly and independently of the others, so that what two estimates have
in common comes from the data and not from the population.

============== ===================================================================================
m              1.2 to 3 kg for foot and footplate (van de Poll 2015, 2.3.1); less in patients
               (2.5.4)
k_tri, x0_tri  together 6.2 ± 3.6 Nm at 10° dorsiflexion in healthy legs, 9.5 ± 4.8 Nm in spastic
               ones (Chung et al. 2004, *Arch. Phys. Med. Rehabil.* 85)
k_tib, x0_tib  plausible: about 1 Nm (healthy) and 5 Nm (patients) at full plantarflexion
tau_rel, k_rel plausible: 17 to 38 % of the passive force relaxes, within seconds
g1 … g4        up to about 80 Nm at envelopes of 6·10⁻⁴ V (thesis, Figures 9 and 18 to 20)
l0_tri         0.045 m, with which the ramp and hold reaches the 0.35 l0/s of the thesis's Figure 3;
               shorter fascicles in patients (2.5.4; Zhao et al. 2015, *J. Appl. Physiol.* 118)
l0_tib         0.08 m, the length of equation (9) in mid-range; shorter in patients
f0, beta       plausible: about 2 Hz, near the critical damping that the thesis prescribes (2.3.3)
============== ===================================================================================
"""

import zlib
from collections.abc import Mapping
from dataclasses import dataclass, field, replace

import numpy as np

from surae.base import names
from surae.base.formatting import check_known
from surae.model import ModelOptions, get_model
from surae.model.parameters import MUSCLE_PARAMETERS, TENDON_PARAMETERS
from surae.model.registry import PARAMETERS

Ranges = dict[str, tuple[float, float]]

#: The ranges by population and parameter.
POPULATIONS: dict[str, Ranges] = {
    of: {p.name: p.drawn[of] for p in MUSCLE_PARAMETERS} for of in names.POPULATIONS
}
#: Tendons of a subject's own: ε0 in metres, F̄toe; what is left, ktoe and Fmax, is Table 2's.
#: The linear part of the curve has the stiffness 1.92·Fmax/ε0. Triceps: 550 to 310 N/mm in health
#: (430 ± 200, Peltonen et al. 2010, *J. Exp. Biol.* 213) and 340 to 220 N/mm in patients, whose
#: Achilles tendon is about 42 % less stiff (Zhao et al. 2015). Tibialis: 340 to 150 N/mm (161 N/mm
#: and 4.1 mm at 530 N, Maganaris and Paul 1999, *J. Physiol.* 521). F̄toe lies around Table 2's 0.3.
TENDONS: dict[str, Ranges] = {
    of: {p.name: p.drawn[of] for p in TENDON_PARAMETERS if p.drawn} for of in names.POPULATIONS
}


@dataclass(frozen=True, slots=True)
class VirtualSubject:
    """A subject whose parameters are known."""

    population: str  #: A name of `POPULATIONS`.
    seed: int  #: The same population and seed always give the same subject.
    parameters: Mapping[str, float]  #: The fifteen parameters of the muscle model.
    #: Tendon parameters of the subject's own, ε0 in metres; empty for the thesis's Table 2.
    tendons: Mapping[str, float] = field(default_factory=dict)

    def truth(self, model: str, options: ModelOptions | None = None) -> dict[str, float]:
        """The subject's parameters by name, as a model with these options takes them.

        A tendon of the subject's own is left out of a model without tendons; ε0 is a strain where
        `options.tendon_strain` is ``"slack-length"``.
        """
        known = get_model(model).names
        strain = (options or ModelOptions()).tendon_strain == "slack-length"
        of_tendons = {
            name: value / PARAMETERS[name].slack if strain else value
            for name, value in self.tendons.items()
            if name in known
        }
        return {**self.parameters, **of_tendons}


def virtual_subject(
    seed: int, population: str = "healthy", *, tendons: bool = False
) -> VirtualSubject:
    """Draw a subject.

    Parameters
    ----------
    seed : int
        Zero or more.
    population : str
        A name of `POPULATIONS`.
    tendons : bool
        Draw tendons of the subject's own too (`TENDONS`); the other parameters stay the same.

    Returns
    -------
    VirtualSubject
        Its true parameters.

    Raises
    ------
    InputError
        The population is not known.

    Examples
    --------
    >>> surae.virtual_subject(seed=1).parameters
    """
    check_known("population", POPULATIONS, population)
    rng = np.random.default_rng([seed, list(POPULATIONS).index(population)])
    parameters = _drawn(POPULATIONS[population], rng)
    subject = VirtualSubject(population, seed, parameters)
    tendons_of = _drawn(TENDONS[population], stream(subject, "tendons"))
    return replace(subject, tendons=tendons_of) if tendons else subject


def stream(subject: VirtualSubject, purpose: str, trial: int | None = None) -> np.random.Generator:
    """Random numbers for one purpose and trial, or of all (None): no other moves its draws."""
    keys = [zlib.crc32(subject.population.encode()), zlib.crc32(purpose.encode())]
    entropy = [subject.seed] if trial is None else [subject.seed, trial]
    # The length comes first, since a seed sequence takes [5] and [5, 0] for the same.
    return np.random.default_rng(np.random.SeedSequence([len(entropy), *entropy], spawn_key=keys))


def _drawn(ranges: Ranges, rng: np.random.Generator) -> dict[str, float]:
    return {name: float(rng.uniform(*limits)) for name, limits in ranges.items()}
