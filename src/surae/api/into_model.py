"""A fit's muscles in the user's own OpenSim model."""

import math
import os
from collections.abc import Mapping
from dataclasses import dataclass
from pathlib import Path

from surae.api import Fit, fit_of
from surae.base.errors import InputError
from surae.base.files import PathLike, shown, write_atomic
from surae.base.tables import TextTable
from surae.exchange.bounds import Bound, bounds_of, table_of
from surae.exchange.edited import EditedModel, changed, edited
from surae.exchange.into import STRENGTHS, Differences, LegForModel, leg_for_model
from surae.exchange.leg_in_model import leg_in_model
from surae.measures.fitted_leg import measured_range
from surae.measures.leg import GROUPS, Leg

#: EMG's weights of each group, and its channels.
_GAINS = {
    "tri": {"g2": "gl", "g3": "sol", "g4": "gm"},
    "tib": {"g1": "ta"},
}


@dataclass(frozen=True, slots=True, repr=False)
class ExportedIntoModel:
    """The user's OpenSim model with the muscles of a fit in it.

    Attributes
    ----------
    source : str
        The model's file, which is never written to.
    side : str
        ``"right"`` or ``"left"``.
    rms : float
        Root mean square of the difference between its muscles' torque and ours [Nm], held still.
    largest : float
        The largest of our torques there [Nm].
    over : Differences or None
        Differences over the recordings; None where the fit has none.
    warnings : tuple of str
        What is no longer anatomy, or not the fit's.
    bounds : tuple of Bound
        Parameters with their intervals.
    edited : EditedModel
        The file as it was and as it is.
    changes : tuple of tuple
        Muscle, property, before and after, of every number that changed.
    """

    source: str
    side: str
    rms: float
    largest: float
    over: Differences | None
    warnings: tuple[str, ...]
    bounds: tuple[Bound, ...]
    edited: EditedModel
    changes: tuple[tuple[str, str, str, str], ...]

    def __repr__(self) -> str:
        return f"The {self.side} leg in {self.source}. {self.agreement}"

    @property
    def text(self) -> str:
        """The model.

        Returns
        -------
        str
            As it is saved.
        """
        return self.edited.after.decode("utf-8", "replace")

    @property
    def difference(self) -> str:
        """The lines of the model that changed.

        Returns
        -------
        str
            As ``diff -u`` shows them.
        """
        return self.edited.difference

    @property
    def agreement(self) -> str:
        """How near the torque of the muscles is, in sentences.

        Returns
        -------
        str
            Held still, over the recordings, and what the foot makes.
        """
        part = 100.0 * self.rms / self.largest
        text = (
            f"Held still, muscles and joint in the model differ from ours by {self.rms:.3g} Nm rms "
            f"({part:.2g} % of the largest)."
        )
        if (over := self.over) is not None:
            text += (
                f" Over the recordings they differ by {over.muscles:.3g} Nm rms, of "
                f"{over.largest:.3g} Nm; the fit itself differs from what was measured by "
                f"{over.fit:.3g} Nm. Tissue that has not yet relaxed, which OpenSim has not, makes "
                f"{over.relaxation:.3g} Nm rms more; the model’s foot in place of the fit’s foot "
                f"and plate {over.foot:.3g} Nm rms."
            )
        return " ".join((text, *self.warnings))

    def as_table(self) -> TextTable:
        """What of the muscles changed.

        Returns
        -------
        TextTable
            A row for each number, before and after.
        """
        return TextTable(
            ("muscle", "property", "before", "after"), self.changes, numbers=("before", "after")
        )

    def save(self, path: PathLike) -> dict[str, str]:
        """Write the model, its difference and the table of bounds.

        Parameters
        ----------
        path : path
            The model to write; the others stand beside it, with ``.diff`` and ``.bounds.csv``.

        Returns
        -------
        dict of str to str
            Files by what they are.

        Raises
        ------
        InputError
            A file cannot be written, or would take the place of the model that was given.
        """
        files = files_beside(path)
        for each in files.values():
            if Path(each).exists() and Path(each).samefile(self.source):
                raise InputError(
                    f"{shown(each)} is the model that was given, which stays as it is; choose "
                    "another file"
                )
        write_atomic(files["model"], self.edited.after)
        write_atomic(files["difference"], self.difference)
        write_atomic(files["bounds"], table_of(list(self.bounds)))
        return files


def files_beside(path: PathLike) -> dict[str, str]:
    """Files of a model with a leg in it, by what they are, for the model's own name."""
    name = os.fspath(path)
    stem = name.removesuffix(".osim")
    return {"model": name, "difference": f"{stem}.diff", "bounds": f"{stem}.bounds.csv"}


def export_into(
    fit: Fit | PathLike,
    model: PathLike,
    *,
    side: str = "right",
    pose: Mapping[str, float] | None = None,
    strength: str = "model",
) -> ExportedIntoModel:
    """The muscles of a fit in the user's own OpenSim model, nothing else of which changes.

    The heads of the triceps surae and the tibialis anterior become ``DeGrooteFregly2016Muscle``
    with their own paths, fibres and pennation; tendon, curves and tissue are the fit's.

    Parameters
    ----------
    fit : Fit or path
        A fit, its file, or the folder of a session, whose joint fit is taken.
    model : path
        An ``.osim`` of format 4; it is read and stays as it is.
    side : {"right", "left"}
        Which leg of the model it is.
    pose : mapping of str to float, optional
        Coordinates at which the leg was measured [deg], such as the knee's; others have the
        model's default.
    strength : {"model", "measured"}
        Keep the model's largest forces, to which activity is scaled; or write the force of the
        largest activity that was measured.

    Returns
    -------
    ExportedIntoModel
        The model, what changed, and bounds; `save` writes them.

    Raises
    ------
    InputError
        A file cannot be read, the model has no such leg, or the fit's model no such muscles.

    Examples
    --------
    >>> surae.export("fit.json", to="osim", into="scaled.osim").save("leg.osim")
    """
    if strength not in STRENGTHS:
        raise InputError(f"strength is {strength!r}; use one of: {', '.join(STRENGTHS)}")
    given = fit_of(fit)
    result = given.result
    problem = result.problem
    leg = Leg(problem.spec, problem.options, result.values, problem.inputs)
    if "l0_tri" not in leg.values:
        raise InputError(
            f"{problem.spec.name} has no optimal lengths; fit `muscle` or `muscle-tendon`, and "
            "export that"
        )
    turned = {name: math.radians(value) for name, value in (pose or {}).items()}
    into = leg_in_model(model, side=side, pose=turned)
    made = leg_for_model(leg, measured_range(result), into, strength)
    measures = {m.name: m for m in given.measures().values()}
    bounds = tuple(bounds_of(made, measures, strength))
    comments = [*_comments(made, leg, strength), *_intervals(bounds)]
    return ExportedIntoModel(
        os.fspath(model),
        side,
        made.rms,
        made.largest,
        made.over,
        made.warnings,
        bounds,
        edited(made, comments),
        tuple(changed(made)),
    )


def _comments(made: LegForModel, leg: Leg, strength: str) -> list[str]:
    """What a reader of the model has to know, a sentence or two each."""
    low, high = (math.degrees(end) for end in made.moved)
    comments = [
        f"Muscles of the {made.into.side} leg as surae fitted them ({leg.spec.name}), true from "
        f"{low:.3g}° to {high:.3g}° of dorsiflexion. Paths, fibre lengths and pennation are the "
        "model's own; tendon, curves and tissue are the fit's.",
        "Tissue pulls along the paths as forces of its own, relaxed; before it relaxes it pulls "
        f"{1.0 / leg.relaxed:.3g} times as much.",
        "Activation is a filter of first order with the mean delay of the fit's, which is of "
        "second order."
        + (
            f" EMG comes {1e3 * leg.values['emd']:.0f} ms earlier: delay it."
            if leg.values.get("emd")
            else ""
        ),
    ]
    unit = "1" if leg.has_normalised_emg else "V"
    for group in GROUPS:
        names = ", ".join(of.head.name for of in made.heads if of.head.group == group)
        sums = " + ".join(
            f"{leg.values[gain] / made.peaks[group]:.6g}*emg_{channel}"
            for gain, channel in _GAINS[group].items()
            if gain in leg.values
        )
        comments.append(f"Excitation of each of {names}: {sums}, EMG's envelope in {unit}.")
    if strength == "model":
        comments.append(
            "Largest forces are the model's own: excitation is scaled to them. They were not "
            "measured."
        )
    else:
        comments.append(
            "Largest forces are those of the largest activity that was measured, which need not be "
            "the person's most."
        )
    return [leg.options.anatomy.worded(text) for text in comments]


def _intervals(bounds: tuple[Bound, ...]) -> list[str]:
    """Intervals of what was written, a line each."""
    lines = []
    for b in bounds:
        if b.low is None:
            continue
        high = "" if b.high is None else f"{b.high:.6g}"
        lines.append(
            f"{b.component} {b.name}: {b.nominal:.6g} {b.unit}, 95 % {b.low:.6g} to {high}, "
            f"{b.verdict} (by {b.known_by})"
        )
    return lines
