"""Files of a session's trials, and the folder of its results: what is never touched there.

Its index, session.json, says which files are results of which run: only these are taken or
replaced, or go to its trash. Whatever else lies there is the user's.
"""

import itertools
import json
import re
from collections.abc import Collection, Iterable, Sequence
from pathlib import Path
from typing import Any

from surae.base.errors import InputError
from surae.base.files import PathLike, make_folder, natural_order, paths_of, read_bytes, shown
from surae.model.knowledge_file import SESSION_TOML
from surae.recording.described import TRIAL
from surae.recording.formats import trial_names
from surae.recording.mapping import Description
from surae.recording.reading import data_files_below, is_mapping, is_recording
from surae.recording.source import Source, open_source
from surae.signals import ModelInputs
from surae.trials.sorting import Trial

#: Why there is no joint fit where trials have errors.
TOO_FEW = "trials with an error are not fitted together, and fewer than two are left"
#: Names of what is in the folder.
INDEX = "session.json"
JOINT = "joint.json"
FITS = "fits"
TRASH = "trash"
REPORT = "report.html"
TABLE = "table.csv"
_SUMMARY = (INDEX, REPORT, TABLE)
#: What a run may move: fits of its own folder, nothing that a damaged index could name.
_FIT = re.compile(rf"{FITS}/[\w.+-]+\.json|{re.escape(JOINT)}")


def slug(name: str) -> str:
    """A trial's name as the name of a file."""
    return re.sub(r"[^\w.+-]+", "_", name).strip(".") or "trial"


def fit_name(trial: str) -> str:
    """The file of a trial's fit, from the folder."""
    return f"{FITS}/{slug(trial)}.json"


def index_of(folder: PathLike) -> dict[str, Any] | None:
    """The index of a folder; None where it has none of ours."""
    path = Path(folder) / INDEX
    if not path.is_file():
        return None
    try:
        data = json.loads(read_bytes(path))
    except (ValueError, InputError):
        return None
    return data if isinstance(data, dict) and data.get("format") == "surae session" else None


def results_in(folder: PathLike) -> frozenset[str]:
    """The fits that runs have put into a folder, by its index."""
    index = (index_of(folder) or {}).get("results", ())
    names = index if isinstance(index, list) else ()
    return frozenset(name for name in names if isinstance(name, str) and _FIT.fullmatch(name))


def claimed(folder: PathLike, trials: Sequence[Trial]) -> Path:
    """The folder for a session's results, made where it is missing.

    It is refused where the trials themselves lie in it, it holds a file that is no result and would
    be replaced, two fits would have one name, or it cannot be made.
    """
    root = Path(folder)
    names = _distinct(trial.name for trial in trials)
    _refuse_own(root, trials)
    ours = {*results_in(root), *(() if index_of(root) is None else _SUMMARY)}
    for name in (*_SUMMARY, JOINT, *names):
        if name not in ours and (root / name).exists():
            raise InputError(
                f"{shown(root / name)} is not a result of this session and would be replaced; "
                "give another folder"
            )
    make_folder(root / FITS)
    return root


def set_aside(folder: PathLike, present: Iterable[str]) -> None:
    """Move fits of earlier runs that are not of this one to the folder's trash."""
    for name in sorted(results_in(folder) - set(present)):
        path = Path(folder) / name
        trash = Path(folder) / TRASH
        if path.is_file():
            trash.mkdir(exist_ok=True)
            numbers = itertools.count(1)
            path.replace(next(t for k in numbers if not (t := trash / f"{k}-{path.name}").exists()))


def fit_in(folder: PathLike) -> Path:
    """The fit that stands for a session: the joint one, or the only one that there is.

    `folder` is what `surae session` wrote, or one with a joint.json alone.
    """
    root = Path(folder)
    index = index_of(root)
    if index is None:
        if (root / JOINT).is_file():
            return root / JOINT
        raise InputError(f"{shown(folder)}: this is no session: it has no {INDEX}; give a FIT.json")
    if index.get("joint"):
        return root / JOINT
    trials = index.get("trials")
    alone = [
        fit_name(each["name"])
        for each in (trials if isinstance(trials, list) else [])
        if isinstance(each, dict) and isinstance(each.get("name"), str) and each.get("fit")
    ]
    if len(alone) == 1:
        return root / alone[0]
    failed = index.get("failed")
    why = failed.get("joint") if isinstance(failed, dict) else None
    why = why or ("it was stopped" if index.get("interrupted") else "none was made")
    raise InputError(
        f"{shown(folder)}: {len(alone)} fits and no joint one ({why}); give the FIT.json to "
        "compare, or run `surae session` again"
    )


def require_own(folder: PathLike, inputs: Iterable[ModelInputs], trial: str = "") -> None:
    """Refuse a fit that lies in the folder of a session and is of other recordings.

    `trial` is the only one that it may be of; without it, any of the session's. The index knows
    their files; without an index, the folder's own recordings are asked.
    """
    root = Path(folder)
    index = index_of(root)
    listed = _tables((index or {}).get("trials"))
    trials = [each for each in listed if trial in ("", each.get("name"))]
    sums = {str(file.get("sha256")) for each in trials for file in _tables(each.get("files"))}
    names = {str(each.get("name")) for each in trials}
    if index is None:
        names = {path.stem for path in data_files_below(root)}
    for each in inputs:
        known = {file.sha256 for file in each.files}
        called = [each.name, *(Path(file.name).stem for file in each.files)]
        if known & sums or (
            not (known and sums) and any(_is_of(one, name) for one in called for name in names)
        ):
            continue
        if index is None and not any(map(is_recording, data_files_below(root))):
            return  # nothing beside the fit says whose it is
        raise InputError(
            f"{shown(root)}: the fit in it is of other recordings ({shown(each.name)[:60]}): files "
            "were exchanged; run `surae session` again, or give the FIT.json itself"
        )


def _tables(listed: object) -> list[dict[str, Any]]:
    """The tables in a list of a file that may be damaged."""
    return [e for e in listed if isinstance(e, dict)] if isinstance(listed, list) else []


def _is_of(recording: str, trial: str) -> bool:
    """Whether a recording's name is that of a trial, or of a part of it."""
    return recording == trial or recording.startswith(f"{trial}, ")


def _distinct(trials: Iterable[str]) -> tuple[str, ...]:
    """The names of all fits, of which no two are one file, on systems either that mind no case."""
    taken: dict[str, str] = {}
    for trial in trials:
        name = fit_name(trial).casefold()
        if name in taken:
            raise InputError(
                f"the fits of trials {taken[name]!r} and {trial!r} would both be "
                f"{fit_name(trial)}; rename one of the trials"
            )
        taken[name] = trial
    return tuple(map(fit_name, taken.values()))


def _refuse_own(root: Path, trials: Iterable[Trial]) -> None:
    """Refuse a folder in which files of the trials lie."""
    mine = {root.resolve(), (root / FITS).resolve()}
    for trial in trials:
        files = () if trial.recording is None else trial.recording.files
        for path in (*((trial.path,) if trial.path else ()), *(file.path for file in files)):
            place = Path(path).resolve()
            # A mapping may lie beside the results.
            if place.suffix != ".toml" and place.parent in mine and place.exists():
                raise InputError(
                    f"{shown(root)} holds the recordings themselves ({shown(place.name)}); give "
                    f"the results a folder of their own, as {shown(root / 'OUT')}"
                )


def trial_files(
    source: PathLike | Sequence[PathLike],
    description: Description | None = None,
    aside: Collection[Path] = (),
) -> dict[str, Path]:
    """The file of every trial by the trial's name, in the order of names.

    `source` is a folder, or the files themselves; the ``{trial}`` of a description says which files
    of a folder are meant. Files `aside` are no trials.
    """
    paths = [Path(path) for path in paths_of(source)]
    files: list[Path] = []
    for path in paths:
        files += _in_folder(path, description, aside) if path.is_dir() else [path]
    if not files:
        raise InputError(f"{', '.join(map(shown, paths))}: no recording is there")
    _refuse_several(paths, files)
    called = list(zip(trial_names(files), files, strict=True))
    if description is not None and description.patterns:
        # Any file of a trial stands for it, and a trial in parts has several.
        trials_of = {description.trial_of(path): path for path in reversed(files)}
        files = list(reversed(trials_of.values()))
        names = trial_names(files, [trial for trial, _ in reversed(trials_of)])
        called = list(zip(names, files, strict=True))
    trials: dict[str, Path] = {}
    for name, path in called:
        if name in trials:
            raise InputError(
                f"{shown(trials[name])} and {shown(path)} are both trial {name!r}; leave one out, "
                "or rename it"
            )
        trials[name] = path
    # Those that begin with a number come first.
    order = sorted(trials, key=lambda name: (not name[:1].isdigit(), natural_order(name)))
    return {name: trials[name] for name in order}


#: What BIDS calls the parts of a data set that are not of one visit of one person, in paths.
_BIDS = {"sub": "persons", "ses": "visits"}


def _refuse_several(given: Sequence[Path], files: Sequence[Path]) -> None:
    """Refuse a data set of several persons or visits: a session is one leg's, of one visit."""
    for entity, what in _BIDS.items():
        labels: dict[str, Path] = {}
        for path in files:
            of = [
                match[1]
                for part in (*path.parent.parts, path.name)
                if (match := re.match(rf"(?:.*_)?({entity}-[A-Za-z0-9]+)(?:_|$)", part))
            ]
            if of:
                labels.setdefault(of[-1], path)
        if len(labels) > 1:
            few = ", ".join(sorted(labels)[:4])
            raise InputError(
                f"{', '.join(map(shown, given))}: recordings of {len(labels)} {what} ({few}"
                f"{', …' if len(labels) > 4 else ''}); a session is one leg in one visit: give "
                f"the folder of one of them, such as {shown(next(iter(labels.values())).parent)}"
            )


def _in_folder(
    folder: Path, description: Description | None, aside: Collection[Path]
) -> list[Path]:
    """The files of a folder that are trials."""
    if description is not None and description.patterns:
        return list(description.files(folder))
    described: list[Path] = []
    named: set[Path] = set()
    if description is None:
        for path in sorted(folder.glob("*.toml")):
            if path.name != SESSION_TOML and is_mapping(source := open_source(path)):
                described.append(path)
                named |= set(_named_files(source))
    data = [p for p in data_files_below(folder) if p.resolve() not in {*named, *aside}]
    # What was recorded as a stream and converted since is one trial.
    converted = {p.stem for p in data if p.suffix.lower() in (".h5", ".hdf5")}
    data = [p for p in data if p.suffix.lower() != ".xdf" or p.stem not in converted]
    return [*described, *data]


def _named_files(source: Source) -> Iterable[Path]:
    """The data files that a mapping of one recording names."""
    try:
        files = Description.of(source).named
    except InputError:
        return ()
    for file in files:
        if TRIAL in file:
            raise InputError(
                f"{source.shown}: this mapping is of many files; give it with --mapping (mapping=…)"
            )
    return [(Path(source.path).parent / file).resolve() for file in files]
