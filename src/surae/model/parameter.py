"""A parameter of a model, and what a joint, a geometry and the EMG's unit make of it."""

from collections.abc import Callable, Iterable, Mapping, Sequence
from dataclasses import astuple, dataclass, replace
from typing import TYPE_CHECKING, Any, Literal, NamedTuple

from surae.base.frozen import FrozenDict
from surae.base.units import FloatArray
from surae.model.joint import Value
from surae.model.options import ModelOptions
from surae.model.prior import Prior
from surae.recording import MUSCLES

if TYPE_CHECKING:
    from surae.signals import ModelInputs


class Added(NamedTuple):
    """A torque that is proportional to a parameter, whatever the muscles do."""

    #: What it belongs to, see `TorqueParts`.
    part: Literal["zero", "inertial", "gravitational", "joint"]
    of: Callable[["ModelInputs"], FloatArray]  #: Of one unit of the parameter [Nm], shape (n,).


@dataclass(frozen=True, slots=True)
class Parameter:
    """One parameter of a model."""

    name: str  #: The thesis's name, the same in files, figures and Python.
    unit: str  #: SI unit; ``"-"`` when dimensionless.
    meaning: str  #: What it is, in a few plain words.
    #: "limb", "passive", "active", "tendon", "measurement": Which part of the torque it acts on;
    #: the last are the laboratory's, not the leg's.
    group: str
    start: float  #: Where a fit starts, and the value of a tendon parameter that is left out.
    #: `lower`, `upper`: bounds of a fit.
    lower: float
    upper: float
    #: Whether any use of the model needs a value above zero; otherwise zero is allowed too.
    positive: bool = True
    signed: bool = False  #: Whether values below zero have a meaning as well.
    #: What to measure, or to fix, where it is not known well enough, as an imperative.
    advice: str = ""
    #: Its prior in each population; empty where a population has none.
    known: Mapping[str, Prior] = FrozenDict()
    #: Its prior of a leg of which nothing is known, where that is not the healthy one, widened.
    wide: Prior | None = None
    #: Range from which virtual subjects of each population are drawn.
    drawn: Mapping[str, tuple[float, float]] = FrozenDict()
    #: Whether a posterior is searched along it; otherwise along its logarithm.
    straight: bool = False
    #: In the virtual-work geometry, whose muscles travel about 2.8 times (triceps) and 1.5 times
    #: (tibialis) as far per radian.
    travel: Value | None = None
    strain: Value | None = None  #: Of ε0 as a strain, times the slack length (Thelen 2003).
    slack: float = 1.0  #: That slack length [m].
    torque: Added | None = None  #: The torque that it adds by itself.

    @property
    def off_at_zero(self) -> bool:
        """Whether what it stands for is not there at 0."""
        return self.lower <= 0.0 <= self.upper


#: What differs where the EMG is normalised (unit "1"): weights are forces, rest is a part of 1.
_NORMALISED: dict[str, dict[str, Any]] = {
    "N/V": {
        "unit": "N",
        "start": 1e3,
        "lower": 0.0,
        "upper": 2e4,
        "wide": Prior(1e3, 1.0, "assumed, a muscle's force at full effort; no measurement known"),
    },
    "V": {"unit": "-", "start": 0.0, "lower": -0.2, "upper": 0.2},
}


#: Which of TA, GL, SOL, GM a parameter in the EMG's unit is of: weights of the models, rest.
CHANNEL_OF: Mapping[str, int] = FrozenDict(
    {f"{weight}{k + 1}": k for weight in "ge" for k in range(len(MUSCLES))}
    | {f"emg_rest_{muscle}": k for k, muscle in enumerate(MUSCLES)}
)


def adapted(
    parameters: Iterable[Parameter],
    options: ModelOptions,
    emg_unit: str = "V",
    emg_sizes: Sequence[float] = (1.0, 1.0, 1.0, 1.0),
) -> dict[str, Parameter]:
    """The parameters by name, start, bounds, unit and priors adapted to options and EMG unit.

    Parameters
    ----------
    parameters : iterable of Parameter
        The model's parameters.
    options : ModelOptions
        The virtual-work geometry, and a table in which muscles travel as far, has other starts and
        bounds for lengths and stiffnesses; the tendon's ε0 is a length or a strain.
    emg_unit : {"V", "1"}
        Weights of a normalised envelope are in N and of another magnitude.
    emg_sizes : sequence of float
        How many times larger than usual the EMG of TA, GL, SOL, GM is, as `surae.signals.emg_sizes`
        finds it: a weight is smaller by as much, and a level at rest larger.
    """
    made = (_adapted(p, options, emg_unit) for p in parameters)
    return {p.name: _sized(p, emg_sizes) for p in made}


def _sized(p: Parameter, emg_sizes: Sequence[float]) -> Parameter:
    """A parameter in the EMG's unit for EMG of another size."""
    if (channel := CHANNEL_OF.get(p.name)) is None or emg_sizes[channel] == 1.0:
        return p
    factor = emg_sizes[channel] ** (1 if p.signed else -1)
    wide = None if p.wide is None else replace(p.wide, median=p.wide.median * factor)
    start, lower, upper = (factor * value for value in (p.start, p.lower, p.upper))
    return replace(p, start=start, lower=lower, upper=upper, wide=wide)


def _adapted(p: Parameter, options: ModelOptions, emg_unit: str) -> Parameter:
    joint = options.anatomy
    p = replace(p, meaning=joint.worded(p.meaning), advice=joint.worded(p.advice))
    if p.name in joint.parameters and not (emg_unit == "1" and p.unit in _NORMALISED):
        start, lower, upper, spread, source = astuple(joint.parameters[p.name])
        strained = p.strain is not None and options.tendon_strain == "slack-length"
        scale = joint.slack[p.name.endswith("tib")] if strained else 1.0
        return replace(
            p,
            unit="-" if strained else p.unit,
            start=start / scale,
            lower=lower / scale,
            upper=upper / scale,
            known=FrozenDict(),
            wide=Prior(start / scale, spread, source),
        )
    if p.travel is not None and options.travel == "virtual-work":
        usual, lower, upper, spread, source = astuple(p.travel)
        start = min(max(usual + _longer(options).get(p.name, 0.0), lower), upper)
        wide = Prior(usual, spread, source)
        return replace(p, start=start, lower=lower, upper=upper, known=FrozenDict(), wide=wide)
    if p.strain is not None and options.tendon_strain == "slack-length":
        start = p.strain.start
        lower = p.strain.lower
        upper = p.strain.upper
        known = FrozenDict(
            {of: replace(each, median=each.median / p.slack) for of, each in p.known.items()}
        )
        return replace(p, unit="-", start=start, lower=lower, upper=upper, known=known)
    if emg_unit == "1" and p.unit in _NORMALISED:
        return replace(p, **_NORMALISED[p.unit])
    return p


def _longer(options: ModelOptions) -> dict[str, float]:
    """By how much muscles of a table are longer than is assumed otherwise [m]."""
    table = options.geometry
    if isinstance(table, str) or not table.slack:
        return {}
    assumed = {"tri": options.x_ref_tri, "tib": options.x_ref_tib}
    rest = {group: table.rest(row) - assumed[group] for row, group in enumerate(assumed)}
    return {f"{of}_{group}": rest[group] for of in ("l0", "x0") for group in rest}
