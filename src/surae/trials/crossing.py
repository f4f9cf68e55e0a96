"""How well the parameters of one trial predict another: the figures, without the curves."""

from dataclasses import asdict, dataclass
from typing import Any


@dataclass(frozen=True, slots=True)
class Crossed:
    """How a fit follows a trial.

    Attributes
    ----------
    vaf : float or None
        Variance accounted for [%]; None where there is no prediction, and `reason` says why.
    r2 : float or None
        Centred R² [%]; None too where the trial's torque hardly changes, as in a passive hold.
    rmse, bias : float or None
        Root mean square and mean of measured minus predicted torque [Nm].
    fitted : bool
        The trial was in the fit: following it proves nothing.
    reason : str
        Why there is no prediction; empty where there is one.
    """

    vaf: float | None = None
    r2: float | None = None
    rmse: float | None = None
    bias: float | None = None
    fitted: bool = False
    reason: str = ""

    def as_dict(self) -> dict[str, Any]:
        """Plain data, units in the names."""
        plain = asdict(self)
        return plain | {"rmse_Nm": plain.pop("rmse"), "bias_Nm": plain.pop("bias")}

    @classmethod
    def from_dict(cls, data: dict[str, Any]) -> "Crossed":
        """The inverse of `as_dict`."""
        plain = dict(data)
        return cls(rmse=plain.pop("rmse_Nm"), bias=plain.pop("bias_Nm"), **plain)
