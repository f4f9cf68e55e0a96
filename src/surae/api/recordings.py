"""Checks of recordings, what a model takes of them, and an example."""

import math
from collections.abc import Iterable, Iterator, Sequence
from dataclasses import replace

import numpy as np

from surae.api.given import AnyRecording, read_in
from surae.base.errors import InputError
from surae.base.files import PathLike
from surae.base.words import Message
from surae.inference import FitProblem
from surae.inference.diagnosis import examined, wrong_units
from surae.model.joint import ANKLE, Joint, read_joint
from surae.protocol import Protocol, generate, named_device
from surae.quality import (
    Commanded,
    Quality,
    check_recording,
    commanded_file,
    recording_of,
    recording_or_findings,
    used,
)
from surae.quality.electrodes import Electrodes, electrodes_of, together
from surae.quality.registry import ordered, unfit
from surae.quality.trial import signals_of
from surae.recording import Recording, csv_columns, write_csv
from surae.recording.dataframe import DataFrame
from surae.recording.described import EMPTY
from surae.settings import FitSettings
from surae.signals import ModelInputs, Weighting, normalised, prepare
from surae.studies import Imperfections, virtual_recording, virtual_subject
from surae.trials import TrialSet, tell_together


def as_inputs(recording: AnyRecording, prepared: bool) -> ModelInputs:
    """What a model takes; a file is read, and a recording filtered unless it is `prepared`."""
    measured = read_in(recording)
    return measured if isinstance(measured, ModelInputs) else prepare(measured, prepared=prepared)


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


#: The torque sensor's noise [Nm]; raw EMG brings its own.
_NOISE = Imperfections(torque_noise=0.3, torque_noise_time=0.02)
#: Sampling rate of all channels, as raw EMG needs it [Hz].
_RATE = 2048.0


def example(path: PathLike | None = None, *, trial: int = 1) -> Recording:
    """A trial of a virtual subject on an ankle robot: angle, torque and raw EMG of four muscles.

    Parameters
    ----------
    path : path, optional
        A file to write it to as well, as our CSV.
    trial : int
        1, 2, …: trials of the same leg, which differ in their noise.

    Returns
    -------
    Recording
        In SI units; always the same.

    Raises
    ------
    InputError
        The file cannot be written.

    Examples
    --------
    >>> recording = surae.example("trial.csv")
    """
    protocol = Protocol(
        profile="multiple-holds",
        chirp_amplitude=0.2,
        chirp_rate=0.159,
        rate_hz=_RATE,
        device=named_device("achilles"),
    )
    simulated = virtual_recording(
        virtual_subject(seed=1), generate(protocol), seed=trial, imperfections=_NOISE
    )
    channels = {
        role: replace(each, source="simulated") for role, each in simulated.channels.items()
    }
    name = f"virtual subject, trial {trial}"
    recording = replace(simulated, name=name, side="right", channels=channels)
    if path is not None:
        write_csv(path, csv_columns(recording), [f"name: {name}", "emg: raw"])
    return recording


def explained(error: InputError, recordings: Iterable[Recording | ModelInputs]) -> InputError:
    """The error that a recording cannot be used, with what is wrong with its units."""
    messages = [
        finding.message
        for recording in recordings
        if isinstance(recording, Recording)
        for finding in wrong_units(recording)[0]
        if finding.severity == "error"
    ]
    return InputError(" ".join([f"{error}.", *messages])) if messages else error


def check(
    recording: AnyRecording,
    *,
    commanded: Commanded | PathLike | None = None,
    prepared: bool = False,
    joint: Joint | PathLike | None = None,
    exclude: Sequence[Sequence[float]] = (),
) -> Quality:
    """Look for faults in a recording before it is fitted.

    Parameters
    ----------
    recording : Recording, ModelInputs or path
        As it was measured, if possible: preparation hides faults. Of a file that no fit would read,
        the gaps and missing samples are findings too.
    commanded : Commanded or path, optional
        What the device was to follow, or the file of `surae protocol` that says so. Without it, the
        protocols of `surae.protocol` are recognised in the angle.
    prepared : bool
        Whether the signals are to be used as they are, without filters: envelopes are then right
        whatever the file says of its EMG.
    joint : Joint or path, optional
        Another joint than the ankle: its words, and no check by limits of ankles.
    exclude : sequence of (float, float)
        Windows, start and end [s], that a fit leaves out: no check looks at them.

    Returns
    -------
    Quality
        Findings, the most severe first, and the checks that could not be made.

    Raises
    ------
    InputError
        A file cannot be read.

    Examples
    --------
    >>> surae.check("trial.csv").summary
    """
    return next(_checked([recording], commanded, prepared, joint, exclude))[0]


def check_together(
    recordings: Iterable[AnyRecording],
    *,
    commanded: Commanded | PathLike | None = None,
    prepared: bool = False,
    joint: Joint | PathLike | None = None,
    exclude: Sequence[Sequence[float]] = (),
) -> list[Quality]:
    """Findings of recordings of one leg: holds at several angles are one set.

    Parameters
    ----------
    recordings : iterable of Recording, ModelInputs or path
        Files are read twice, one after the other: each is judged by what all show of an electrode.
    commanded, prepared, joint, exclude
        Of all of them, as of `check`.

    Returns
    -------
    list of Quality
        As of `check`, in the same order; that a hold of a set holds still is for information.

    Raises
    ------
    InputError
        A file cannot be read.
    """
    every = []
    angles = []
    every_recording = list(recordings)
    alone = len(every_recording) == 1  # judged against itself
    electrodes = None if alone else electrodes_in(map(_looked_at, every_recording), exclude)
    for quality, angle in _checked(
        every_recording, commanded, prepared, joint, exclude, electrodes
    ):
        every.append(quality)
        angles += [angle] if "angle-still" in {f.code for f in quality.findings} else []
    whole = len(angles) == len(every) and tell_together(angles)
    return in_set(every) if whole else every


def _checked(
    recordings: Iterable[AnyRecording],
    commanded: Commanded | PathLike | None,
    prepared: bool,
    joint: Joint | PathLike | None,
    exclude: Sequence[Sequence[float]],
    electrodes: Electrodes | None = None,
) -> Iterator[tuple[Quality, float]]:
    """Findings of each, and its median angle [rad]; `electrodes` are what all show of theirs."""
    given = commanded if isinstance(commanded, Commanded | None) else commanded_file(commanded)
    of_joint = joint if isinstance(joint, Joint | None) else read_joint(joint)
    for recording in recordings:
        protocol = given
        angle = math.nan
        measured: Recording | Quality
        if isinstance(recording, Recording | ModelInputs | DataFrame):
            read_ = read_in(recording)
            measured = recording_of(read_) if isinstance(read_, ModelInputs) else read_
        else:
            measured, stated = recording_or_findings(recording)
            protocol = protocol or stated
        if isinstance(measured, Quality):
            quality = measured
        else:
            if "angle" in measured.channels:
                angle = float(np.median(measured.channels["angle"].values))
            if of_joint in (None, ANKLE):
                quality = examined(measured, protocol, exclude, electrodes)
            else:
                reads = used(measured, exclude)[0]
                quality = check_recording(reads, protocol, joint=of_joint, electrodes=electrodes)
        if prepared:
            of_raw = {("emg-kind", "warning"), ("emg-aliased", "error")}
            kept = (f for f in quality.findings if (f.code, f.severity) not in of_raw)
            quality = replace(quality, findings=tuple(kept))
        yield quality, angle


def _looked_at(recording: AnyRecording) -> Recording | None:
    """A recording as its channels are looked at; None where it cannot be read as one."""
    if isinstance(recording, Recording | ModelInputs | DataFrame):
        read_ = read_in(recording)
        return recording_of(read_) if isinstance(read_, ModelInputs) else read_
    measured = recording_or_findings(recording)[0]
    return measured if isinstance(measured, Recording) else None


def electrodes_in(
    recordings: Iterable[Recording | None], exclude: Sequence[Sequence[float]] = ()
) -> Electrodes | None:
    """What recordings of one leg show of its electrodes; None where nothing can be compared."""
    levels = []
    for recording in recordings:
        if recording is None or "angle" not in recording.channels:
            continue
        reads = used(recording, exclude)[0]
        if unfit(reads) is None:
            signals = signals_of(reads)
            levels.append(electrodes_of(reads, signals.fast, signals.rate_hz))
    return together(levels)


def electrodes_of_leg(leg: TrialSet, settings: FitSettings) -> Electrodes | None:
    """What all trials of a leg show of its electrodes, of those that were read and have a leg."""
    recordings = (trial.recording for trial in leg.read if trial.effort != EMPTY)
    return electrodes_in(recordings, left_out(settings))


def checks_for(
    settings: FitSettings,
    recordings: Sequence[AnyRecording],
    electrodes: Electrodes | None = None,
) -> list[Quality]:
    """Findings of recordings that are fitted together with these settings.

    `electrodes` are what all trials of the leg show of theirs, where there are more than these.
    """
    anatomy = settings.options.anatomy
    exclude = left_out(settings)
    if electrodes is None:
        prepared = settings.prepared
        return check_together(recordings, prepared=prepared, joint=anatomy, exclude=exclude)
    known = _checked(recordings, None, settings.prepared, anatomy, exclude, electrodes)
    return [quality for quality, _ in known]


def left_out(settings: FitSettings) -> list[tuple[float, float]]:
    """Windows [s] that do not count in any recording."""
    counts = settings.weights if isinstance(settings.weights, Weighting) else Weighting()
    return [(start, end) for start, end, weight in counts.windows if weight == 0.0]


def in_set(qualities: Sequence[Quality]) -> list[Quality]:
    """Findings of several holds, which together tell what one of them does not.

    That one holds still is for information, and that it is short, or at rest, is no fault: holds
    tell no relaxation, and others show the effort.
    """
    idle = all("active-not-active" in {f.code for f in q.findings} for q in qualities)
    of_one = {("rom-not-covered", "warning"), ("trial-too-short", "warning")}
    of_one |= set() if idle else {("active-not-active", "warning")}
    made = []
    for quality in qualities:
        kept = []
        for finding in quality.findings:
            if finding.code == "angle-still":
                text = Message("found/angle-still/set", hold=finding.message, n=len(qualities))
                advice = Message("advice/angle-still/set")
                kept.append(replace(finding, severity="info", message=text, advice=advice))
            elif (finding.code, finding.severity) not in of_one:
                kept.append(finding)
        made.append(replace(quality, findings=ordered(kept)))
    return made
