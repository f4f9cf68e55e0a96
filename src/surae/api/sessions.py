"""A session: the trials of one leg, read through one mapping, fitted each and together."""

from collections.abc import Mapping, Sequence
from dataclasses import dataclass, replace
from pathlib import Path
from typing import TYPE_CHECKING, Any, Unpack

from surae.api.fitted import Fit
from surae.api.fitting import asks_as_fit, fit_inputs
from surae.api.recordings import checks_for, electrodes_of_leg
from surae.api.session_result import SessionResult
from surae.api.session_run.progress import StepProgress
from surae.api.session_run.run import run
from surae.base.errors import InputError
from surae.base.files import PathLike, paths_of, shown
from surae.base.progress import SearchProgress, line_of_progress
from surae.inference.least_squares.starts import Follow
from surae.model.knowledge_file import SESSION_TOML, SessionFile, known_from, read_session_toml
from surae.model.knowledge_words import lines_of
from surae.model.laboratory import AUTO
from surae.recording import Recording
from surae.recording.beside import description_beside
from surae.recording.corrections import CorrectionKeywords, Corrections
from surae.recording.described import TrialDescription
from surae.recording.mapping import Description
from surae.recording.reading import is_mapping, open_mapping, read
from surae.recording.source import open_source
from surae.settings import FitSettings
from surae.trials import (
    Reading,
    TrialSet,
    in_order_of_content,
    prepared_for,
    reading_of,
    sorted_trials,
    trial_files,
)

if TYPE_CHECKING:
    from surae.api.keywords import FitKeywords


@dataclass(frozen=True, slots=True, repr=False)
class Session(TrialSet):
    """The trials of one leg, to be fitted each and together; `session` makes one from files."""

    @asks_as_fit
    def fit(
        self,
        trials: str | Sequence[str] | None = None,
        model: str | FitSettings = AUTO,
        *,
        progress: SearchProgress | None = None,
        follow: Follow | None = None,
        **keywords: "Unpack[FitKeywords]",
    ) -> Fit:
        """Fit one trial, or several jointly: they share all parameters of the leg.

        Parameters
        ----------
        trials : str or sequence of str, optional
            Names of `fitted`; by default all of them.
        model : str or FitSettings
            As of `surae.fit`.
        progress, follow : callable, optional
            As of `surae.fit`.
        **keywords
            Keywords of `surae.fit`. ``normalise`` divides EMG by the session's reference.

        Returns
        -------
        Fit
            One set of parameters.

        Raises
        ------
        InputError
            A trial is unknown or cannot be fitted, or a setting makes no sense.
        """
        settings = self.with_knowledge(FitSettings.of(model, **keywords))
        chosen = self.fitted if trials is None else [trials] if isinstance(trials, str) else trials
        if not chosen:
            raise InputError(f"{self.name}: no trial can be fitted: none of them moves")
        reference = self.emg_reference(settings)
        parts = {name: prepared_for(settings, self.to_fit(name), reference) for name in chosen}
        ordered = in_order_of_content(chosen, parts)
        recordings = [self.to_fit(name) for name in ordered]
        inputs = [part for name in ordered for part in parts[name]]
        quality = tuple(checks_for(settings, recordings, electrodes_of_leg(self, settings)))
        return fit_inputs(inputs, settings, quality, progress, follow)

    @asks_as_fit
    def run(
        self,
        output: PathLike | None = None,
        model: str | FitSettings = AUTO,
        *,
        progress: StepProgress | None = None,
        workers: int | None = 1,
        **keywords: "Unpack[FitKeywords]",
    ) -> SessionResult:
        """Check every trial, fit each and all together, and predict each by the others.

        Parameters
        ----------
        output : path, optional
            A folder: fits that are in it already, of the same data and question, are taken as they
            are, and every new one is written as soon as it is made.
        model : str or FitSettings
            As of `surae.fit`.
        progress : callable, optional
            Called before every step and after it; see `surae.api.session_run.progress.Step`.
            Without it a line of a terminal or notebook says how far it is.
        workers : int or None
            Above 1 the fit of all together is made in a process of its own, beside the others; None
            has as many as there are processors.
        **keywords
            Keywords of `surae.fit`.

        Returns
        -------
        SessionResult
            Ctrl-C keeps the fits that are complete; `SessionResult.interrupted` says so.
        """
        settings = self.with_knowledge(FitSettings.of(model, **keywords))
        if progress is not None:
            return run(self, settings, output, progress, workers)
        with line_of_progress("fitting the session") as tell:
            return run(self, settings, output, lambda step: tell(step.done, step.total), workers)


def session(
    recordings: PathLike | Sequence[PathLike | Recording],
    *,
    mapping: PathLike | None = None,
    name: str | None = None,
    side: str | None = None,
    date: str | None = None,
    condition: str | None = None,
    notes: str | None = None,
    efforts: Mapping[str, str] | None = None,
    **corrections: Unpack[CorrectionKeywords],
) -> Session:
    """Read the trials of one leg, and decide what each of them is.

    Parameters
    ----------
    recordings : path, or sequence of paths and Recordings
        A folder of files, or the files. One that cannot be read is reported in its trial. A
        ``session.toml`` in a folder says what is known of leg and device, and what each file is.
    mapping : path, optional
        The TOML that describes all files, as `surae inspect` writes it; not needed for files whose
        columns have our names.
    name, side, date, condition, notes : str, optional
        Of the session, in place of what the mapping says.
    efforts : mapping of str to str, optional
        Of trials: ``"passive"``, ``"active"``, ``"isometric"``, ``"maximal"``, ``"empty device"``
        or ``"one muscle at a time"``, where the data say otherwise.
    **corrections
        What is to be put right in all trials: ``sign``, ``scale``, ``offset``, ``swap`` and
        ``wrap``, as of `surae.read`.

    Returns
    -------
    Session

    Raises
    ------
    InputError
        There is no file, none can be read, the mapping is wrong, or two trials are called alike.

    Examples
    --------
    >>> result = surae.session("leg", mapping="map.toml").run("OUT")
    >>> result.to_dataframe()["grade"]
    """
    description = None if mapping is None else Description.of(open_mapping(mapping))
    sources: list[Any] = paths_of(recordings)  # type: ignore[arg-type]
    right = Corrections.of(**corrections)
    in_memory = [reading_of(right(each)) for each in sources if isinstance(each, Recording)]
    paths = [each for each in sources if not isinstance(each, Recording)]
    said = _session_file(paths)
    files = trial_files(paths, description, said.aside) if paths else {}
    read_in = (
        reading
        for trial, path in files.items()
        for reading in _readings(trial, path, description, right)
    )
    readings = [*in_memory, *read_in]
    _refuse_unusable(readings, description)
    sides = {r.recording.side for r in readings if r.recording is not None and r.recording.side}
    if side is None and len(sides) > 1:
        raise InputError("the trials are of both legs; a session is of one: give side")
    kinds = said.kinds({reading.name: reading.path for reading in readings})
    trials = sorted_trials(readings, {**kinds, **(efforts or {})})
    known = known_from(
        said,
        {t.name: t.recording for t in trials if t.recording is not None and not t.problem},
        {trial.name: trial.effort for trial in trials},
        read=lambda path: _recording(path.stem, path, description, right),
    )
    about = TrialDescription() if description is None else description.mapped()
    return Session(
        trials=trials,
        name=name or _name_of(description, paths),
        side=side or about.side or next(iter(sides), None),
        date=date or about.date,
        condition=condition or about.condition,
        notes=notes or about.notes,
        mapping=None if description is None else description.source.file,
        efforts=efforts or {},
        knowledge=known if lines_of(known) or known.doubts else None,
    )


def files_of_trials(folder: PathLike, mapping: PathLike | None = None) -> tuple[Path, ...]:
    """The files of a folder that a session takes for its trials, in their order."""
    description = None if mapping is None else Description.of(open_mapping(mapping))
    return tuple(trial_files([folder], description, _session_file([folder]).aside).values())


def _refuse_unusable(readings: Sequence[Reading], description: Description | None) -> None:
    """Refuse trials of one name, none at all, none that can be read, and a mapping of others."""
    names = [reading.name for reading in readings]
    if twice := [name for name in names if names.count(name) > 1]:
        raise InputError(f"two trials are called {twice[0]!r}; name them apart")
    if not readings:
        raise InputError("there is no recording; give files, a folder or recordings")
    if all(reading.recording is None for reading in readings):
        more = f" (and {len(readings) - 1} more files)" if len(readings) > 1 else ""
        raise InputError(f"no trial can be read: {readings[0].problem}{more}")
    if description is not None and (slips := set(description.trials) - set(names)):
        raise InputError(
            f"{description.source.shown}: trials.{min(slips)}: there is no such trial; trials: "
            f"{', '.join(names)}"
        )


def _name_of(description: Description | None, paths: Sequence[Any]) -> str:
    """What a session is called that is given no name."""
    return (description.name if description else None) or _folder_name(paths)


def _session_file(paths: Sequence[Any]) -> SessionFile:
    """What the session.toml of a folder says; nothing where there is none."""
    files = [file for path in paths if (file := Path(path, SESSION_TOML)).is_file()]
    if len(files) > 1:
        raise InputError(f"{' and '.join(map(shown, files))} both say what is known; keep one")
    return read_session_toml(files[0]) if files else SessionFile()


def _recording(
    name: str, path: Path, description: Description | None, right: Corrections
) -> Recording:
    """A file as it is read; where it does not say what it holds, a mapping beside it may."""
    if description is not None:
        return right(description.read(path, name))
    try:
        recording = read(path)
    except InputError as error:
        if type(error) is not InputError or (beside := description_beside(path)) is None:
            raise
        recording = beside.read(path, name)
    return right(recording)


def _reading(name: str, path: Path, description: Description | None, right: Corrections) -> Reading:
    """A trial's file as it was read, or why it could not be."""
    about = TrialDescription() if description is None else description.mapped(name)
    try:
        recording = _recording(name, path, description, right)
    except InputError as error:
        return Reading(name, str(path), None, str(error), about)
    return Reading(name, str(path), replace(recording, name=name), description=about)


def _readings(
    name: str, path: Path, description: Description | None, right: Corrections
) -> list[Reading]:
    """The trials in a file as they were read: one, or each that the mapping tells apart."""
    try:
        source = open_source(path) if description is None else None
        mapping = description or (Description.of(source) if source and is_mapping(source) else None)
        within = {} if mapping is None else mapping.within(None if description is None else path)
    except InputError:
        within = {}  # and the reading says why
    if not within or mapping is None:
        return [_reading(name, path, description, right)]
    made = []
    for label, chosen in within.items():
        trial = f"{name}-{label}"
        about = TrialDescription() if description is None else description.mapped(trial)
        try:
            recording = right(mapping.read(None if description is None else path, trial, chosen))
        except InputError as error:
            made.append(Reading(trial, str(path), None, str(error), about))
        else:
            kept = replace(recording, name=trial)
            made.append(Reading(trial, str(path), kept, description=about))
    return made


def _folder_name(paths: Sequence[Any]) -> str:
    """The folder that a session was read from."""
    if not paths:
        return "session"
    first = Path(paths[0]).resolve()
    return shown((first if first.is_dir() else first.parent).name) or "session"
