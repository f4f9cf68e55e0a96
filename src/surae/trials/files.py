"""Which files of a folder are trials, and how each is called."""

from collections import Counter
from collections.abc import Iterable, Sequence
from pathlib import Path

from surae.errors import InputError
from surae.files import PathLike, natural_order, paths_of, shown
from surae.recording.formats import data_files
from surae.recording.mapping import Description
from surae.recording.mapping_reader import TRIAL
from surae.recording.reading import is_mapping
from surae.recording.source import Source, open_source


def trial_files(
    source: PathLike | Sequence[PathLike], description: Description | None = None
) -> dict[str, Path]:
    """The file of every trial by the trial's name, in the order of names.

    `source` is a folder, or the files themselves; the ``{trial}`` of a description says which files
    of a folder are meant.
    """
    paths = [Path(path) for path in paths_of(source)]
    files: list[Path] = []
    for path in paths:
        files += _in_folder(path, description) if path.is_dir() else [path]
    if not files:
        raise InputError(f"{', '.join(map(shown, paths))}: no recording is there")
    called = [(path.stem, path) for path in files]
    if description is not None and description.patterns:
        # Any file of a trial stands for it, and a trial in parts has several.
        trials_of = {description.trial_of(path): path for path in reversed(files)}
        called = [(trial, path) for (trial, _), path in reversed(trials_of.items())]
    names = [name for name, _ in called]
    twice = {name for name, count in Counter(names).items() if count > 1}
    names = [f"{path.parent.name}-{name}" if name in twice else name for name, path in called]
    trials: dict[str, Path] = {}
    for name, (_, path) in zip(map(shown, names), called, strict=True):
        if name in trials:
            raise InputError(
                f"{shown(trials[name])} and {shown(path)} are both trial {name!r}; leave one out, "
                "or rename it"
            )
        trials[name] = path
    return {name: trials[name] for name in sorted(trials, key=_order)}


def _in_folder(folder: Path, description: Description | None) -> list[Path]:
    """The files of a folder that are trials."""
    if description is not None and description.patterns:
        return list(description.files(folder))
    described: list[Path] = []
    named: set[Path] = set()
    if description is None:
        for path in sorted(folder.glob("*.toml")):
            if (source := _mapping(path)) is not None:
                described.append(path)
                named |= set(_named_files(source))
    data = [path for path in data_files(folder) if path.resolve() not in named]
    # What was recorded as a stream and converted since is one trial.
    converted = {p.stem for p in data if p.suffix.lower() in (".h5", ".hdf5")}
    data = [p for p in data if p.suffix.lower() != ".xdf" or p.stem not in converted]
    return [*described, *data]


def _mapping(path: Path) -> Source | None:
    source = open_source(path)
    return source if is_mapping(source) else None


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


def _order(name: str) -> tuple[bool, list[tuple[int, str]]]:
    """What trials are sorted by: those that begin with a number come first."""
    return not name[:1].isdigit(), natural_order(name)
