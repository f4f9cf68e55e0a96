"""The priors of what no laboratory can rule out: the nuisances of `model="auto"`."""

from collections.abc import Mapping, Sequence

from surae.base.errors import InputError
from surae.model.joint import ANKLE, Joint
from surae.model.source import Gaussian, Nuisance
from surae.model.source_table import NUISANCES

#: The name under which the family of models is asked for, and its rigid and compliant member.
AUTO = "auto"
RIGID = "muscle"
COMPLIANT = "muscle-tendon-strain"
#: The prior of what there is not.
_NOTHING = Gaussian(0.0, 0.0)
#: What `nuisances` may be beside a mapping.
ALL = "all"
NONE = "none"
_NUISANCES: dict[str, Nuisance] = {g: s.nuisance for g, s in NUISANCES.items() if s.nuisance}
#: Parameters of each group of nuisances; a group is in a model as a whole or not at all.
GROUPS = {group: nuisance.parameters for group, nuisance in _NUISANCES.items()}
#: Groups that differ between trials of one session, and those that the leg itself knows nothing of.
EACH_TRIAL = tuple(group for group, n in _NUISANCES.items() if n.anew == "trial")
OUTSIDE = tuple(group for group, n in _NUISANCES.items() if not n.of_leg)
#: Groups that are in a model only where the data ask for them.
DEPARTURES = tuple(group for group, n in _NUISANCES.items() if n.departs)
#: Those of them that are looked for one by one before they are weighed with the others, and of
#: which the best alone is: what reflexes answer beside velocity.
RARE = tuple(group for group, n in _NUISANCES.items() if n.rare)
LAWS = ("reflex_length", "reflex_force")


def richest(model: str) -> str:
    """Name of the model whose parameters a fit may speak of: of a family, its richest one.

    Parameters
    ----------
    model : str
        Name of a model, or ``"auto"``.
    """
    return COMPLIANT if model == AUTO else model


def laboratory(
    nuisances: str | Mapping[str, tuple[float, float]] = ALL,
    quiet: Sequence[float] | None = None,
    *,
    measured: bool = False,
    mounted: bool = True,
    joint: Joint = ANKLE,
) -> dict[str, Gaussian]:
    """The priors of all nuisances, by parameter.

    `nuisances` is ``"all"``, ``"none"``, or other priors, (mean, sd), for groups or parameters; the
    rest keep theirs. A standard deviation of 0 takes one out.
    `quiet` is the level of each electrode at its quietest, in the EMG's unit: the priors of EMG at
    rest are in parts of it. Where it is zero, or not given, that is taken for known.
    `measured`: the geometry is the person's own, so that its priors are narrower.
    `mounted`: a device holds the foot; a torque of inverse dynamics has neither axis nor plate,
    unless `nuisances` give them.
    A `joint` may have other priors; `nuisances` come before them.
    """
    if nuisances == NONE:
        return {}
    priors: dict[str, Gaussian] = {}
    for n in _NUISANCES.values():
        none = n.of_device and not mounted
        priors |= {
            name: _NOTHING if none else n.prior_of.get(name, n.prior) for name in n.parameters
        }
        priors |= n.measured if measured else {}
    given: Mapping[str, tuple[float, float]] = {}
    if not isinstance(nuisances, str):
        given = nuisances
    elif nuisances != ALL:
        raise InputError(f"nuisances is {nuisances!r}; use 'all', 'none' or a mapping")
    for name, pair in (*joint.nuisances.items(), *given.items()):
        names = GROUPS.get(name, (name,))
        if not set(names) <= priors.keys():
            known = ", ".join((*GROUPS, *(n for g in GROUPS.values() for n in g)))
            raise InputError(f"nuisances: no {name!r}; use one of: {known}")
        try:
            mean, sd = (float(number) for number in pair)
        except (TypeError, ValueError):
            raise InputError(f"nuisances: {name} is {pair!r}; give mean and sd") from None
        if not (abs(mean) < float("inf") and 0 <= sd < float("inf")):
            raise InputError(f"nuisances: {name} is {pair!r}; give a finite mean, and sd from 0")
        for each in names:
            priors[each] = Gaussian(mean, sd, priors[each].off)
    for name, level in zip(GROUPS["rest"], quiet or (0.0,) * 4, strict=True):
        rest = priors.pop(name)  # EMG at rest follows, in its unit
        priors[name] = Gaussian(rest.mean * level, rest.sd * level)
    return {name: prior for name, prior in priors.items() if prior.sd > 0}


def group_of(name: str) -> str | None:
    """The group of a nuisance; None for a parameter of the leg."""
    return next((group for group, names in GROUPS.items() if name in names), None)
