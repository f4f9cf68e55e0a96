"""A fit as a model file of another simulator, with how far it may be believed."""

import math
from collections.abc import Mapping
from dataclasses import dataclass, replace

from surae.api import Fit, fit_of
from surae.api.into_model import ExportedIntoModel, export_into
from surae.base.errors import InputError
from surae.base.files import PathLike, write_atomic
from surae.exchange.joint import GAINS, JointModel, joint_of
from surae.exchange.mjcf import mjcf
from surae.exchange.osim import osim
from surae.inference import Assessment
from surae.measures.fitted_leg import measured_range
from surae.measures.leg import Leg

#: Format by name: how it is called, how its files end, and whether tissue is springs there.
FORMATS = {"osim": ("OpenSim", ".osim", False), "mjcf": ("MuJoCo", ".xml", True)}
_WRITERS = {"osim": osim, "mjcf": mjcf}


@dataclass(frozen=True, slots=True)
class ExportedModel:
    """A model file for another simulator."""

    to: str  #: Format of the file; one of "osim", "mjcf".
    text: str  #: The file.
    #: Root mean square of the difference between its torque and ours [Nm], held still over the
    #: range that was moved, at rest and at four activities of each muscle group.
    rms: float
    largest: float  #: The largest of our torques there [Nm].
    missing: tuple[str, ...]  #: Parameters of the fit that the file leaves out.
    missing_rms: float  #: Root mean square of the torque that these make over the recordings [Nm].
    #: By how much force-length curves are wider than the standard one, muscle by muscle; empty
    #: where the format has no such scale.
    widths: str = ""
    warnings: tuple[str, ...] = ()  #: What of the muscles is no longer anatomy.

    def __repr__(self) -> str:
        return f"{FORMATS[self.to][0]} model. {self.agreement}"

    @property
    def agreement(self) -> str:
        """How near the torque is, as a sentence or two."""
        name = FORMATS[self.to][0]
        part = 100.0 * self.rms / self.largest
        text = (
            f"Held still, the torque in {name} differs from ours by {self.rms:.3g} Nm rms "
            f"({part:.2g} % of the largest). Movement is not compared: there tissue relaxes, and "
            "muscles shorten along curves of their own."
        )
        if self.missing:
            text += (
                f" The file leaves out {', '.join(self.missing)}: over the recordings these make "
                f"{self.missing_rms:.3g} Nm rms more."
            )
        if self.widths:
            text += (
                " Optimal fibre lengths are the fit's; widths of the force-length curves are "
                f"scaled: {self.widths}."
            )
        return " ".join((text, *self.warnings))

    def save(self, path: PathLike) -> None:
        """Write the file; by custom an ``.osim`` or an ``.xml``."""
        write_atomic(path, self.text)


def export(
    fit: Fit | PathLike,
    *,
    to: str,
    into: PathLike | None = None,
    side: str = "right",
    pose: Mapping[str, float] | None = None,
    strength: str = "model",
) -> "ExportedModel | ExportedIntoModel":
    """The leg of a fit as a model of OpenSim or MuJoCo, with how far its torque is from ours.

    Parameters
    ----------
    fit : Fit or path
        A fit, its file, or the folder of a session, whose joint fit is taken.
    to : {"osim", "mjcf"}
        Whose model file: OpenSim's (4.5 or later) or MuJoCo's.
    into : path, optional
        An OpenSim model of one's own, in which the leg's muscles are written; it stays as it is.
    side : {"right", "left"}
        Which leg of that model it is.
    pose : mapping of str to float, optional
        Coordinates of that model at which the leg was measured [deg], such as the knee's.
    strength : {"model", "measured"}
        Whose largest forces its muscles have.

    Returns
    -------
    ExportedModel or ExportedIntoModel
        The file's text, and the difference of both torques; `save` writes it.

    Raises
    ------
    InputError
        The format is not known, the fit cannot be read, or its model has no such muscles.

    Examples
    --------
    >>> surae.export("fit.json", to="osim").save("leg.osim")
    """
    if to not in FORMATS:
        raise InputError(f"to is {to!r}; use one of: {', '.join(FORMATS)}")
    if into is not None:
        if to != "osim":
            raise InputError(f"into is a model of OpenSim, and to is {to!r}; give to='osim'")
        return export_into(fit, into, side=side, pose=pose, strength=strength)
    if pose or side != "right" or strength != "model":
        raise InputError("side, pose and strength are of the model that into names; give it too")
    given = fit_of(fit)
    result = given.result
    problem = given.result.problem
    leg = Leg(problem.spec, problem.options, result.values, problem.inputs)
    if "l0_tri" not in leg.values:
        raise InputError(
            f"{problem.spec.name} has no optimal lengths; fit `muscle` or `muscle-tendon`, and "
            "export that"
        )
    joint = joint_of(leg, measured_range(result), springs=FORMATS[to][2])
    near = ExportedModel(
        to,
        "",
        joint.rms,
        joint.largest,
        joint.missing,
        joint.missing_rms,
        joint.widths,
        joint.warnings,
    )
    said = [near.agreement, *_comments(joint, leg, to), *_values(given.assessment)]
    return replace(near, text=_WRITERS[to](joint, said))


def _comments(joint: JointModel, leg: Leg, to: str) -> list[str]:
    """What a reader has to know, a sentence or two each."""
    low, high = (math.degrees(end) for end in joint.moved)
    comments = [
        f"The ankle that surae fitted ({leg.spec.name}). It is true from {low:.3g}° to "
        f"{high:.3g}°, "
        "where the leg was moved; dorsiflexion is positive.",
        "The ground is the segment above the joint, upright. The foot is a point mass with the "
        "foot plate in it: take the plate's mass off for a leg without one.",
        "Muscles run straight across the joint, with the moment arms of the fit."
        + (
            " Lengths are along these lines, so that an optimal length is not the fit's where the "
            "fit's muscle does not lengthen by its arm."
            if FORMATS[to][2]
            else " Their optimal fibre length is the fit's; where the fit's muscle does not "
            "lengthen by its arm, the force-length curve is wider and the fibre faster instead."
        ),
        "Tissue is relaxed, without the relaxation of equation (10): before it relaxes it pulls "
        f"{1.0 / leg.relaxed:.3g} times as much.",
        "Activation is a filter of first order with the mean delay of ours, which is of second "
        "order."
        + (
            f" EMG comes {1e3 * leg.values['emd']:.0f} ms earlier: delay it."
            if leg.values.get("emd")
            else ""
        ),
    ]
    for muscle in joint.muscles:
        unit = "V" if not leg.has_normalised_emg else "1"
        channels = {"g1": "ta", "g2": "gl", "g3": "sol", "g4": "gm"}
        sums = " + ".join(
            f"{leg.values[gain] / muscle.scale:.6g}·emg_{channels[gain]}"
            for gain in GAINS[muscle.group]
        )
        comments.append(f"Excitation of {muscle.name}: {sums}, EMG's envelope in {unit}.")
    if leg.is_compliant and not FORMATS[to][2]:
        comments.append(
            "Its tendons find no balance at an activation of 0: keep it at 0.01 or above."
        )
    return [joint.anatomy.worded(text) for text in comments]


def _values(assessment: Assessment) -> list[str]:
    """The fit's parameters with their intervals, a line each."""
    lines = []
    for p in assessment.parameters.values():
        between = "" if p.ci95 is None else f", 95 % {p.ci95[0]:.6g} to {p.ci95[1]:.6g}"
        lines.append(f"{p.name} = {p.value:.6g} {p.unit}{between}, {p.verdict}: {p.meaning}")
    return lines
