"""Of which files a recording is made: a mapping's description, and every file that is read."""

from pathlib import Path

from surae.base.files import PathLike
from surae.recording.described import TRIAL
from surae.recording.mapping import Description
from surae.recording.reading import is_mapping, open_mapping
from surae.recording.source import open_source


def description_of(mapping: PathLike) -> Description:
    """What a TOML mapping describes; InputError where the file is none."""
    return Description.of(open_mapping(mapping))


def files_of(path: PathLike, mapping: PathLike | None = None) -> tuple[Path, ...]:
    """All files that a recording's numbers depend on, the mapping that describes them too.

    Parameters
    ----------
    path : path
        What `surae.read` is given: a recording, a mapping that names its files, or one of the files
        of a trial.
    mapping : path, optional
        The mapping given beside it.

    Returns
    -------
    tuple of paths
        Whether or not they are there.

    Raises
    ------
    InputError
        The mapping is none, or the file is not one of those that it names.
    """
    if mapping is None:
        source = open_source(path)
        named = Description.of(source).named if is_mapping(source) else ()
        return (Path(path), *(Path(path).parent / name for name in named))
    description = description_of(mapping)
    files: tuple[Path, ...] = (Path(path),)
    if description.patterns:
        trial, folder = description.trial_of(path)
        files = tuple(folder / pattern.replace(TRIAL, trial) for pattern in description.patterns)
    return (*files, Path(mapping))
