"""What a measure is, and all of them, once: `surae measures` and their page are made of them."""

from collections.abc import Callable
from dataclasses import dataclass, field

from surae.measures import active, passive
from surae.measures.leg import Leg

#: A measure of a leg at a point, e.g. an angle in degrees; 0 where it has none.
Compute = Callable[[Leg, float], float]


@dataclass(frozen=True, slots=True)
class Definition:
    """One measure."""

    name: str  #: Without the point, which follows an ``@``.
    unit: str  #: Of its value.
    #: The function; its docstring has meaning, formula and source.
    compute: Compute = field(compare=False)
    #: Unit of the point it is evaluated at: ``"deg"`` for an angle; empty where there is none.
    at: str = ""
    #: Where it is evaluated by default; angles are the user's.
    points: tuple[float, ...] = (0.0,)
    is_angle: bool = False  #: Whether its value is an angle, of which 10 % mean nothing.
    of_recordings: bool = False  #: Whether it is made of the recordings and not of the leg alone.
    alone: str = ""  #: Why two sessions cannot be compared by it; empty where they can.

    @property
    def meaning(self) -> str:
        """What it is, in one sentence."""
        return _paragraphs(self.compute)[0]

    @property
    def formula(self) -> str:
        """How it is computed, and after whom."""
        return " ".join(_paragraphs(self.compute)[1:])

    def named(self, point: float) -> str:
        """The name with the point it is evaluated at."""
        return f"{self.name}@{point:g}{self.at}" if self.at else self.name


def _paragraphs(function: Compute) -> list[str]:
    text = (function.__doc__ or "").strip()
    return [" ".join(part.split()) for part in text.split("\n\n")]


_EFFORT = "it goes with the effort of each session"
_FILM = "another session films another fascicle"
_MOVEMENT = "it goes with the movement and effort of each session"
#: Why a measure in units of EMG cannot be compared between sessions.
ELECTRODES = (
    "the electrodes have no common reference; normalise the EMG of both sessions by maximum "
    "voluntary contractions"
)

_D = Definition
DEFINITIONS: tuple[Definition, ...] = (
    _D("passive_torque", "Nm", passive.passive_torque, "deg"),
    _D("passive_torque_tri", "Nm", passive.passive_torque_tri, "deg"),
    _D("passive_torque_tib", "Nm", passive.passive_torque_tib, "deg"),
    _D("passive_stiffness", "Nm/deg", passive.passive_stiffness, "deg"),
    _D("passive_stiffness_tri", "Nm/deg", passive.passive_stiffness_tri, "deg"),
    _D("passive_stiffness_tib", "Nm/deg", passive.passive_stiffness_tib, "deg"),
    _D("quick_stiffness", "Nm/deg", passive.quick_stiffness, "deg"),
    _D("slow_torque", "Nm", passive.slow_torque, "deg"),
    _D("slow_stiffness", "Nm/deg", passive.slow_stiffness, "deg"),
    _D("neutral_angle", "deg", passive.neutral_angle, is_angle=True),
    _D("slack_angle_tri", "deg", passive.slack_angle_tri, is_angle=True),
    _D("slack_angle_tib", "deg", passive.slack_angle_tib, is_angle=True),
    _D("relaxed_share", "%", passive.relaxed_share, "s", (10.0,)),
    _D("dissipated_energy", "mJ", passive.dissipated_energy),
    _D("active_torque_max_tri", "Nm", active.active_torque_max_tri, "deg",
       of_recordings=True, alone=_EFFORT),
    _D("active_torque_max_tib", "Nm", active.active_torque_max_tib, "deg",
       of_recordings=True, alone=_EFFORT),
    _D("torque_per_emg_tri", "Nm/mV", active.torque_per_emg_tri, alone=ELECTRODES),
    _D("torque_per_emg_tib", "Nm/mV", active.torque_per_emg_tib, alone=ELECTRODES),
    _D("optimal_angle_tri", "deg", active.optimal_angle_tri, is_angle=True),
    _D("optimal_angle_tib", "deg", active.optimal_angle_tib, is_angle=True),
    _D("active_stiffness", "Nm/deg", active.active_stiffness, "Nm", (20.0,)),
    _D("damping", "Nm·s/deg", active.damping, "Nm", (20.0,)),
    _D("activation_half_time", "ms", active.activation_half_time),
    _D("bandwidth", "Hz", active.bandwidth),
    _D("delay", "ms", active.delay),
    _D("reflex_gain", "Nm·s/deg", active.reflex_gain),
    _D("reflex_share", "%", active.reflex_share, of_recordings=True, alone=_MOVEMENT),
    _D("tissue_share", "%", active.tissue_share, of_recordings=True, alone=_MOVEMENT),
    _D("neural_share", "%", active.neural_share, of_recordings=True, alone=_MOVEMENT),
    _D("inertia_share", "%", active.inertia_share, of_recordings=True, alone=_MOVEMENT),
    _D("gravity_share", "%", active.gravity_share, of_recordings=True, alone=_MOVEMENT),
    _D("tissue_work_share", "%", active.tissue_work_share, of_recordings=True, alone=_MOVEMENT),
    _D("neural_work_share", "%", active.neural_work_share, of_recordings=True, alone=_MOVEMENT),
    _D("tendon_stiffness_tri", "N/mm", passive.tendon_stiffness_tri, "N", (500.0,)),
    _D("tendon_stiffness_tib", "N/mm", passive.tendon_stiffness_tib, "N", (100.0,)),
    _D("tendon_secant_tri", "N/mm", passive.tendon_secant_tri, of_recordings=True, alone=_EFFORT),
    _D("tendon_secant_tib", "N/mm", passive.tendon_secant_tib, of_recordings=True, alone=_EFFORT),
    _D("optimal_fascicle_tib", "mm", passive.optimal_fascicle_tib, of_recordings=True, alone=_FILM),
    _D("tendon_strain_tri", "%", passive.tendon_strain_tri, "N", (500.0,)),
    _D("tendon_strain_tib", "%", passive.tendon_strain_tib, "N", (100.0,)),
)  # fmt: skip
