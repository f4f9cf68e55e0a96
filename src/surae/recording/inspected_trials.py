"""Several data files inspected: parts of one recording, or trials alike, and where they differ."""

import os
from collections import Counter
from collections.abc import Iterator, Mapping, Sequence
from dataclasses import dataclass, replace
from pathlib import Path

from surae.base.errors import InputError
from surae.base.files import PathLike, shown
from surae.recording.described import TRIAL, toml_value
from surae.recording.formats import trial_names
from surae.recording.inspected_channels import Inspection
from surae.recording.inspection import inspect
from surae.recording.mapping import Description
from surae.recording.mapping_text import mapping_text
from surae.recording.source import open_source
from surae.recording.table import some

#: Rates [Hz] that are the same but for rounding, relatively.
_SAME_RATE = 1e-3


@dataclass(frozen=True, slots=True)
class TrialDifference:
    """What is otherwise in one trial than in the others."""

    trial: str  #: Its name.
    text: str  #: In words.
    line: str = ""  #: The line of [trials] that says it in a mapping; empty where none can.


@dataclass(frozen=True, slots=True)
class InspectedTrials:
    """Trials of one layout, which one mapping describes."""

    typical: Inspection  #: Of the trial that most others are like.
    trials: tuple[str, ...]  #: Their names.
    #: What a mapping calls the files of the typical trial, ``"{trial}/ik.sto"``; empty where each
    #: trial is one file.
    files: Mapping[str, str]
    differences: tuple[TrialDifference, ...]  #: Where trials are not like that one.
    directions: tuple[str, ...]  #: How torque goes with the angle, in the trials in which it does.
    folder: str = "session"  #: Name of the folder that all of them are in.


def inspect_trials(
    paths: Sequence[PathLike], *, side: str | None = None
) -> Inspection | InspectedTrials:
    """Describe data files, and tell parts of one recording from trials of one layout.

    Files of the same names in several folders, and files that each hold an angle, are trials. Of
    several files those that are no recordings (notes, lists of events) or broken are set aside,
    and the advice names them. All else is as of `inspect`.

    Raises
    ------
    InputError
        None of them can be read.
    """
    if len(paths) == 1:
        return inspect(paths[0], side=side)
    single: dict[Path, Inspection] = {}
    aside: dict[Path, str] = {}
    for path in map(Path, paths):
        try:
            single[path] = inspect(path, side=side)
        except InputError as error:
            aside[path] = str(error).removeprefix(f"{shown(path)}: ").partition("; a recording")[0]
        else:
            unusable = single[path].unusable
            if not single[path].roles and unusable.keys() == single[path].open.keys() and unusable:
                del single[path]
                aside[path] = next(iter(unusable.values()))
            elif not (single[path].roles or single[path].open):
                columns = some([channel.column for channel in single.pop(path).channels], 3)
                aside[path] = f"no channel of an ankle: {columns}"
    if not single:
        path, why = next(iter(aside.items()))
        raise InputError(f"{shown(path)}: {why}")
    inspected = _of_several(single, side)
    lines = tuple(f"set aside: {shown(path)}: {why}" for path, why in aside.items())
    lines += tuple(_shared_mappings(single))
    if isinstance(inspected, Inspection):
        return replace(inspected, advice=(*inspected.advice, *lines))
    return replace(
        inspected, typical=replace(inspected.typical, advice=(*inspected.typical.advice, *lines))
    )


def _shared_mappings(single: Mapping[Path, Inspection]) -> Iterator[str]:
    """Mappings of one file that others have the columns of: each is offered for all."""
    for folder in dict.fromkeys(path.parent for path in single):
        for toml in sorted(folder.glob("*.toml")):
            try:
                description = Description.of(open_source(toml))
            except InputError:
                continue
            wanted = {channel.column for channel in description.mapped().channels.values()}
            if len(description.named) != 1 or description.patterns:
                continue
            mapped = Path(description.named[0]).name
            alike = [
                path
                for path, inspected in single.items()
                if path.parent == folder
                and path.name != mapped
                and wanted <= {channel.column for channel in inspected.channels}
            ]
            if alike:
                yield (
                    f"{shown(toml)} maps {mapped}, and {some([path.name for path in alike], 3)} "
                    f"{'has' if len(alike) == 1 else 'have'} the same columns: one mapping does "
                    f"for all of them, with --mapping {shown(toml)}"
                )


def _of_several(
    single: Mapping[Path, Inspection], side: str | None
) -> Inspection | InspectedTrials:
    """What several files are together, each of them inspected by itself."""
    paths = list(single)
    folders: dict[Path, list[Path]] = {}
    for path in paths:
        folders.setdefault(path.parent, []).append(path)
    alike = {tuple(sorted(path.name for path in files)) for files in folders.values()}
    groups = {shown(folder.name): files for folder, files in folders.items()}
    if len(folders) > 1 and len(alike) == 1 and len(groups) == len(folders):
        each = {name: inspect(parts, side=side) for name, parts in groups.items()}
        first = next(iter(folders.values()))
        return _together(each, [f"{TRIAL}/{path.name}" for path in first], paths)
    each = dict(zip(trial_names(paths), single.values(), strict=True))
    if 1 < len(each) == len(paths) and all(
        "angle" in (*trial.roles, *trial.open) for trial in each.values()
    ):
        return _together(each, [], paths)
    return next(iter(single.values())) if len(single) == 1 else inspect(paths, side=side)


def trials_text(inspected: InspectedTrials, folder: PathLike) -> str:
    """The mapping of all trials, to be in `folder`; what differs is a line each."""
    text = mapping_text(inspected.typical, folder, inspected.files, inspected.folder)
    lines = [text.rstrip("\n"), *(f"# {text}" for text in inspected.directions), ""]
    if written := [difference for difference in inspected.differences if difference.line]:
        lines.append("[trials]  # check: what differs in single trials")
        lines += [f"{each.line}  # {each.text}" for each in written]
    else:
        lines.append("# What differs in a single trial is a line in [trials], such as:")
        lines.append(f"# [trials]\n# {toml_value(inspected.trials[-1])}.torque.sign = -1")
    return "\n".join(lines) + "\n"


def _together(
    each: Mapping[str, Inspection], files: Sequence[str], paths: Sequence[PathLike]
) -> InspectedTrials:
    """Trials of one layout, compared with the one that most are like."""
    layouts = {  # which column is which signal in which unit
        name: tuple((role, c.column, c.known_unit) for role, c in trial.roles.items())
        for name, trial in each.items()
    }
    common = Counter(layouts.values()).most_common(1)[0][0]
    typical = next(name for name, layout in layouts.items() if layout == common)
    folder = os.path.commonpath([Path(path).resolve().parent for path in paths])
    return InspectedTrials(
        typical=each[typical],
        trials=tuple(each),
        files=dict(zip(each[typical].formats, files, strict=True)) if files else {},
        differences=tuple(
            difference
            for name, trial in each.items()
            for difference in _differences(name, trial, each[typical], typical)
        ),
        directions=tuple(f"{name}: {one.direction}" for name, one in each.items() if one.direction),
        folder=Path(folder).name or "session",
    )


def _differences(
    name: str, trial: Inspection, typical: Inspection, like: str
) -> list[TrialDifference]:
    differences: list[TrialDifference] = []
    columns = [channel.column for channel in trial.channels if channel.usable]

    def differs(text: str, line: str = "") -> None:
        whole = f"{toml_value(name)}.{line}" if line else ""
        differences.append(TrialDifference(name, text, whole))

    for role, channel in typical.roles.items():
        there = next((c for c in trial.channels if c.column == channel.column and c.usable), None)
        if there is None and (there := trial.roles.get(role)) is not None:
            text = f"{role} is column {there.column!r}, not {channel.column!r}"
            differs(text, f"{role}.column = {toml_value(there.column)}")
        if there is None:
            if role == "angle":  # which no trial can do without
                differs(f"no column {channel.column!r}: it has {some(columns)}")
            else:
                differs(f"no column {channel.column!r}", f"{role} = false")
            continue
        unit = there.known_unit
        its = channel.known_unit
        if unit is not None and its is not None and unit != its:
            differs(
                f"{role} is in {unit}, that of {like} in {its}", f"{role}.unit = {toml_value(unit)}"
            )
        its_rate = channel.rate_hz or 0.0
        if abs((there.rate_hz or 0.0) - its_rate) > _SAME_RATE * its_rate:
            rates = [f"{r:.6g} Hz" if r else "no rate" for r in (there.rate_hz, channel.rate_hz)]
            differs(f"{role} has {rates[0]}, that of {like} {rates[1]}")
    if None not in (trial.emg, typical.emg) and trial.emg != typical.emg:
        text = f"EMG looks {trial.emg}, that of {like} {typical.emg}"
        differs(text, f"emg = {toml_value(trial.emg)}")
    return differences
