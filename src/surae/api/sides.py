"""What is compared: a fit, the folder of a session, or recordings of a visit; and its rest."""

from collections.abc import Sequence
from dataclasses import dataclass, replace
from pathlib import Path

import numpy as np

from surae.api.fitted import Fit
from surae.api.fitting import load
from surae.api.given import AnyRecording
from surae.api.relaxing import inputs_of
from surae.base.errors import InputError, within
from surae.base.files import PathLike, shown
from surae.base.frozen import FrozenDict
from surae.base.records import from_plain
from surae.inference import Adequacy, Grade
from surae.inference.relaxed.build import curve_of
from surae.inference.relaxed.context import UNKNOWN, Laboratory
from surae.inference.relaxed.curve import RelaxedCurve
from surae.measures.at_rest import relaxed_of
from surae.measures.compared import Quantities, quantities
from surae.model.knowledge_file import SESSION_TOML, known_from, read_session_toml
from surae.recording.described import EMPTY
from surae.recording.reading import data_files_below, is_recording
from surae.settings import FitSettings
from surae.signals import ModelInputs
from surae.trials import Effort, efforts_of, is_named_maximal
from surae.trials.folder import INDEX, JOINT, fit_in, index_of, require_own

#: What a session calls trials of which strength is read.
_MAXIMAL = "maximal"
#: A visit that is compared: a fit, its file, the folder of a session; or recordings, their folder.
Visited = Fit | AnyRecording | Sequence[AnyRecording]


@dataclass(frozen=True, slots=True)
class Side:
    """One visit: its fit, if there is one, and its recordings."""

    fit: Fit | None
    inputs: tuple[ModelInputs, ...]
    #: Of its trials of maximal effort; a session says which they are, else their names do.
    efforts: tuple[Effort, ...] = ()
    laboratory: Laboratory = UNKNOWN  #: What is known of zero and plate, where there is no fit.

    @property
    def names(self) -> tuple[str, ...]:
        """Names of its recordings."""
        return tuple(each.name for each in self.inputs)

    def curve(self) -> RelaxedCurve | None:
        """The relaxed curve of its rest; None where there is none."""
        if any(each.torque is None for each in self.inputs):
            return None
        made = (
            curve_of(self.inputs, self.laboratory)
            if self.fit is None
            else relaxed_of(self.fit.result)
        )
        return made if isinstance(made, RelaxedCurve) else None

    def quantities(self, angles: Sequence[float], end: float) -> Quantities:
        """What its fit brings to a comparison; nothing without one."""
        if self.fit is not None:
            return quantities(self.fit, angles, end)
        nothing = Adequacy(Grade.ADEQUATE, (), np.nan)
        return Quantities("", FrozenDict(), nothing, self.names, FrozenDict())


def side_of(given: Visited) -> Side:
    """A visit as it is given.

    Raises
    ------
    InputError
        A file cannot be read, or a folder holds neither a session nor recordings.
    """
    if isinstance(given, Fit):
        return _of_fit(given)
    if isinstance(given, str) or hasattr(given, "__fspath__"):
        return _at(Path(given))  # type: ignore[arg-type]
    several = given if isinstance(given, list | tuple) else [given]
    return _of_inputs(inputs_of(several))


def _of_inputs(inputs: tuple[ModelInputs, ...]) -> Side:
    maximal = (each for each in inputs if is_named_maximal(each.name))
    return Side(None, inputs, efforts_of(maximal))


def _at(place: Path) -> Side:
    """A visit by its file or folder."""
    if _is_session(place):
        fit = load(fit_in(place))
        require_own(place, fit.result.problem.inputs)
        return replace(_of_fit(fit), efforts=_efforts_in(place))
    if place.suffix.lower() == ".json":
        return _of_fit(load(place))
    files = [place]
    if place.is_dir():
        files = [each for each in data_files_below(place) if is_recording(each)]
    session_toml = place / SESSION_TOML
    files = [each for each in files if each != session_toml]
    if not files:
        raise InputError(f"{shown(place)}: neither a session nor recordings are in this folder")
    return (
        _of_folder(session_toml, files) if session_toml.is_file() else _of_inputs(inputs_of(files))
    )


def _of_folder(session_toml: Path, files: Sequence[Path]) -> Side:
    """A visit by its recordings and its `session.toml`: what is known of it, and of each trial."""
    said = read_session_toml(session_toml)
    aside = {path.name for path in said.aside} | {Path(said.plate or "").name}
    aside |= {Path(file).name for file, kind in said.trials.items() if kind == EMPTY}
    trials = [each for each in files if each.name not in aside]
    if not trials:
        raise InputError(f"{shown(session_toml)}: no recording of the leg is beside it")
    settings = FitSettings.of(knowledge=known_from(said))
    side = _of_inputs(inputs_of(trials, settings))
    stated = {Path(file).stem for file, kind in said.trials.items() if kind == _MAXIMAL}
    maximal = [each for each in side.inputs if each.name in stated or is_named_maximal(each.name)]
    return replace(side, efforts=efforts_of(maximal), laboratory=Laboratory.of(settings))


def _efforts_in(folder: Path) -> tuple[Effort, ...]:
    """What the index of a session has of efforts; none where an older surae wrote it."""
    index = index_of(folder) or {}
    with within(shown(folder / INDEX), "; damaged, or of a newer surae"):
        return tuple(from_plain(Effort, each) for each in index.get("maximal_efforts", ()))


def _is_session(place: Path) -> bool:
    return (place / INDEX).is_file() or (place / JOINT).is_file()


def place_of(given: Visited | PathLike) -> object:
    """What tells two visits apart: a file, files, or the thing itself."""
    if isinstance(given, list | tuple):
        return tuple(map(place_of, given))
    if isinstance(given, str) or hasattr(given, "__fspath__"):
        path = Path(given)  # type: ignore[arg-type]
        return (fit_in(path) if _is_session(path) else path).resolve()
    return id(given)


def _of_fit(fit: Fit) -> Side:
    problem = fit.result.problem
    return Side(fit, tuple(problem.inputs))
