"""Several trials in one file: told apart by a column, by groups of columns, or by times.

Trials are never joined: what a file holds of several is named, and a mapping says which is read, or
reads each as a recording of its own.
"""

from collections.abc import Callable, Iterable, Mapping, Sequence
from dataclasses import dataclass, replace
from typing import Literal

import numpy as np

from surae.base.errors import InputError
from surae.base.frozen import freeze
from surae.recording.described import EACH, MappedTrial, toml_value
from surae.recording.roles import WORDS, words_of
from surae.recording.table import (
    FEWEST_SAMPLES,
    MOST_TRIALS,
    Column,
    IndexArray,
    Table,
    fallbacks,
    regular,
    some,
)
from surae.recording.times import counts
from surae.recording.trial_groups import groups_of, of_group

_WORDS, _FRAMES = (set(WORDS[each]) for each in ("trial", "frames"))
_BESIDE = {"id", "no", "nr", "number", "index", "num", "name", "nummer", "numero", "label", "i"}
#: More trials than these in a file are none; one has so many samples at least.
_MOST = MOST_TRIALS
_FEWEST = FEWEST_SAMPLES


class SeveralTrialsError(InputError):
    """A file holds several trials, of which none was chosen."""


@dataclass(frozen=True, slots=True)
class TrialsInFile:
    """The trials in one file."""

    how: Literal["column", "group", "index"]  #: What tells them apart.
    names: tuple[str, ...]  #: What they are called: the column's values, the groups, their numbers.
    column: str = ""  #: That column.
    falls: int = 0  #: How often the time falls back.
    sheets: bool = False  #: Whether the groups are sheets of a workbook.
    frames: bool = False  #: Whether a count of frames falls back, where there are no times.

    @property
    def text(self) -> str:
        """How many they are, and by what they are told apart."""
        few = ", ".join(self.names[:8]) + ", …" * (len(self.names) > 8)
        back = f"; the time falls back {_times(self.falls)}" if self.falls else ""
        by = {
            "column": f"told apart by column {self.column!r} ({few}){back}",
            "group": f"{'a sheet' if self.sheets else 'a group'} each ({few})",
            "index": f"one below the other: the {'count of frames' if self.frames else 'time'} "
            f"falls back {_times(self.falls)}",
        }[self.how]
        return f"{len(self.names)} trials in one file, {by}"

    @property
    def line(self) -> str:
        """What a mapping says to read each of them."""
        return {
            "column": f"{{ column = {toml_value(self.column)} }}",
            "group": f"{{ {'sheet' if self.sheets else 'group'} = {toml_value(EACH)} }}",
            "index": f"{{ index = {toml_value(EACH)} }}",
        }[self.how]

    @property
    def choices(self) -> tuple[MappedTrial, ...]:
        """What a mapping says of each."""
        count = range(1, len(self.names) + 1)
        if self.how == "column":
            return tuple(MappedTrial(column=self.column, index=k) for k in count)
        if self.how == "group":
            return tuple(MappedTrial(group=name) for name in self.names)
        return tuple(MappedTrial(index=k) for k in count)


def _times(n: int) -> str:
    return "once" if n == 1 else f"{n} times"


def trials_in(
    table: Table, columns: Mapping[str, Column | InputError] | None = None
) -> TrialsInFile | None:
    """The trials that a file holds; None where it is one.

    `columns` are its columns where they have been loaded.
    """
    if groups := groups_of(table.names):
        sheets = table.format == "Excel" and ": " in "".join(table.names)
        return TrialsInFile("group", tuple(groups), sheets=sheets)
    by_name = [name for name in table.names if _is_trial(name)]
    for name in by_name:
        runs = _runs_of(table, name)
        if runs is not None and len(runs) > 1:
            return TrialsInFile("column", tuple(runs), name, _falls_of(table, name))
    every = [c for c in (columns or {}).values() if isinstance(c, Column)]
    loaded = [c for c in every if c.time_name]
    if not loaded:
        backs = frames_begin_again(every)
        names = tuple(str(k) for k in range(1, len(backs) + 2))
        return TrialsInFile("index", names, falls=len(backs), frames=True) if len(backs) else None
    backs = fallbacks(loaded[0].time)
    if not len(backs):
        return None
    for column in loaded:  # a column that changes where the time falls back
        if len(column.values) != len(loaded[0].time) or not _constant(column, backs):
            continue
        labels = _labels(table, column.name)
        if labels is not None and np.array_equal(labels[1], [0, *backs]):
            return TrialsInFile("column", tuple(labels[0]), column.name, len(backs))
    names = tuple(str(k) for k in range(1, len(backs) + 2))
    return TrialsInFile("index", names, falls=len(backs))


def frames_begin_again(columns: Iterable[Column]) -> IndexArray:
    """First samples of all trials but the first, by a count of frames; empty where none falls back.

    Counters of packets begin again too, and are no frames.
    """
    for column in columns:
        if {*words_of(column.name)} & _FRAMES and counts(column.values):
            return fallbacks(column.values)
    return np.empty(0, dtype=np.intp)


def _constant(column: Column, backs: IndexArray) -> bool:
    """Whether a column is one number in each trial, or holds words."""
    pieces = np.split(column.values, backs)
    return all(np.ptp(each) == 0.0 or np.isnan(each).all() for each in pieces)


def _is_trial(name: str) -> bool:
    """Whether a column's name says that it counts trials."""
    words = {*words_of(name)} - _BESIDE
    return bool(words) and words <= _WORDS | {"s"}


def _texts(table: Table, name: str) -> Sequence[str]:
    if table.cells is not None:
        return table.cells(name)
    try:
        return [f"{value:g}" for value in table.load([name])[name].values]
    except InputError:
        return []


def _labels(table: Table, name: str) -> tuple[list[str], IndexArray] | None:
    """What a column says of every run of equal cells, and the first sample of each."""
    cells = np.array(_texts(table, name))
    if len(cells) < 2 * _FEWEST:
        return None
    first = np.flatnonzero(np.concatenate(([True], cells[1:] != cells[:-1])))
    if len(first) > _MOST or np.diff([*first, len(cells)]).min() < _FEWEST:
        return None
    labels: list[str] = []
    for text in cells[first].tolist():
        again = sum(label == text or label.startswith(f"{text} (") for label in labels)
        labels.append(f"{text or 'unnamed'} ({again + 1})" if again else text or "unnamed")
    return labels, first


def _runs_of(table: Table, name: str) -> list[str] | None:
    labels = _labels(table, name)
    return None if labels is None else labels[0]


def _falls_of(table: Table, name: str) -> int:
    if not table.time_name:
        return 0
    try:
        return len(fallbacks(table.load([name])[name].time))
    except InputError:
        return 0


def chosen_trials(table: Table, chosen: MappedTrial, where: str) -> TrialsInFile:
    """The trials that a mapping tells apart; refused where it tells none apart."""
    if chosen.inside is not None:
        if not (groups := groups_of(table.names)):
            raise InputError(
                f"{where}: trial: {table.file} has no groups that each hold a recording; its "
                f"columns are: {some(table.names)}"
            )
        return TrialsInFile("group", tuple(groups))
    if chosen.column is not None:
        labels, _ = _by_column(table, chosen.column, where)
        return TrialsInFile("column", tuple(labels), chosen.column)
    labels, _ = _by_time(table, where)
    return TrialsInFile("index", tuple(labels))


def _by_column(table: Table, column: str, where: str) -> tuple[list[str], IndexArray]:
    if column not in table.names:
        raise InputError(
            f"{where}: trial: {table.file} has no column {some([column])}; it has: "
            f"{some(table.names)}"
        )
    labels = _labels(table, column)
    if labels is None:
        raise InputError(
            f"{where}: trial: column {column!r} of {table.file} does not tell trials apart: each "
            f"must be {_FEWEST} samples or more with one text or number"
        )
    return labels


def one_trial(table: Table, chosen: MappedTrial, where: str) -> Table:
    """The columns of one trial.

    Raises
    ------
    InputError
        There is no such trial.
    SeveralTrialsError
        There are several, and none is chosen.
    """
    if chosen.inside is not None:
        if chosen.several:
            raise _several(table, [*groups_of(table.names)], where)
        return of_group(table, chosen.inside, where)
    if chosen.column is not None:
        labels, first = _by_column(table, chosen.column, where)
        if chosen.index is None and chosen.value is None and len(labels) == 1:
            return table
    else:
        labels, first = _by_time(table, where)
    number = _number(chosen, labels, table, where)
    end = int(first[number + 1]) if number + 1 < len(first) else None
    names = tuple(name for name in table.names if name != chosen.column)
    return replace(_rows(table, int(first[number]), end), names=names)


def _by_time(table: Table, where: str) -> tuple[list[str], IndexArray]:
    """Trials that follow each other, by times that fall back."""
    for name in table.names:
        try:
            backs = fallbacks(table.load([name])[name].time)
        except InputError:
            continue
        if not table.time_name:
            backs = frames_begin_again(table.load(table.names).values())
        return [str(k) for k in range(1, len(backs) + 2)], np.array([0, *backs], dtype=np.intp)
    raise InputError(f"{where}: trial: {table.file} has no column that can be read")


def _number(chosen: MappedTrial, labels: Sequence[str], table: Table, where: str) -> int:
    """The place of the trial that is chosen, from 0."""
    few = some(labels)
    if chosen.several:
        raise _several(table, labels, where)
    if isinstance(chosen.index, int):
        if chosen.index > len(labels):
            raise InputError(
                f"{where}: trial: index is {chosen.index}, but {table.file} holds {len(labels)} "
                f"trials: {few}"
            )
        return chosen.index - 1
    wanted = chosen.value if isinstance(chosen.value, str) else f"{chosen.value:g}"
    for place, label in enumerate(labels):
        if label == wanted or _same_number(label, wanted):
            return place
    raise InputError(f"{where}: trial: no trial {wanted!r} is in {table.file}; it holds: {few}")


def _several(table: Table, names: Sequence[str], where: str) -> SeveralTrialsError:
    """That no trial was chosen of several."""
    return SeveralTrialsError(
        f"{where}: {len(names)} trials are in {table.file} ({some(names)}), each a recording of "
        "its own: surae fit, check and session take all of them; to read one, choose it in the "
        "mapping's trial, with value or index, or the name of its group"
    )


def _same_number(label: str, wanted: str) -> bool:
    try:
        return float(label) == float(wanted)
    except ValueError:
        return False


def _rows(table: Table, first: int, end: int | None) -> Table:
    """The samples from one to another of every column that is as long as its times."""

    def load(wanted: Sequence[str]) -> Mapping[str, Column]:
        made = {}
        for name, column in table.load(wanted).items():
            time, remark = regular(column.time[first:end]) if column.time_name else (None, "")
            made[name] = replace(
                column,
                time=freeze(np.array(column.time[: len(column.time[first:end])]))
                if time is None
                else freeze(np.array(time)),
                values=freeze(column.values[first:end]),
                position=lambda k, own=column: own.position(k + first),  # type: ignore[misc]
                reason=_later(column, first),
                remark="; ".join(dict.fromkeys(filter(None, (column.remark, remark)))),
            )
        return made

    return replace(table, load=load, retimed=None, cells=None)


def _later(column: Column, first: int) -> Callable[[int], str] | None:
    reason = column.reason
    return None if reason is None else lambda k: reason(k + first)
