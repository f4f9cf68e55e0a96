"""The documented switches of the models, with their allowed values."""

import math
from dataclasses import asdict, dataclass, fields
from numbers import Real
from typing import Any

from surae.errors import InputError
from surae.names import CHOICES


@dataclass(frozen=True, slots=True)
class ModelOptions:
    """How a model reads the parts of the thesis that leave a choice.

    Attributes
    ----------
    geometry : {"thesis", "virtual-work"}
        Muscle length: equation (9) as printed, or the integral of the moment arm.
    tendon_strain : {"thesis", "slack-length"}
        ε0 in metres as the printed equations take it, or a strain times the slack length.
    integrator : {"implicit", "explicit-euler"}
        Integrator of the muscle-tendon models; the explicit one is the thesis's.
    theta_foot : float
        Angle of the foot to the horizontal at θ = 0 [rad], equation (7).
    vmax_factor : float
        Maximum shortening speed in optimal lengths per second.
    x_ref_tri, x_ref_tib : float
        Muscle lengths at θ = 0 of the virtual-work geometry [m].
    emg_ref : tuple of float, or None
        EMG levels of TA, GL, SOL, GM [V] at which `emg_shape` changes nothing; the same for all
        recordings of a leg, e.g. `surae.signals.emg_levels` of them. Only `emg_shape` needs it.
    """

    geometry: str = "thesis"
    tendon_strain: str = "thesis"
    integrator: str = "implicit"
    theta_foot: float = 0.0
    vmax_factor: float = 8.0
    x_ref_tri: float = 0.080
    x_ref_tib: float = 0.100
    emg_ref: tuple[float, float, float, float] | None = None

    def __post_init__(self) -> None:
        """Refuse values that are not among the choices or not physical."""
        for name, allowed in CHOICES.items():
            value = getattr(self, name)
            if value not in allowed:
                raise InputError(f"option {name} is {value!r}; use one of: {', '.join(allowed)}")
        for name in ("theta_foot", "vmax_factor", "x_ref_tri", "x_ref_tib"):
            value = getattr(self, name)
            number = isinstance(value, Real) and not isinstance(value, bool)
            if not number or not math.isfinite(value):
                raise InputError(f"option {name} is {value!r}; give a finite number")
        for name in ("vmax_factor", "x_ref_tri", "x_ref_tib"):
            if getattr(self, name) <= 0:
                raise InputError(f"option {name} is {getattr(self, name)}; it must be positive")
        self._check_levels()

    def _check_levels(self) -> None:
        """Make a list of levels, as files hold it, a tuple."""
        if self.emg_ref is None:
            return
        given: object = self.emg_ref
        levels: list[Any] = list(given) if isinstance(given, list | tuple) else []
        numbers = [isinstance(v, Real) and not isinstance(v, bool) for v in levels]
        if len(levels) != 4 or not all(numbers) or not all(0 <= v < math.inf for v in levels):
            raise InputError(
                f"option emg_ref is {self.emg_ref!r}; give four levels in V, of TA, GL, SOL, GM"
            )
        object.__setattr__(self, "emg_ref", tuple(float(v) for v in levels))

    @classmethod
    def of(cls, **given: Any) -> "ModelOptions":
        """Make options of keywords.

        Raises
        ------
        InputError
            One is unknown; the message lists the known ones.
        """
        known = [field.name for field in fields(cls)]
        for name in given:
            if name not in known:
                raise InputError(f"unknown option {name!r}; known options: {', '.join(known)}")
        return cls(**given)

    def as_dict(self) -> dict[str, Any]:
        """The options as plain data, without those that are not given."""
        return {name: value for name, value in asdict(self).items() if value is not None}
