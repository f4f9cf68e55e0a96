"""How much is nerve: from small random perturbations, and from slow and fast stretches."""

from collections.abc import Mapping, Sequence
from datetime import datetime
from typing import TYPE_CHECKING, Any

from surae.api.given import AnyRecording, read_in, several
from surae.base.errors import InputError
from surae.base.files import PathLike
from surae.base.progress import Progress
from surae.nerve.answer import Impedance, joined
from surae.nerve.impedance import inertia_of_empty, perturbed
from surae.nerve.stretch_records import Stretches
from surae.nerve.stretches import answers
from surae.recording import Recording, leaving_gaps, read

if TYPE_CHECKING:
    from surae.report.output import Report


def impedance(
    recordings: AnyRecording | Sequence[AnyRecording],
    *,
    empty: AnyRecording | None = None,
    mapping: PathLike | None = None,
    progress: Progress | None = None,
    **corrections: Any,
) -> Impedance:
    """Tissue and reflex of an ankle that a device perturbs at random by a few degrees.

    Torque is taken for that of two paths side by side: the intrinsic one, inertia, viscosity and
    stiffness that may relax, and a reflex that answers velocity in one direction, later.

    Parameters
    ----------
    recordings : Recording, DataFrame or path, or a sequence of them
        Of one leg, at one or several levels of effort or angles; 60 s each. Angle and torque do;
        samples without a number are left out.
    empty : Recording, DataFrame or path, optional
        The same movement without a foot: the device's own inertia is then taken off.
    mapping : path, optional
        A TOML that describes the columns of the files.
    progress : callable, optional
        Called with recordings done and all recordings.
    **corrections
        What to put right in signals, as of `surae.read`.

    Returns
    -------
    Impedance
        Measures with 95 % intervals and verdicts, of each recording and of all; whether a reflex is
        there; what each path explains; whether the stiffness stays the same.

    Raises
    ------
    InputError
        A recording has no torque, is no perturbation, or too little of it can be used.

    Examples
    --------
    >>> surae.impedance("perturbed.csv").measures["intrinsic_stiffness"].ci95
    """
    given = list(several(recordings))
    if not given:
        raise InputError("no recording is given; name one at least")
    inertia = None if empty is None else inertia_of_empty(_measured(empty, mapping, corrections))
    recorded = []
    for done, each in enumerate(given):
        if progress is not None:
            progress(done, len(given))
        recorded.append(perturbed(_measured(each, mapping, corrections), inertia))
    return joined(recorded)


def stretches(
    recordings: AnyRecording | Sequence[AnyRecording],
    *,
    mapping: PathLike | None = None,
    **corrections: Any,
) -> Stretches:
    """Slow and fast stretches of a relaxed ankle: elastic, viscous, inertial and neural torque.

    The stretches are found in the recordings. Tissue's torque is fitted to all of them together,
    beside what the muscles' EMG drives; without EMG only torque that rises again when the foot has
    stopped is *probably neural*, since relaxed tissue's falls.

    Parameters
    ----------
    recordings : Recording, DataFrame or path, or a sequence of them
        Of one leg: ramps of 5° or more that end in holds, at two speeds at least.
    mapping : path, optional
        A TOML that describes the columns of the files.
    **corrections
        What to put right in signals, as of `surae.read`.

    Returns
    -------
    Stretches
        Every stretch, the threshold of each muscle, and what repeats differ by.

    Raises
    ------
    InputError
        A recording has no torque, or no stretch is in it.

    Examples
    --------
    >>> surae.stretches(["slow.csv", "fast.csv"]).smallest_detectable_change["neural_Nm"]
    """
    given = several(recordings)
    if not len(given):
        raise InputError("no recording is given; name one at least")
    return answers([_measured(each, mapping, corrections) for each in given])


def perturbation_page(answer: Impedance | Stretches, language: str = "en") -> "Report":
    """The page of what was found, in a language, to be written as HTML or PDF."""
    from surae.report.nerve import impedance_report, stretches_report  # matplotlib

    created = datetime.now().astimezone()
    if isinstance(answer, Impedance):
        return impedance_report(answer, created=created, language=language)
    return stretches_report(answer, created=created, language=language)


def _measured(
    given: AnyRecording, mapping: PathLike | None, corrections: Mapping[str, Any]
) -> Recording:
    """A recording as it was measured, with gaps where it has no numbers."""
    with leaving_gaps():
        if isinstance(given, str) or hasattr(given, "__fspath__"):
            return read(given, mapping=mapping, **corrections)  # type: ignore[arg-type]
        recording = read_in(given)
    if not isinstance(recording, Recording):
        raise InputError(f"{recording.name}: it is prepared for a model; give what was measured")
    return recording
