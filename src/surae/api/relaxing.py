"""The relaxed leg: its curve from rest alone, measures, a figure and a page."""

from collections.abc import Mapping, Sequence
from dataclasses import dataclass
from datetime import datetime
from typing import TYPE_CHECKING, Any

from surae._version import __version__
from surae.api.given import AnyRecording, read_in, several
from surae.api.recordings import checks_for, explained
from surae.base.errors import InputError
from surae.base.files import PathLike, write_json
from surae.base.formatting import of_interval
from surae.base.frozen import FrozenDict
from surae.base.records import to_plain
from surae.base.setting import is_number
from surae.base.tables import Tabular, TextTable
from surae.inference.judging.of_data import of_recordings
from surae.inference.relaxed.build import curve_of
from surae.inference.relaxed.context import Laboratory
from surae.inference.relaxed.curve import RelaxedCurve
from surae.measures.at_rest import doubted_at_rest, rest_said
from surae.measures.measure import Measure
from surae.measures.relaxed_change import with_detectable_changes
from surae.measures.rest.judged import measures_of_rest
from surae.model.knowledge import Knowledge
from surae.recording import Recording, read
from surae.settings import FitSettings
from surae.signals import ModelInputs
from surae.signals.windows import parted

if TYPE_CHECKING:
    from matplotlib.axes import Axes

    from surae.report.output import Report

#: Angles at which torque and stiffness are given by default, and those that are possible [deg].
REST_ANGLES = (-10.0, 0.0, 10.0)
_MOST = 60.0


@dataclass(frozen=True, slots=True, repr=False)
class Relaxed(Tabular):
    """What the rest of one leg says: its curve, and measures of it.

    Attributes
    ----------
    curve : RelaxedCurve
        The posterior of torque over angle; its grade is of rest alone.
    measures : mapping of str to Measure
        With value, `ci95` at the ankle's own angle and `ci95_device` at the device's; one that
        rest does not tell has a reason instead.
    """

    curve: RelaxedCurve
    measures: FrozenDict[str, Measure]

    @property
    def findings(self) -> tuple[str, ...]:
        """What was met, in sentences, the gravest first.

        Returns
        -------
        tuple of str
            Empty where nothing was.
        """
        return self.curve.findings

    def as_table(self) -> TextTable:
        """The table, as texts.

        Returns
        -------
        TextTable
            A row for each measure that has a value, and why the others have none.
        """
        rows = []
        missing: dict[str, list[str]] = {}
        for m in self.measures.values():
            if m.value is None:
                missing.setdefault(m.note, []).append(m.name)
                continue
            text = of_interval(m.value, m.ci95)
            device = "" if m.ci95_device is None else of_interval(m.value, m.ci95_device).interval
            rows.append((m.name, text.value, text.interval, device, m.unit, str(m.verdict), m.note))
        return TextTable(
            ("measure", "value", "95 % interval", "device’s angle", "unit", "verdict", "note"),
            tuple(rows),
            above=rest_said(self.curve).lines,
            below=tuple(f"{', '.join(names)}: {why}" for why, names in missing.items()),
            numbers=("value", "95 % interval", "device’s angle"),
        )

    def to_dataframe(self) -> Any:
        """The measures as a pandas DataFrame, a row each by name.

        Returns
        -------
        pandas.DataFrame
            Value, unit, ends of the 95 % interval and of that at the device's angle, verdict,
            note; NaN where there is no number.
        """
        from surae.recording.frames import frame

        none = (None, None)
        rows = [
            {
                "measure": m.name,
                "value": m.value,
                "unit": m.unit,
                "low": (m.ci95 or none)[0],
                "high": (m.ci95 or none)[1],
                "device_low": (m.ci95_device or none)[0],
                "device_high": (m.ci95_device or none)[1],
                "verdict": str(m.verdict),
                "note": str(m.note),
            }
            for m in self.measures.values()
        ]
        return frame(rows, {}).set_index("measure")

    def plot(self, *, ax: "Axes | None" = None) -> "Axes":
        """Torque over angle: loading and unloading as measured, the curve with its band.

        Parameters
        ----------
        ax : Axes, optional
            Where to draw; made where none is given.

        Returns
        -------
        Axes
            To go on with.
        """
        from surae.api.plots import axes_of
        from surae.report.figures.relaxed import draw_relaxed
        from surae.report.language import words_in

        axes = axes_of(ax)
        draw_relaxed(axes, self.curve, self.measures, words_in("en"))
        return axes

    def report(self, path: PathLike, *, language: str = "en") -> None:
        """Write the page, HTML or by its ending PDF.

        Parameters
        ----------
        path : path
            Where to.
        language : str
            ``"en"``, ``"nl"``, ``"de"`` or ``"fr"``.

        Raises
        ------
        InputError
            The file cannot be written, or the language is not known.
        """
        self.page(language).write(path)

    def page(self, language: str = "en") -> "Report":
        """The page of it, to be written as HTML or PDF.

        Parameters
        ----------
        language : str
            As of `report`.

        Returns
        -------
        Report
            With its figure.
        """
        from surae.report.relaxed import relaxed_report  # matplotlib

        created = datetime.now().astimezone()
        return relaxed_report(self.curve, self.measures, created=created, language=language)

    def as_dict(self) -> dict[str, Any]:
        """Plain data, as R.json has it.

        Returns
        -------
        dict
            Grade, findings, measures, and the posterior of the curve.
        """
        curve = to_plain(self.curve)
        return {
            "surae": __version__,
            "grade": curve.pop("grade"),
            "findings": list(map(str, curve.pop("findings"))),
            "measures": to_plain(self.measures),
            "curve": curve,
        }

    def save(self, path: PathLike) -> None:
        """Write R.json.

        Parameters
        ----------
        path : path
            Where to.

        Raises
        ------
        InputError
            The file cannot be written.
        """
        write_json(path, self.as_dict())


def relaxed(
    recordings: AnyRecording | Sequence[AnyRecording],
    *,
    angles: Sequence[float] = REST_ANGLES,
    knowledge: Knowledge | None = None,
    mapping: PathLike | None = None,
    **corrections: Any,
) -> Relaxed:
    """The relaxed ankle of one leg, from the parts of its recordings in which no muscle works.

    Torque over angle is a flexible curve with relaxation, beside foot, plate and sensor; no model
    of muscles is in it. Rest is found by the EMG: near its noise, by what the leg itself can do.

    Parameters
    ----------
    recordings : Recording, ModelInputs, DataFrame or path, or a sequence of them
        Of one leg and mounting: passive trials, active ones with pauses, held angles.
    angles : sequence of float
        Where torque and stiffness are given [deg], of the ankle's own.
    knowledge : Knowledge, optional
        What the laboratory knows of the angle's zero and of the plate.
    mapping : path, optional
        A TOML that describes the columns of the files.
    **corrections
        What to put right in signals, as of `surae.read`.

    Returns
    -------
    Relaxed
        Curve, measures with 95 % intervals, findings; what rest does not tell has a reason.

    Raises
    ------
    InputError
        A recording cannot be read or has no torque, an angle is out of reach, or no trial rests.

    Examples
    --------
    >>> surae.relaxed("trial.csv").measures["torque_rise"].ci95
    """
    given = several(recordings)
    if not len(given):
        raise InputError("no recording is given; name one at least")
    for angle in angles:
        if not (is_number(angle) and abs(float(angle)) <= _MOST):
            raise InputError(f"angle {angle!r}: give degrees from −{_MOST:g} to {_MOST:g}")
    settings = FitSettings.of(knowledge=knowledge)
    measured = [_recording(each, mapping, corrections) for each in given]
    try:
        inputs = settings.inputs(parted(measured))  # as for a fit, which has the same curve
    except InputError as error:
        raise explained(error, measured) from None
    reasons = of_recordings(checks_for(settings, measured))
    curve = doubted_at_rest(curve_of(inputs, Laboratory.of(settings)), reasons)
    if not isinstance(curve, RelaxedCurve):
        raise InputError(f"{inputs[0].where}: {curve}")
    made = with_detectable_changes(measures_of_rest(curve, angles), curve, angles)
    by_name = FrozenDict((m.name, m) for m in made)
    return Relaxed(curve, by_name)


def _recording(
    given: AnyRecording, mapping: PathLike | None, corrections: Mapping[str, Any]
) -> Recording | ModelInputs:
    """What was given; a file is read."""
    if isinstance(given, str) or hasattr(given, "__fspath__"):
        return read(given, mapping=mapping, **corrections)  # type: ignore[arg-type]
    return read_in(given)


def inputs_of(given: Sequence[Any], settings: FitSettings | None = None) -> tuple[ModelInputs, ...]:
    """Recordings of a visit, prepared as for a fit."""
    settings = settings or FitSettings.of()
    return settings.inputs(parted([_recording(each, None, {}) for each in given]))
