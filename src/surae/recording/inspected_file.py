"""A file as it is inspected: with the times that offer themselves, and its first trial alone."""

from collections.abc import Mapping
from dataclasses import dataclass

from surae.base.errors import InputError
from surae.recording.table import Clock, Column, Table, load_each
from surae.recording.times import timed_by
from surae.recording.trials import TrialsInFile, one_trial, trials_in


@dataclass(frozen=True, slots=True)
class InspectedFile:
    """What is looked at of a file, and how it was arranged."""

    table: Table  #: Of one trial, with times if there are any.
    columns: Mapping[str, Column | InputError]  #: Its columns, or why they cannot be read.
    clock: Clock | None = None  #: The times that no name says.
    trials: TrialsInFile | None = None  #: The trials, where they are several.


def arranged(table: Table) -> InspectedFile:
    """A file's table as a mapping of it would have it read."""
    where = table.file
    trials = trials_in(table)
    if trials is not None and trials.how == "group":
        table = one_trial(table, trials.choices[0], where)
    clock = table.offered if table.offered is not None and table.offered.unit else None
    if clock is not None:
        table = timed_by(table, clock.column, clock.unit, where)
    columns = load_each(table, table.names)
    if trials is None or trials.how != "group":
        trials = trials_in(table, columns)
        if trials is not None:
            table = one_trial(table, trials.choices[0], where)
            columns = load_each(table, table.names)
    return InspectedFile(table, columns, clock, trials)
