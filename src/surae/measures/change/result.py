"""Two sessions compared: all differences, and the answer in a sentence."""

import math
from dataclasses import dataclass, field
from typing import Any

from surae.base.file_form import filed
from surae.base.formatting import NO_NUMBER, of_interval, significant
from surae.base.frozen import FrozenDict
from surae.base.records import Saved
from surae.base.tables import Tabular, TextTable
from surae.measures.compared import Quantities
from surae.measures.course import Series
from surae.measures.difference import ChangeVerdict, Difference

#: Columns of the table that hold numbers.
_NUMBERS = ("before", "after", "difference", "95 % interval", "would show")


@filed("before", "after", "legs", "is_withheld", sparse=("visits", "times", "series"))
@dataclass(frozen=True, slots=True, repr=False)
class Change(Tabular, Saved):
    """Two sessions compared."""

    #: `before`, `after`: what each fit brings.
    before: Quantities
    after: Quantities
    #: `measures`, `parameters`: by name.
    measures: FrozenDict[str, Difference]
    parameters: FrozenDict[str, Difference]
    multiplicity: str  #: How many were looked at, and what that does to the claims.
    sentence: str  #: The answer in one sentence: a `Message`, unless it was read from a file.
    #: Repeated baselines from which the spread between sessions was estimated; 0 without.
    baselines: int = 0
    legs: bool = False  #: Whether they are two legs, and not two sessions of one.
    #: Whether differences are shown and none is judged, for what they rest on is doubtful.
    is_withheld: bool = False
    #: Of more than two visits: names of all, when they were, and every measure at each.
    visits: tuple[str, ...] = ()
    times: tuple[float, ...] = ()
    series: FrozenDict[str, Series] = field(default_factory=FrozenDict)

    @property
    def changed(self) -> tuple[Difference, ...]:
        """What has changed, measures first."""
        every = (*self.measures.values(), *self.parameters.values())
        return tuple(d for d in every if d.verdict is ChangeVerdict.CHANGED)

    def to_dataframe(self) -> Any:
        """Every difference as a pandas DataFrame.

        Returns
        -------
        pandas.DataFrame
            A row each by name, measures first: both values, difference, ends of its interval,
            p, verdict and more; None where there is no number.

        Raises
        ------
        InputError
            pandas is not installed.
        """
        from surae.recording.frames import records_frame

        return records_frame({**self.measures, **self.parameters}, "of")

    def as_table(self) -> TextTable:
        """The table, as texts.

        Returns
        -------
        TextTable
            A row for each difference, then what cannot be compared, by reason.
        """
        rows = []
        reasons: dict[str, list[str]] = {}
        for d in (*self.measures.values(), *self.parameters.values()):
            if d.difference is None or d.ci95 is None:
                if d.before is not None or d.after is not None:
                    reasons.setdefault(d.note, []).append(d.name)
                continue
            values = [significant(math.nan if v is None else v, 3) for v in (d.before, d.after)]
            text = of_interval(d.difference, d.ci95)
            shown = NO_NUMBER
            verdict = NO_NUMBER
            if d.smallest is not None:
                shown = significant(d.smallest, 2)
                verdict = str(d.verdict)
            rows.append((d.name, *values, text.value, text.interval, shown, d.unit, verdict))
        sides = self.visits or [", ".join(s.recordings) for s in (self.before, self.after)]
        baselines = f"The spread between sessions is that of {self.baselines} baselines."
        return TextTable(
            ("of", *_NUMBERS, "unit", "verdict"),
            tuple(rows),
            above=(" → ".join(sides), self.sentence),
            below=(
                *(f"{reason}: {', '.join(names)}" for reason, names in reasons.items()),
                self.multiplicity,
                *([baselines] if self.baselines else []),
            ),
            numbers=_NUMBERS,
        )

    def as_dict(self) -> dict[str, Any]:
        """Plain data, as C.json has it."""
        return {
            **Saved.as_dict(self),
            "before": list(self.before.recordings),
            "after": list(self.after.recordings),
            "of": "legs" if self.legs else "sessions",
        }
