"""A second opinion on what other programs have found of a person's muscles."""

import math
from collections.abc import Mapping, Sequence
from dataclasses import dataclass
from datetime import datetime
from typing import TYPE_CHECKING, Any

from surae._version import __version__
from surae.api.given import AnyRecording, read_in
from surae.base.errors import InputError
from surae.base.files import PathLike, write_json
from surae.base.tables import Tabular, TextTable
from surae.exchange.against_recording import AgainstRecording, against
from surae.exchange.foreign_result import ForeignResult
from surae.exchange.leg_in_model import leg_in_model
from surae.exchange.opinion import (
    JudgedValue,
    counted,
    disputed_said,
    judged,
    parts,
    recording_said,
    with_recording,
)
from surae.exchange.results import read_result
from surae.recording import read
from surae.settings import FitSettings
from surae.signals import ModelInputs

if TYPE_CHECKING:
    from surae.report.output import Report


@dataclass(frozen=True, slots=True, repr=False)
class JudgedResult:
    """One result with what is said of each of its values.

    Attributes
    ----------
    result : ForeignResult
        What was read.
    values : tuple of JudgedValue
        Every value, with its remarks.
    recording : AgainstRecording or None
        What the recording says of the muscles; None where none was given.
    """

    result: ForeignResult
    values: tuple[JudgedValue, ...]
    recording: AgainstRecording | None = None

    @property
    def counts(self) -> dict[str, int]:
        """How many values each kind of thing is said of.

        Returns
        -------
        dict of str to int
            By kind, the most frequent first.
        """
        return counted(self.values)


@dataclass(frozen=True, slots=True, repr=False)
class SecondOpinion(Tabular):
    """Which muscle parameters of other programs say something of the person, and which do not.

    Attributes
    ----------
    results : tuple of JudgedResult
        Each result that was given.
    """

    results: tuple[JudgedResult, ...]

    @property
    def summary(self) -> tuple[str, ...]:
        """What was found, a sentence for each result.

        Returns
        -------
        tuple of str
            How many values of how many, and of which kinds.
        """
        lines = []
        for each in self.results:
            met = [v for v in each.values if v.remarks]
            kinds = ", ".join(f"{n} {kind}" for kind, n in each.counts.items()) or "nothing"
            lines.append(
                f"{each.result.path} ({each.result.program}): of {len(each.values)} values "
                f"{len(met)} are not of the person, or doubtful: {kinds}"
            )
            lines += [f"  {note}" for note in each.result.notes]
            if each.recording is not None:
                lines.append(f"  {recording_said(each.recording)}")
                if (disputed := disputed_said(each.recording)) is not None:
                    lines.append(f"  {disputed}")
        return tuple(lines)

    def as_table(self) -> TextTable:
        """The values that something is said of, as texts.

        Returns
        -------
        TextTable
            A row for each, and how many others there are.
        """
        rows = []
        for each in self.results:
            for value in each.values:
                if value.remarks:
                    of = value.of
                    part = parts(of)
                    rows.append(
                        (
                            of.muscle,
                            of.parameter,
                            f"{of.value:.5g}",
                            of.unit,
                            "" if part is None else f"{part:.4g}",
                            ", ".join(value.kinds),
                            " ".join(str(r.sentence) for r in value.remarks),
                        )
                    )
        return TextTable(
            ("muscle", "parameter", "value", "unit", "of generic", "kind", "what is said"),
            tuple(rows),
            above=self.summary,
            numbers=("value", "of generic"),
        )

    def to_dataframe(self) -> Any:
        """Every value as a row of a pandas DataFrame.

        Returns
        -------
        pandas.DataFrame
            Program, muscle, parameter, value, unit, generic value, limits, kinds; NaN where there
            is no number.
        """
        from surae.recording.frames import frame

        rows = [
            {
                "program": each.result.program,
                "file": each.result.path,
                "muscle": value.of.muscle,
                "parameter": value.of.parameter,
                "value": value.of.value,
                "unit": value.of.unit,
                "generic": value.of.generic,
                "low": value.of.low,
                "high": value.of.high,
                "kinds": ", ".join(value.kinds),
            }
            for each in self.results
            for value in each.values
        ]
        return frame(rows, {})

    def as_dict(self) -> dict[str, Any]:
        """Plain data, as J.json has it.

        Returns
        -------
        dict
            Each result with its values and their remarks.
        """
        return {
            "surae": __version__,
            "results": [
                {
                    "path": each.result.path,
                    "program": each.result.program,
                    "model": each.result.model or None,
                    "mass_kg": each.result.mass,
                    "notes": list(each.result.notes),
                    "counts": each.counts,
                    "recording": None if each.recording is None else _told(each.recording),
                    "values": [_plain(value) for value in each.values],
                }
                for each in self.results
            ],
        }

    def save(self, path: PathLike) -> None:
        """Write J.json.

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

    def page(self, language: str = "en") -> "Report":
        """The page of it, to be written as HTML or PDF.

        Parameters
        ----------
        language : str
            ``"en"``, ``"nl"``, ``"de"`` or ``"fr"``.

        Returns
        -------
        Report
            The page.
        """
        from surae.report.opinion import opinion_report

        created = datetime.now().astimezone()
        given = [(each.result, each.values, each.recording) for each in self.results]
        return opinion_report(given, created=created, language=language)

    def report(self, path: PathLike, *, language: str = "en") -> None:
        """Write the page, HTML or by its ending PDF.

        Parameters
        ----------
        path : path
            Where to.
        language : str
            As of `page`.

        Raises
        ------
        InputError
            The file cannot be written, or the language is not known.
        """
        self.page(language).write(path)


def _told(of: AgainstRecording) -> dict[str, Any]:
    verdicts = of.verdicts()
    return {
        "path": of.recording,
        "r2": of.r2,
        "lag_s": of.lag,
        "told": [
            {
                "muscle": each.muscle,
                "parameter": each.parameter,
                "value": each.value,
                "drop": each.drop,
                "better": each.better,
                "gain": each.gain,
                "verdict": verdicts[each.muscle, each.parameter],
            }
            for each in of.told
        ],
    }


def _plain(value: JudgedValue) -> dict[str, Any]:
    of = value.of
    return {
        "muscle": of.muscle,
        "parameter": of.parameter,
        "value": of.value,
        "unit": of.unit,
        "generic": of.generic,
        "lower": of.low,
        "upper": of.high,
        "remarks": [{"kind": r.kind, "message": str(r.sentence)} for r in value.remarks],
    }


def _inputs(recording: AnyRecording, corrections: Mapping[str, Any]) -> ModelInputs:
    """A recording as fits take it."""
    given = recording
    if isinstance(given, str) or hasattr(given, "__fspath__"):
        given = read(given, **corrections)  # type: ignore[arg-type]
    return FitSettings.of().inputs([read_in(given)])[0]


def judge(
    results: PathLike | Sequence[PathLike],
    *,
    generic: PathLike | None = None,
    calibration: PathLike | None = None,
    recording: AnyRecording | None = None,
    model: PathLike | None = None,
    side: str = "right",
    pose: Mapping[str, float] | None = None,
    **corrections: Any,
) -> SecondOpinion:
    """A second opinion on muscle parameters that other programs have found.

    Parameters
    ----------
    results : path or sequence of them
        OpenSim models, NMSM's ``.osimx`` or ``muscleModelParameters.sto``, CEINMS' subjects,
        MuscleRedundancySolver's ``.mat``; or folders of them.
    generic : path, optional
        What a search began from, where a result does not say it: a model or result of the same
        muscles.
    calibration : path, optional
        CEINMS' set-up of its calibration, with the limits of its search.
    recording : Recording, DataFrame or path, optional
        Of that person's leg: how much of its torque such muscles can follow, and which of their
        lengths it tells.
    model : path, optional
        The OpenSim model on whose paths the muscles lie, where a result names none.
    side : {"right", "left"}
        Which leg was recorded.
    pose : mapping of str to float, optional
        Coordinates of the model at which it was recorded [deg], such as the knee's.
    **corrections
        What to put right in the recording, as of `surae.read`.

    Returns
    -------
    SecondOpinion
        Which values stand at limits, are generic ones or plain parts of them, or no human's.

    Raises
    ------
    InputError
        A file cannot be read, or is no such result.

    Examples
    --------
    >>> surae.judge("scaled.osim").to_dataframe()
    """
    given = [results] if isinstance(results, str) or hasattr(results, "__fspath__") else results
    if not len(given):
        raise InputError("no result is given; name one at least")
    began = None if generic is None else read_result(generic)
    inputs = None if recording is None else _inputs(recording, corrections)
    turned = {name: math.radians(value) for name, value in (pose or {}).items()}
    made = []
    for path in given:
        result = read_result(path, calibration=calibration)
        if began is not None:
            if not {v.muscle for v in result.values} & {v.muscle for v in began.values}:
                raise InputError(
                    f"{began.path}: it has none of the muscles of {result.path}; give the model "
                    "that this began from"
                )
            result = result.with_generic(began)
        values = judged(result)
        by_recording = None
        if inputs is not None:
            paths = model or result.model
            if not paths:
                raise InputError(
                    f"{result.path}: a recording speaks of muscles on their paths; give the "
                    "OpenSim model that they lie in (model)"
                )
            by_recording = against(result, leg_in_model(paths, side=side, pose=turned), inputs)
            values = with_recording(values, by_recording)
        made.append(JudgedResult(result, values, by_recording))
    return SecondOpinion(tuple(made))
