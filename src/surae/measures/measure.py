"""A measure of a fit and what it is worth, as plain data, and all of them as a file."""

from collections.abc import Iterator, Mapping
from dataclasses import dataclass
from pathlib import Path
from typing import Any

from surae._version import __version__
from surae.base.errors import InputError, UnknownNameError
from surae.base.file_form import filed
from surae.base.files import PathLike, csv_row, shown, write_atomic, write_json
from surae.base.formatting import in_a_line, nearest, of_interval
from surae.base.frozen import FrozenDict
from surae.base.records import to_plain
from surae.base.tables import Tabular, TextTable
from surae.inference import Adequacy, Grade, Verdict


@dataclass(frozen=True, slots=True)
class Reliability:
    """How well a measure tells people apart."""

    icc: float  #: Intraclass correlation, 0 to 1.
    people_sd: float  #: Standard deviation of people, in the measure's unit.
    source: str  #: Who was measured, how many, and where that is written.
    word: str  #: ``"poor"``, ``"moderate"``, ``"good"`` or ``"excellent"`` (Koo and Li 2016).


@filed("name", sparse=("from_deg", "to_deg", "ci95_device", "sdc_note"))
@dataclass(frozen=True, slots=True, repr=False)
class Measure:
    """One measure of a fit."""

    #: `name`, `unit`, `meaning`: as in `surae.measures.DEFINITIONS`, with its point in the name.
    name: str
    unit: str
    meaning: str
    value: float | None  #: None where there is none, and `note` says why.
    ci95: tuple[float, float] | None  #: 95 % interval, systematics included.
    #: 95 % interval of what another trial of this leg would give.
    ci95_repeat: tuple[float, float] | None
    #: ``identified``: within 10 % (of an angle within 2°), measured and of an adequate fit.
    verdict: Verdict
    note: str  #: The verdict in a plain sentence: a `Message`, unless it was read from a file.
    #: ``"linear"``: the interval is that of the covariance; ``"draws"``: of possible legs, as the
    #: measure bends too much for it; empty without an interval.
    method: str = ""
    #: `from_deg`, `to_deg`: what one over the range that was moved is taken over, by the device's
    #: angle [deg]; None for others.
    from_deg: float | None = None
    to_deg: float | None = None
    #: ``"rest"``: of the relaxed curve, which no muscle's parameter touches; ``"model"``: of a fit.
    basis: str = "model"
    #: 95 % interval at the angle as the device shows it, of one at a stated angle by rest, or that
    #: counts from the angle's zero; `ci95` has the error of that zero too.
    ci95_device: tuple[float, float] | None = None
    #: Smallest detectable change between two such visits of an unchanged leg, 1.96·√2·SEM, in the
    #: measure's unit; None where `sdc_note` says why.
    sdc: float | None = None
    sdc_note: str = ""
    #: How well it tells people apart; None where their spread is not known.
    reliability: Reliability | None = None

    def __repr__(self) -> str:
        if self.value is None:
            return f"{self.name}: {self.note}"
        return (
            f"{in_a_line(self.name, self.value, self.ci95, self.unit)}: {self.verdict}: {self.note}"
        )


@dataclass(frozen=True, slots=True)
class RestSaid:
    """What rest in the recordings says, as a whole."""

    grade: Grade | None = None  #: Of its curve, by rest alone; None where there is none.
    seconds: float = 0.0  #: Of rest.
    range_deg: tuple[float, float] | None = None  #: Angles of it by the device [deg].
    findings: tuple[str, ...] = ()  #: What was met, the gravest first.
    missing: str = ""  #: Why there is no curve.
    conflict: str = ""  #: What the muscles' fit says otherwise; it speaks against that alone.

    @property
    def lines(self) -> tuple[str, ...]:
        """What tables say above their rows."""
        if self.grade is None or self.range_deg is None:
            return (f"relaxed joint: by the model alone; {self.missing}",) if self.missing else ()
        low, high = (f"{each:.0f}°".replace("-", "−") for each in self.range_deg)
        rests = f"relaxed ankle: {self.grade}; {self.seconds:.3g} s of rest, {low} to {high}"
        return (rests, *self.findings, *filter(None, [self.conflict]))


@dataclass(frozen=True, slots=True, repr=False)
class Measures(Tabular, Mapping[str, Measure]):
    """The measures of a fit by name.

    Attributes
    ----------
    model : str
        Name of the model.
    adequacy : Adequacy
        Of the fit; an inadequate one identifies no measure.
    by_name : mapping of str to Measure
        In the order of the table.
    rest : RestSaid
        What speaks for or against those with ``basis="rest"``, which the fit has no part in.
    """

    model: str
    adequacy: Adequacy
    by_name: FrozenDict[str, Measure]
    rest: RestSaid = RestSaid()

    def __getitem__(self, name: str) -> Measure:
        if name not in self.by_name:
            raise UnknownNameError(f"no measure {name!r}{nearest(name, self.by_name)}")
        return self.by_name[name]

    def __iter__(self) -> Iterator[str]:
        return iter(self.by_name)

    def __len__(self) -> int:
        return len(self.by_name)

    def as_table(self) -> TextTable:
        """The table, as texts.

        Returns
        -------
        TextTable
            A row for each measure that has a value, and why the others have none.
        """
        rows = []
        missing: dict[str, list[str]] = {}
        for m in self.values():
            if m.value is None:
                missing.setdefault(m.note, []).append(m.name)
            else:
                text = of_interval(m.value, m.ci95)
                judged = (str(m.verdict), m.basis, m.note)
                rows.append((m.name, text.value, text.interval, m.unit, *judged))
        of_fit = (f"{self.model}: {self.adequacy.grade}", *self.adequacy.reasons)
        return TextTable(
            ("measure", "value", "95 % interval", "unit", "verdict", "by", "note"),
            tuple(rows),
            above=(*of_fit, *self.rest.lines),
            below=tuple(f"{', '.join(names)}: {why}" for why, names in missing.items()),
            numbers=("value", "95 % interval"),
        )

    def to_dataframe(self) -> Any:
        """The measures as a pandas DataFrame.

        Returns
        -------
        pandas.DataFrame
            A row each by name: value, unit, ends of every interval, verdict and more; None where
            there is no number.

        Raises
        ------
        InputError
            pandas is not installed.
        """
        from surae.recording.frames import records_frame

        return records_frame(self.by_name, "measure")

    def as_dict(self) -> dict[str, Any]:
        """Plain data, as M.json has it."""
        adequacy = to_plain(self.adequacy)
        del adequacy["r2"]
        measures = to_plain(self.by_name)
        return {
            "surae": __version__,
            "model": self.model,
            "adequacy": adequacy,
            "rest": to_plain(self.rest),
            "measures": measures,
        }

    def save(self, path: PathLike) -> None:
        """Write M.json, or a table where the name ends in ``.csv``.

        Parameters
        ----------
        path : path
            Where to.

        Raises
        ------
        InputError
            The name ends otherwise, or the file cannot be written.
        """
        ending = Path(path).suffix.lower()
        if ending == ".json":
            write_json(path, self.as_dict())
        elif ending == ".csv":
            write_atomic(path, self.as_csv())
        else:
            raise InputError(f"{shown(path)}: measures are written as .json or .csv; give one")

    def as_csv(self) -> str:
        """A table with one row a measure."""
        head = (
            "measure",
            "value",
            "unit",
            "ci95_low",
            "ci95_high",
            "ci95_repeat_low",
            "ci95_repeat_high",
            "verdict",
            "note",
            "meaning",
            "basis",
            "ci95_device_low",
            "ci95_device_high",
        )
        none = (None, None)
        return csv_row(head) + "".join(
            csv_row(
                (
                    m.name,
                    m.value,
                    m.unit,
                    *(m.ci95 or none),
                    *(m.ci95_repeat or none),
                    str(m.verdict),
                    m.note,
                    m.meaning,
                    m.basis,
                    *(m.ci95_device or none),
                )
            )
            for m in self.values()
        )
