"""The trials of one leg together: what they are, one EMG reference, what is wrong in all alike."""

from collections.abc import Callable, Iterable, Mapping, Sequence
from dataclasses import dataclass, field, replace

import numpy as np

from surae.base.errors import InputError
from surae.base.file_form import filed
from surae.base.frozen import FrozenDict
from surae.base.words import N_, Message
from surae.model.knowledge import Knowledge
from surae.model.laboratory import AUTO
from surae.quality import KINDS, Quality
from surae.recording import Recording, SourceFile
from surae.settings import FitSettings
from surae.signals import EmgReference, ModelInputs, emg_reference, normalised
from surae.signals.windows import parted, prepared_parts
from surae.trials.sorting import Reading, Trial


@filed("trials", "mapping", "efforts")
@dataclass(frozen=True, slots=True)
class TrialSet:
    """The trials of one leg."""

    #: Every file that was given, those too that could not be read: what it is and is used for.
    trials: tuple[Trial, ...]
    name: str = "session"  #: Shown in tables and reports.
    side: str | None = None  #: "left", "right": The leg.
    #: `date`, `condition`, `notes`: as the mapping or the caller says.
    date: str | None = None
    condition: str | None = None
    notes: str | None = None
    mapping: SourceFile | None = None  #: The TOML through which all files were read.
    #: Efforts that were given and not decided from the data.
    efforts: Mapping[str, str] = field(default_factory=FrozenDict)
    knowledge: Knowledge | None = None  #: What was known beforehand.

    def __post_init__(self) -> None:
        """Make the mapping read-only."""
        object.__setattr__(self, "efforts", FrozenDict(self.efforts))

    def __getitem__(self, name: str) -> Trial:
        """The trial of that name."""
        return {trial.name: trial for trial in self.trials}[name]

    def __repr__(self) -> str:
        count = f"{len(self.trials)} trial{'' if len(self.trials) == 1 else 's'}"
        about = [
            f"{key} {value}"
            for key in ("side", "date", "condition")
            if (value := getattr(self, key))
        ]
        lines = [f"Session {self.name!r}: {count}" + (f" ({', '.join(about)})" if about else "")]
        for trial in self.trials:
            described = trial.problem or f"{trial.effort}, {trial.why}"
            lines.append(f"  {trial.name}: {trial.use}: {described}")
        return "\n".join(lines)

    def with_knowledge(self, settings: FitSettings) -> FitSettings:
        """The settings of a fit with what is known of the leg where they do not say it.

        Crosstalk is a step's finding and nobody's statement: a named model goes without.

        Raises
        ------
        InputError
            What is stated has no effect on the model.
        """
        known = self.knowledge
        said = settings.knowledge
        if known is None:
            return settings
        if settings.model != AUTO:
            known = replace(known, crosstalk={}, crosstalk_of="")
        return FitSettings.of(settings, knowledge=said.filled(known) if said else known)

    @property
    def fitted(self) -> tuple[str, ...]:
        """Names of the trials that can be fitted: they were read, and they move."""
        return tuple(trial.name for trial in self.trials if trial.use == "fit")

    @property
    def read(self) -> tuple[Trial, ...]:
        """The trials that could be read and have a torque."""
        return tuple(trial for trial in self.trials if not trial.problem)

    @property
    def same_layout(self) -> Mapping[str, tuple[str, ...]]:
        """Trials that the mapping of another file beside them read, by that mapping's path."""
        made: dict[str, tuple[str, ...]] = {}
        for trial in self.trials:
            files = () if trial.recording is None else trial.recording.files
            if self.mapping is None and len(files) > 1 and files[-1].path.endswith(".toml"):
                made[files[-1].path] = (*made.get(files[-1].path, ()), trial.name)
        return made

    def emg_reference(self, settings: FitSettings | None = None) -> EmgReference | None:
        """What EMG is divided by: one number for each muscle, of all trials of the session.

        The ``normalise`` of a fit's settings says of what, ``"mvc"`` being the trials of maximal
        effort; by default these where there are any, else all trials. None where the settings ask
        for no normalisation, or EMG is not in volts.
        """
        maximal = [trial for trial in self.read if trial.effort == "maximal"]
        settings = settings or FitSettings(normalise="mvc" if maximal else "session")
        if settings.normalise is None:
            return None
        if settings.normalise == "mvc" and not maximal:
            raise InputError(
                f'{self.name}: no trial is of maximal effort; write effort = "maximal" in the '
                "mapping's [trials], or normalise by the session"
            )
        plain = replace(settings, normalise=None, weights=None)
        kind = "mvc" if settings.normalise == "mvc" else "session"
        recordings = [t.recording for t in (maximal if kind == "mvc" else self.read)]
        inputs = [
            plain.prepare(part)
            for recording in recordings
            if recording is not None
            and "V" in (c.unit for role, c in recording.channels.items() if role[:4] == "emg_")
            for part in parted([recording])
        ]
        return emg_reference(inputs, kind) if inputs else None  # type: ignore[arg-type]

    def to_fit(self, name: str) -> Recording:
        """The recording of a trial that can be fitted, as it was read."""
        trial = next((trial for trial in self.trials if trial.name == name), None)
        if trial is None:
            known = ", ".join(self.fitted) or "none"
            raise InputError(
                f"{self.name}: there is no trial {name!r}; those that can be fitted: {known}"
            )
        if trial.use != "fit" or trial.recording is None:
            why = trial.problem or f"{trial.why}: it has no parameters of its own to tell"
            raise InputError(f"{self.name}: {name} cannot be fitted: {why}")
        return trial.recording


def prepared_for(
    settings: FitSettings, recording: Recording, reference: EmgReference | None
) -> tuple[ModelInputs, ...]:
    """What a fit reads of one trial, its EMG divided by the session's reference: parts, windows."""
    prepare = replace(settings, normalise=None).inputs
    prepared = prepared_parts([recording], prepare, family=settings.model == AUTO)
    return tuple(normalised(inputs, reference) for inputs in prepared)


def in_order_of_content(
    names: Iterable[str], inputs: Mapping[str, Sequence[ModelInputs]]
) -> tuple[str, ...]:
    """Trials in an order that neither their names nor that of their files decides.

    A search that ends at another of several valleys, or rounds otherwise, for another order of
    what it reads would make other numbers of the same trials.
    """

    def size(name: str) -> tuple[float, ...]:
        torque = np.concatenate([part.torque for part in inputs[name] if part.torque is not None])
        return -float(len(torque)), -float(torque.std()), float(torque.mean())

    return tuple(sorted(names, key=size))


def reading_of(recording: Recording) -> Reading:
    """A recording that is read already, as a trial."""
    path = recording.files[0].path if recording.files else None
    return Reading(recording.name, path, recording)


#: Errors of which a sentence tells more than their code.
_SAID = {
    "angle-sign": N_("The angle is reversed"),
    "torque-sign": N_("The torque is reversed"),
    "angle-units": N_("The angle’s unit or zero is wrong"),
    "torque-unit": N_("The torque’s unit is wrong"),
    "emg-unit": N_("The EMG’s unit is wrong"),
    "electrodes-swapped": N_("Two electrodes are exchanged"),
    "emg-torque-lag": N_("EMG and torque are out of step"),
}
_IN_TRIALS = N_("{what} in {n} of {whole} trials; correct it once for all of them.")


def common_errors(
    quality: Iterable[Quality], _: Callable[..., str] | None = None
) -> tuple[str, ...]:
    """Errors that more than half of the trials have, at least two, with what to do.

    In English, or in the language of `_`, in which errors of a file have the advice of their kind.
    """
    every = list(quality)
    advice: dict[str, list[str]] = {}
    for checked in every:
        errors = {f.code: f.advice for f in checked.findings if f.severity == "error"}
        for code, text in errors.items():
            advice.setdefault(code, []).append(text)
    said = []
    for code, texts in advice.items():
        if len(texts) > 1 and 2 * len(texts) > len(every):
            what = _SAID.get(code) or KINDS[code].looks_for
            given = {"n": str(len(texts)), "whole": str(len(every))}
            if _ is None:
                said.append(f"{_IN_TRIALS.format(what=what, **given)} {texts[0]}")
            else:
                remedy = texts[0] if isinstance(texts[0], Message) else KINDS[code].advice
                said.append(f"{_(_IN_TRIALS, what=_(what), **given)} {_(remedy)}")
    return tuple(said)


@filed(rmse="rmse_Nm", bias="bias_Nm", covers="torque_ci95_covers")
@dataclass(frozen=True, slots=True)
class Crossed:
    """How a fit follows a trial."""

    #: Variance accounted for [%]; None where there is no prediction, and `reason` says why.
    vaf: float | None = None
    #: Centred R² [%]; None too where the trial's torque hardly changes, as in a passive hold.
    r2: float | None = None
    #: `rmse`, `bias`: root mean square and mean of measured minus predicted torque [Nm].
    rmse: float | None = None
    bias: float | None = None
    #: Samples within the 95 % interval of their predicted torque [%]; None where it was in the fit.
    covers: float | None = None
    fitted: bool = False  #: The trial was in the fit, so agreement is no test.
    #: Whether it is predicted as well as the fit promises, see `Adequacy`; empty where it was in
    #: the fit, or its torque hardly changes.
    grade: str = ""
    reason: str = ""  #: Why there is no prediction; empty where there is one.
    #: `template_vaf`, `ridge_vaf`: what the fit's trials predict of it without a model [%]: their
    #: mean at the same phase, and a ridge regression; None where it was in the fit, or none is.
    template_vaf: float | None = None
    ridge_vaf: float | None = None
