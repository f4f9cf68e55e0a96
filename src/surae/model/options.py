"""The documented switches of the models, with their allowed values."""

import math
from collections.abc import Mapping
from dataclasses import dataclass, fields
from importlib import import_module
from os import PathLike
from pathlib import Path
from typing import Any

from surae.base.errors import InputError
from surae.base.file_form import filed
from surae.base.formatting import check_known
from surae.base.names import CHOICES
from surae.base.setting import Request, documented, is_number, setting
from surae.base.words import N_
from surae.model.geometry_table import GeometryTable
from surae.model.joint import ANKLE, Joint
from surae.model.tissue_curve import TissueCurve


@filed(sparse=("emg_ref", "joint", "tissue"))
@documented
@dataclass(frozen=True, slots=True)
class ModelOptions(Request):
    """How a model reads the parts of the thesis that leave a choice.

    Attributes
    ----------
    {settings}
    tissue : TissueCurve, optional
        What the ankle's tissue has beside the exponentials of its muscles; a fit with ``auto``
        puts it there where its recordings' rest asks for it.
    """

    geometry: str | GeometryTable = setting(
        "thesis",
        "Muscle length: equation (9) as printed, the integral of the moment arm, or a "
        "table of lengths and moment arms; as a keyword also its file, see "
        "`surae.model.read_geometry`.",
        type='{"thesis", "virtual-work"}, path or GeometryTable',
        choices=CHOICES["geometry"],
        file=True,
        label=N_("Geometry"),
        help="How muscle length is read: as in the thesis, by virtual work, or a table of lengths "
        "and moment arms (CSV, OpenSim's MuscleAnalysis).",
    )
    tendon_strain: str = setting(
        "thesis",
        "ε0 in metres as the printed equations take it, or a strain times the slack length.",
        choices=CHOICES["tendon_strain"],
        help="How ε0 is read.",
        label=N_("Tendon strain"),
    )
    integrator: str = setting(
        "implicit",
        "How muscle-tendon models are integrated; explicit Euler is the thesis's, explicit-damped "
        "the same with a damper beside the muscle: no chatter, and some percent off.",
        choices=CHOICES["integrator"],
        label=N_("Integrator"),
    )
    theta_foot: float = setting(
        0.0,
        "Angle of the foot to the horizontal at θ = 0 [rad], equation (7).",
        metavar="RAD",
        help="Angle of the foot to the horizontal at 0 rad.",
        label=N_("Foot to horizontal at 0° [rad]"),
    )
    vmax_factor: float = setting(
        8.0,
        "Maximum shortening speed in optimal lengths per second.",
        above=0.0,
        metavar="F",
        label=N_("Maximum shortening speed [optimal lengths/s]"),
    )
    x_ref_tri: float = setting(
        0.080,
        "Virtual-work geometry: length of the triceps at θ = 0 [m].",
        above=0.0,
        metavar="M",
        label=N_("Virtual work: triceps at 0° [m]"),
    )
    x_ref_tib: float = setting(
        0.100,
        "Virtual-work geometry: length of the tibialis at θ = 0 [m].",
        above=0.0,
        metavar="M",
        label=N_("Virtual work: tibialis at 0° [m]"),
    )
    emg_ref: tuple[float, float, float, float] | None = setting(
        None,
        "EMG levels of TA, GL, SOL, GM [V] at which `emg_shape` changes nothing; the same "
        "for all recordings of a leg, e.g. `surae.signals.emg_levels` of them. Only `emg_shape` "
        "needs it.",
        type="four floats, or None",
    )
    joint: str | Joint = setting(
        "ankle",
        "The joint: the thesis's ankle, or another with a geometry of its own; as a "
        "keyword also its file, see `surae.model.read_joint`.",
        type='"ankle", path or Joint',
        choices=CHOICES["joint"],
        file=True,
        help="The joint: the ankle, or another by its file.",
    )
    tissue: TissueCurve | None = None

    def __post_init__(self) -> None:
        """Refuse values that are not among the choices or not physical; hold levels as a tuple."""
        Request.__post_init__(self)
        self._check_joint()
        curve: object = self.tissue
        if not (curve is None or isinstance(curve, TissueCurve)):
            raise InputError(f"tissue is {curve!r}; give a TissueCurve")
        if self.emg_ref is not None:
            given: object = self.emg_ref
            levels: list[Any] = list(given) if isinstance(given, list | tuple) else []
            numbers = all(map(is_number, levels)) and all(0 <= v < math.inf for v in levels)
            if len(levels) != 4 or not numbers:
                rule = "give four levels in V, of TA, GL, SOL, GM"
                raise InputError(f"emg_ref is {self.emg_ref!r}; {rule}")
            object.__setattr__(self, "emg_ref", tuple(map(float, levels)))

    def _check_joint(self) -> None:
        """Lengths and arms of the thesis are the ankle's."""
        if isinstance(self.joint, str) or self.joint == ANKLE:
            return
        if not isinstance(self.geometry, GeometryTable):
            raise InputError(f"joint {self.joint.name!r} needs its geometry: give the file of one")
        if not self.geometry.slack:
            for group, slack in enumerate(self.joint.slack):
                if self.geometry.rest(group) <= slack:
                    raise InputError(
                        f"{self.geometry.name}: the {self.joint.groups[group]} with their tendon "
                        f"are no longer than the tendon's slack length, {slack:g} m; give their "
                        "length, not only the moment arm"
                    )

    @classmethod
    def of(cls, **given: Any) -> "ModelOptions":
        """Make options of keywords.

        Parameters
        ----------
        **given
            Fields by name; a table or a joint by its file too.

        Returns
        -------
        ModelOptions
            The others as they are by default.

        Raises
        ------
        InputError
            One is unknown; the message lists the known ones.
        """
        known = [field.name for field in fields(cls)]
        for name in given:
            check_known("option", known, name)
        return cls(**with_files(given))

    @property
    def anatomy(self) -> Joint:
        """The record of the joint."""
        return ANKLE if isinstance(self.joint, str) else self.joint

    @property
    def travel(self) -> str:
        """The named geometry in which muscles travel about as far; which starts and priors hold."""
        if isinstance(self.geometry, GeometryTable):
            return CHOICES["geometry"][self.geometry.travels_far]
        return self.geometry

    def as_dict(self) -> dict[str, Any]:
        """The options as plain data, without those that are not given."""
        from surae.base.records import to_plain

        return dict(to_plain(self))


def with_files(given: Mapping[str, Any]) -> dict[str, Any]:
    """Keywords with the geometry and the joint that they name as a file, or hold as plain data."""
    read = dict(given)
    for name, kind in (("geometry", GeometryTable), ("joint", Joint), ("tissue", TissueCurve)):
        value = given.get(name)
        if isinstance(value, Mapping):
            from surae.base.records import from_plain

            read[name] = from_plain(kind, value)
        elif not isinstance(value, str | PathLike) or value in CHOICES.get(name, (value,)):
            continue  # what has no named choices is read from no file
        elif Path(value).suffix or Path(value).is_file():
            # readers need NumPy, and options do not
            home = import_module("surae.model")
            read[name] = getattr(home, f"read_{name}")(value)
    return read
