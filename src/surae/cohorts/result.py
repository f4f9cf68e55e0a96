"""What a cohort comes to, as a table, a file and a sentence."""

from dataclasses import dataclass
from typing import Any

from surae._version import __version__
from surae.base.formatting import estimate, significant
from surae.base.frozen import FrozenDict
from surae.base.records import Saved, to_plain
from surae.base.tables import Tabular, TextTable
from surae.cohorts.member import CohortMember
from surae.cohorts.quantity import Contrast, PooledQuantity
from surae.recording.frames import library, records_frame

#: Level of a claim, and sentences at most, of what was asked.
_LEVEL = 0.05
_MOST_SAID = 4
#: Legs of a group beside whose interval the errors that all fits share are no longer small: 94 %
#: of 300 differences were true with 20 legs a group, 57 % of 30 with 1,000 (benchmarks/cohort.py).
_MANY = 100


@dataclass(frozen=True, slots=True, repr=False)
class Cohort(Tabular, Saved):
    """A cohort: its members, and everything they have over all of them."""

    members: tuple[CohortMember, ...]
    pooled: FrozenDict[str, PooledQuantity]
    rounds: int = 0
    #: Least and largest angle [deg] that legs reached, where these differ; else None.
    reached: tuple[float, float] | None = None

    @property
    def note(self) -> str:
        """What is to be read with care: ranges that differ, and intervals of very many legs."""
        notes = []
        if self.reached is not None:
            low, high = self.reached
            notes.append(
                f"some legs were moved to {low:.1f}° and others to {high:.1f}°: what is of the end "
                f"of the range is compared at {low:.1f}°, which all reached"
            )
        if mixed := [p.name for p in self.pooled.values() if p.is_mixed]:
            notes.append(f"{', '.join(mixed)}: each leg over a range of its own, and these differ")
        most = max((e.k for p in self.pooled.values() for e in p.groups.values()), default=0)
        if most > _MANY:
            notes.append(
                f"with {most} legs in a group, intervals of means and differences are narrower "
                "than what all fits are wrong in alike: a small difference may be none"
            )
        return "; ".join(notes)

    def to_dataframe(self) -> Any:
        """Every group of every quantity as a pandas DataFrame.

        Returns
        -------
        pandas.DataFrame
            A row for each quantity and group, by both: number of legs, mean, standard error, ends
            of the 95 % interval, spread between legs.

        Raises
        ------
        InputError
            pandas is not installed.
        """
        groups = {p.name: records_frame(p.groups, "group") for p in self.pooled.values()}
        return library("pandas", "a DataFrame").concat(groups, names=["of"])

    @property
    def sentence(self) -> str:
        """The answer: how groups differ, or legs changed, in what was asked beforehand, or most."""
        comparisons = [
            (p, kind, key, c)
            for p in self.pooled.values()
            for kind, contrasts in (("groups", p.differences), ("sessions", p.changes))
            for key, c in contrasts.items()
        ]
        asked = [each for each in comparisons if each[0].asked]
        if not comparisons:
            return "There are no two groups, and no two sessions, of three legs each to compare."
        if asked:
            return " ".join(_said(*each) for each in asked[:_MOST_SAID])
        return _said(*min(comparisons, key=lambda each: each[3].p))

    def as_table(self) -> TextTable:
        """Every group, then differences and changes that are shown, and who is left out."""
        rows = []
        notes = []
        every = self.pooled.values()
        for p in every:
            for group, effects in p.groups.items():
                text = estimate(effects.mean, effects.se, effects.ci95)
                spread = significant(effects.between, 2)
                left_out = "; ".join(f"{count}: {why}" for why, count in p.left_out.items())
                rows.append(
                    (
                        p.name,
                        group or "all",
                        str(effects.k),
                        text.value,
                        text.interval,
                        spread,
                        p.unit,
                        p.over,
                        str(p.at_bound or ""),
                        left_out,
                    )
                )
            for kind, contrasts in (("differs", p.differences), ("changed", p.changes)):
                how = "asked beforehand" if p.asked else "exploratory: confirm it"
                notes += [
                    f"{p.name} {kind}, {key or 'all'}: {c.difference:.3g} {p.unit} "
                    f"({c.ci95[0]:.3g} … {c.ci95[1]:.3g}), p = {c.p:.2g}, {how}"
                    for key, c in contrasts.items()
                    if c.p < 0.05
                ]
        notes += [self.note] if self.note else []
        notes += [f"{m.row}: no fit ({m.missing})" for m in self.members if m.missing]
        if self.rounds:
            notes.append(f"every leg was fitted again with its population, {self.rounds} rounds")
        heads = (
            "of",
            "group",
            "legs",
            "mean",
            "95 % interval",
            "spread",
            "unit",
            "over",
            "at a bound",
            "left out",
        )
        above = (self.sentence,)
        return TextTable(heads, tuple(rows), above=above, below=tuple(notes), numbers=heads[2:6])

    def as_dict(self) -> dict[str, Any]:
        """Plain data, as C.json has it."""
        return {
            "surae": __version__,
            "note": self.note,
            "sentence": self.sentence,
            "legs": len({m.leg for m in self.members}),
            "missing": {m.row: m.missing for m in self.members if m.missing},
            "refit_rounds": self.rounds,
            "quantities": {
                p.name: {**to_plain(p), "legs": {leg.leg: to_plain(leg) for leg in p.legs}}
                for p in self.pooled.values()
            },
        }


def _said(p: PooledQuantity, kind: str, key: str, c: Contrast) -> str:
    """One contrast in a sentence: direction, amount, interval, and what would have been shown."""
    unit = "" if p.unit == "-" else f" {p.unit}"
    ends = f"95 % {c.ci95[0]:.2g} to {c.ci95[1]:.2g}{unit}".replace("-", "−")
    size = f"{abs(c.difference):.2g}{unit}"
    first, _, second = key.partition(" → ")
    how = "asked beforehand" if p.asked else "exploratory: confirm it"
    if c.p >= _LEVEL:
        of = (
            f"between {first} and {second}"
            if kind == "groups"
            else f"over sessions ({key or 'all'})"
        )
        half = 0.5 * (c.ci95[1] - c.ci95[0])
        return (
            f"{p.name}: no difference is shown {of}; it is {c.difference:.2g}{unit} ({ends}), and "
            f"one of {1.4 * half:.2g}{unit} would mostly have been shown ({c.k} legs)."
        ).replace("is -", "is −")
    more = "more" if c.difference > 0.0 else "less"
    where = (
        f"in {second} than in {first}"
        if kind == "groups"
        else f"in later sessions ({key or 'all'})"
    )
    return f"{p.name} is {more} {where}, by {size} ({ends}; p = {c.p:.2g}, {c.k} legs, {how})."
