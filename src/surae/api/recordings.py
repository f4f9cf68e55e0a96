"""Recordings as they are given: read, prepared or as files; one or several."""

from collections.abc import Iterable, Sequence

from surae.estimation import FitProblem
from surae.files import PathLike
from surae.recording import Recording, read
from surae.recording.dataframe import DataFrame, of_frame
from surae.settings import FitSettings
from surae.signals import EmgReference, ModelInputs, normalised, prepare
from surae.signals import normalise as normalise_inputs

#: A recording in any form: read, prepared, the path of its file, or a DataFrame with the columns of
#: our CSV.
AnyRecording = Recording | ModelInputs | PathLike | DataFrame


def several(recordings: AnyRecording | Sequence[AnyRecording]) -> Sequence[AnyRecording]:
    """A sequence of recordings, of one that is given alone too."""
    alone = isinstance(recordings, Recording | ModelInputs | str | DataFrame)
    alone = alone or hasattr(recordings, "__fspath__")
    return [recordings] if alone else recordings  # type: ignore[list-item,return-value]


def read_in(recording: AnyRecording) -> Recording | ModelInputs:
    """A recording, read if it is a file or a table."""
    if isinstance(recording, Recording | ModelInputs):
        return recording
    return of_frame(recording) if isinstance(recording, DataFrame) else read(recording)


def as_inputs(recording: AnyRecording, prepared: bool) -> ModelInputs:
    """What a model takes; a file is read, and a recording filtered unless it is `prepared`."""
    given = read_in(recording)
    return given if isinstance(given, ModelInputs) else prepare(given, prepared=prepared)


def as_in_fit(
    problem: FitProblem, recordings: Iterable[AnyRecording], prepared: bool | None
) -> list[ModelInputs]:
    """Recordings for a model that was fitted to others: prepared and normalised as those were.

    Whether they are used as they are, `prepared` may say otherwise. The reference of the fit's EMG
    is used again: one found in these recordings would be of another unit.
    """
    first = problem.inputs[0]
    as_they_are = first.prepared if prepared is None else prepared
    settings = FitSettings.of(problem.settings, prepared=as_they_are)
    inputs = (settings.prepare(read_in(recording)) for recording in recordings)
    return [normalised(each, first.emg_reference) for each in inputs]


def normalise(
    recordings: AnyRecording | Sequence[AnyRecording],
    reference: str | EmgReference = "session",
    *,
    mvc: AnyRecording | Sequence[AnyRecording] = (),
    prepared: bool = False,
) -> tuple[ModelInputs, ...]:
    """Prepare the recordings of a session, and divide EMG by one number for each muscle.

    Parameters
    ----------
    recordings : Recording, ModelInputs, path, or a sequence of them
        All recordings of the session.
    reference : {"session", "mvc"} or EmgReference
        The largest envelope in any of `recordings` or of `mvc`, averaged over 0.25 s; or that of
        before, as ``fit.result.problem.inputs[0].emg_reference``.
    mvc : Recording, ModelInputs, path, or a sequence of them
        Maximum voluntary contractions.
    prepared : bool
        The signals are filtered and at the model's rate already: use them as they are.

    Returns
    -------
    tuple of ModelInputs
        For `fit`, `compare`, `leave_one_out`, …; weights g then come out in N.

    Raises
    ------
    InputError
        See `surae.signals.normalise`.
    """
    inputs = [as_inputs(recording, prepared) for recording in several(recordings)]
    contractions = [as_inputs(recording, prepared) for recording in several(mvc)]
    return normalise_inputs(inputs, reference, mvc=contractions)
