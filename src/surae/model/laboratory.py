"""What no laboratory can rule out, as parameters with priors: the nuisances of `model="auto"`.

A prior is a mean and a standard deviation, in the parameter's own unit. Each is what a careful
laboratory that did not look further knows, not what some recording told; all can be changed
(`nuisances` of `surae.fit`).

============== ============ ================================================================
group          prior        because
============== ============ ================================================================
zero           0 ± 10 Nm    a dynamometer's zero was off by 12 to 19 Nm with a foot strapped in
delay          30 ± 30 ms   20 to 100 ms from EMG to force (Cavanagh and Komi 1979)
crosstalk      4 ± 3 %      of a neighbour's rectified EMG (De Luca and Merletti 1988: 3 to 10 %)
axis           0 ± 10 mm    torques 5 to 9 % off (Arampatzis et al. 2007)
drift          0 ± 10 %     of an electrode's gain within a trial, as skin and gel warm; assumed
rest           0 ± 1        of the level that the electrode shows at its quietest: an envelope is
                            never below zero, so that noise alone lifts it
shape          −0.5 ± 1     Lloyd and Besier (2003): between −3 and 0, and 0 is a line
toe            0.3 ± 0.1    of the tendon's force curve (Table 2 after Thelen 2003); spread assumed
============== ============ ================================================================
"""

from collections.abc import Mapping, Sequence
from dataclasses import dataclass

from surae.errors import InputError
from surae.model.parameters import OPTIONAL

#: The name under which the family of models is asked for, and its rigid and compliant member.
AUTO, RIGID, COMPLIANT = "auto", "muscle", "muscle-tendon-strain"
#: What `nuisances` may be beside a mapping.
ALL, NONE = "all", "none"


def richest(model: str) -> str:
    """Name of the model whose parameters a fit may speak of: of a family, its richest one.

    Parameters
    ----------
    model : str
        Name of a model, or ``"auto"``.
    """
    return COMPLIANT if model == AUTO else model


@dataclass(frozen=True, slots=True)
class Belief:
    """What is known of a nuisance beforehand: a Gaussian."""

    #: `mean`, `sd`: in the parameter's unit.
    mean: float
    sd: float
    off: float = 0.0  #: The value at which there is no such nuisance.


#: Parameters of each group of nuisances; a group is in a model as a whole or not at all.
GROUPS: dict[str, tuple[str, ...]] = {
    "zero": OPTIONAL["torque_zero"],
    "delay": OPTIONAL["emd"],
    "crosstalk": OPTIONAL["crosstalk"],
    "axis": OPTIONAL["axis"],
    "drift": OPTIONAL["emg_drift"],
    "rest": OPTIONAL["emg_rest"],
    "shape": OPTIONAL["emg_shape"],
    "toe": ("pt_tri", "pt_tib"),
}
#: Groups that differ between trials of one session, and those that do beside them when electrodes
#: and foot are mounted anew.
EACH_TRIAL, EACH_MOUNTING = ("zero", "drift", "rest"), ("crosstalk", "axis")
_BELIEFS = {
    "zero": Belief(0.0, 10.0),
    "delay": Belief(0.03, 0.03),
    "crosstalk": Belief(0.04, 0.03),
    "axis": Belief(0.0, 0.01),
    "drift": Belief(0.0, 0.1),
    "rest": Belief(0.0, 1.0),
    "shape": Belief(-0.5, 1.0),
    "toe": Belief(0.3, 0.1, off=0.3),
}


def laboratory(
    nuisances: str | Mapping[str, tuple[float, float]] = ALL,
    quiet: Sequence[float] | None = None,
) -> dict[str, Belief]:
    """The priors of all nuisances, by parameter.

    `nuisances` is ``"all"``, ``"none"``, or other priors, (mean, sd), for groups or parameters; the
    rest keep theirs. A standard deviation of 0 takes one out.
    `quiet` is the level of each electrode at its quietest, in the EMG's unit: the priors of EMG at
    rest are in parts of it. Where it is zero, or not given, that is taken for known.
    """
    if nuisances == NONE:
        return {}
    beliefs = {name: _BELIEFS[group] for group, names in GROUPS.items() for name in names}
    if isinstance(nuisances, str):
        if nuisances != ALL:
            raise InputError(f"nuisances is {nuisances!r}; use 'all', 'none' or a mapping")
        return _of_electrodes(beliefs, quiet)
    for name, pair in nuisances.items():
        names = GROUPS.get(name, (name,))
        if not set(names) <= beliefs.keys():
            known = ", ".join((*GROUPS, *(n for g in GROUPS.values() for n in g)))
            raise InputError(f"nuisances: no {name!r}; use one of: {known}")
        try:
            mean, sd = (float(number) for number in pair)
        except (TypeError, ValueError):
            raise InputError(f"nuisances: {name} is {pair!r}; give mean and sd") from None
        if not (abs(mean) < float("inf") and 0 <= sd < float("inf")):
            raise InputError(f"nuisances: {name} is {pair!r}; give a finite mean, and sd from 0")
        for each in names:
            if sd == 0:
                del beliefs[each]
            else:
                beliefs[each] = Belief(mean, sd, beliefs[each].off)
    return _of_electrodes(beliefs, quiet)


def _of_electrodes(beliefs: dict[str, Belief], quiet: Sequence[float] | None) -> dict[str, Belief]:
    """Priors with those of EMG at rest in its unit."""
    for name, level in zip(GROUPS["rest"], quiet or (0.0,) * 4, strict=True):
        belief = beliefs.pop(name, None)
        if belief is not None and level > 0.0:
            beliefs[name] = Belief(belief.mean * level, belief.sd * level)
    return beliefs


def group_of(name: str) -> str | None:
    """The group of a nuisance; None for a parameter of the leg."""
    return next((group for group, names in GROUPS.items() if name in names), None)
