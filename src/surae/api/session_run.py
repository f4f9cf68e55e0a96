"""A session's run: every trial checked and fitted, all together, each predicted by the others.

The joint fit takes longer than all others together, so it may run in a process beside them.
"""

import time
from collections.abc import Callable, Mapping, Sequence
from concurrent.futures import Future, ThreadPoolExecutor
from contextlib import ExitStack
from dataclasses import dataclass, replace
from pathlib import Path
from tempfile import TemporaryDirectory

import numpy as np

from surae._version import __version__
from surae.api.fitted import Fit
from surae.api.fitting import fit_inputs, load
from surae.api.recordings import checks_for, electrodes_of_leg, explained, in_set
from surae.api.session_result import SessionResult, write_index, write_summary
from surae.base.errors import ComputationError, InputError
from surae.base.files import PathLike
from surae.base.packed import finite
from surae.base.records import from_plain, to_plain
from surae.base.threads import cores
from surae.inference import Grade, Prediction
from surae.inference.diagnosis import STILL
from surae.inference.judging.adequacy import doubted
from surae.inference.judging.goodness import centred_r2, counted, vaf
from surae.inference.judging.reasons import OF_OTHER_TRIALS, Reason, against
from surae.inference.judging.validation import covered, predict_others
from surae.measures.agreement import AskedTrial, disagreements
from surae.nerve.leg import Nerve
from surae.processes import Child, End, Plain
from surae.quality import Finding, Quality
from surae.report.leg_cards import PASSIVE
from surae.report.trials import contradictions
from surae.settings import FitSettings
from surae.signals import ModelInputs, same_signals
from surae.trials import (
    Crossed,
    Trial,
    TrialSet,
    efforts_of,
    in_order_of_content,
    prepared_for,
)
from surae.trials.folder import JOINT, TOO_FEW, claimed, fit_name
from surae.trials.nerve import nerve_of

#: What a joint fit costs, in samples of fits of one trial.
_JOINT_COST = 1.5


@dataclass(frozen=True, slots=True)
class Step:
    """Where a run is."""

    what: str  #: What is being done, or was.
    #: `done`, `total`: steps that are complete, and all.
    done: int
    total: int
    left_s: float | None = None  #: About how many seconds it still takes; None while nobody knows.
    outcome: str = ""  #: What came of it, in a few words; empty before the step.


StepProgress = Callable[[Step], None]


def run(
    session: TrialSet,
    settings: FitSettings,
    output: PathLike | None,
    progress: StepProgress | None,
    workers: int | None,
) -> SessionResult:
    """Check, fit each and all, cross-predict; see `Session.run`."""
    if any(trial.name == "joint" for trial in session.trials):
        raise InputError("a trial is called 'joint', as the fit of all together is; rename it")
    root = None if output is None else claimed(output, session.trials)
    if root is not None:
        write_index(SessionResult(session, settings), root, begun=True)
    work = _Run(session, settings, root, progress or (lambda _: None))
    with ExitStack() as stack:
        beside = stack.enter_context(_Beside()) if (workers or cores()) > 1 else None
        try:
            work.every_trial(beside)
            work.together(beside)
            work.nerves()
        except KeyboardInterrupt:
            work.interrupted = True
    work.crossed()
    work.asked()
    result = work.result()
    if root is not None:
        write_summary(result, root)
    return result


class _Run:
    """The state of a run: what is done already is kept whatever happens next."""

    def __init__(
        self, session: TrialSet, settings: FitSettings, root: Path | None, progress: StepProgress
    ) -> None:
        self.session = session
        self.settings = settings
        self.root = root
        self.progress = progress
        self.inputs: dict[str, tuple[ModelInputs, ...]] = {}
        self.fits: dict[str, Fit] = {}
        self.joint: Fit | None = None
        self.joined: tuple[str, ...] = ()
        self.failed: dict[str, str] = {}
        self.quality: dict[str, Quality] = {}
        self.predictions: dict[str, dict[str, Crossed]] = {}
        self.joint_predictions: dict[str, Crossed] = {}
        self.nerve: Nerve | None = None
        self.interrupted = False
        self._cost: dict[str, float] = {}
        #: Seconds and cost of the fits that were made now.
        self._spent = 0.0
        self._paid = 0.0
        self._steps = [*(trial.name for trial in session.trials), "all together"]
        self._done = 0

    def every_trial(self, beside: "_Beside | None") -> None:
        """Prepare and check each trial, and fit those that can be, the joint fit begun `beside`."""
        reference = self.session.emg_reference(self.settings)
        electrodes = electrodes_of_leg(self.session, self.settings)
        for trial in self.session.trials:
            if trial.problem or trial.recording is None:
                self.failed[trial.name] = trial.problem
                continue
            self._tell(f"checking {trial.name}")
            try:
                self.inputs[trial.name] = prepared_for(self.settings, trial.recording, reference)
            except InputError as error:
                self.failed[trial.name] = str(explained(error, [trial.recording]))
                continue
            (self.quality[trial.name],) = checks_for(self.settings, [trial.recording], electrodes)
        self._weigh_holds()
        for name in self.session.fitted:
            if name in self.inputs:
                self._cost[name] = float(sum(part.n for part in self.inputs[name]))
        sound = tuple(name for name in self._cost if self._wrong(name) is None)
        self._cost["all together"] = _JOINT_COST * sum(self._cost.values())
        if beside is not None and len(sound) > 1 and self._saved(JOINT, sound) is None:
            beside.begin(sound, *self._of(sound), self.settings)
        for trial in self.session.trials:
            self._step(trial.name, self._fit_alone(trial))

    def _weigh_holds(self) -> None:
        """Judge holds by each other: what is wrong with one may be right in a set of them."""
        held = [t.name for t in self.session.trials if t.effort == "isometric" and t.use == "fit"]
        held = [name for name in held if name in self.quality]
        together = in_set([self.quality[name] for name in held])
        self.quality |= dict(zip(held, together, strict=True))

    def _fit_alone(self, trial: Trial) -> str:
        """Fit a trial by itself, if it can be; return what came of it."""
        name = trial.name
        if name in self.failed:
            return self.failed[name]
        if trial.use != "fit":
            return f"not fitted: {trial.why}"
        if not trial.moves:
            return "fitted with the other holds"
        fit, outcome = self._fit_or_saved(name, fit_name(name), (name,))
        if fit is None:
            self.failed[name] = outcome
        else:
            self.fits[name] = fit
        return outcome

    def together(self, beside: "_Beside | None") -> None:
        """Fit all trials together that were fitted and have no error."""
        candidates = [
            name
            for name in self.session.fitted
            if name in self.fits or (name in self.inputs and not self.session[name].moves)
        ]
        for name in candidates:
            if (finding := self._wrong(name)) is not None:
                self.failed[name] = f"not in the joint fit: {finding.code}: {finding.message}"
        names = tuple(
            name
            for name in candidates
            if self._wrong(name) is None
            and (name not in self.fits or self.fits[name].status != "failed")
        )
        if len(names) < 2:
            alone = "a joint fit needs two trials that can be fitted"
            self.failed["joint"] = TOO_FEW if len(candidates) > 1 else alone
            self._step("all together", self.failed["joint"])
            return
        fit, outcome = self._fit_or_saved("all together", JOINT, names, beside)
        if fit is None:
            self.failed["joint"] = outcome
        else:
            self.joint = fit
            self.joined = names
        self._step("all together", outcome)

    def nerves(self) -> None:
        """What stretches and perturbations say of reflexes."""
        self._tell("telling tissue from nerve")
        self.nerve = nerve_of(self.session.trials)

    def crossed(self) -> None:
        """Predict every trial by every fit that has not yet."""
        for name, fit in self.fits.items():
            if name not in self.predictions:
                self.predictions[name] = self._predicted(fit, (name,))
        if self.joint is not None:
            self.joint_predictions = self._predicted(self.joint, self.joined)

    def asked(self) -> None:
        """Hold the fit that stands for the leg against all else that the folder has of it."""
        name, fit = "", self.joint
        if fit is None and len(self.fits) == 1:
            ((name, fit),) = self.fits.items()
        if fit is None:
            return
        recordings = self.joined if self.joint else (name,)
        trials = self._asked(fit, recordings)
        errors = {
            trial.name: str(finding.message)
            for trial in self.session.trials
            if trial.name in self.quality
            and trial.use in _ASKED
            and (finding := self._wrong(trial.name)) is not None
        }
        reasons = disagreements(fit, trials, self.fits, errors) + _apart(self.fits, self.joint)
        judged = doubted(fit.adequacy, reasons, OF_OTHER_TRIALS, recordings)
        if judged == fit.adequacy:
            return
        fit = replace(fit, assessment=replace(fit.assessment, adequacy=judged))
        if self.joint is None:
            self.fits[name] = fit
        else:
            self.joint = fit
        if self.root is not None:
            fit.save(self.root / (JOINT if self.joint else fit_name(name)))

    def _asked(self, fit: Fit, of: Sequence[str]) -> list[AskedTrial]:
        """The trials that a fit is of, and those that it can predict."""
        asked = []
        relaxed = all(self.session[name].effort == "passive" for name in of)
        for trial in self.session.trials:
            if trial.name not in self.inputs or trial.use not in _ASKED:
                continue
            parts = self.inputs[trial.name]
            predictions: tuple[Prediction, ...] = ()
            if trial.name not in of:
                if relaxed and trial.effort != "passive":
                    continue
                try:
                    predictions = predict_others(fit.result, parts, fit.assessment.uncertainty)
                except (InputError, ComputationError):
                    continue  # its row says why
            asked.append(AskedTrial(trial, parts, predictions))
        return asked

    def _predicted(self, fit: Fit, of: tuple[str, ...]) -> dict[str, Crossed]:
        """How a fit of these trials follows every trial; without effort it knows no active one."""
        passive = {trial.name for trial in self.session.trials if trial.effort == "passive"}
        return {
            trial: Crossed(reason=NO_EFFORT)
            if passive.issuperset(of) and trial not in passive
            else _crossed(fit, inputs, trial in of)
            for trial, inputs in self.inputs.items()
        }

    def result(self) -> SessionResult:
        """What there is; a check finds nothing new where it says what the trial is known to be."""
        quality = {name: self._new(name) for name in self.quality}
        return SessionResult(
            self.session,
            self.settings,
            self.fits,
            self.joint,
            self.joined,
            self.failed,
            quality,
            self.predictions,
            self.joint_predictions,
            self.interrupted,
            self.nerve,
            efforts_of(
                part
                for trial in self.session.trials
                if trial.effort == "maximal"
                for part in self.inputs.get(trial.name, ())
            ),
        )

    def _new(self, name: str) -> Quality:
        """What was found in a trial, but for what says again what it is known to be."""
        known = _known(self.session[name])
        checked = self.quality[name]
        return replace(checked, findings=tuple(f for f in checked.findings if f.code not in known))

    def _wrong(self, name: str) -> Finding | None:
        """The first finding of a trial that is an error, and new; its parts have no gap."""
        known = (*_known(self.session[name]), *["time-gap"][: len(self.inputs[name]) - 1])
        errors = (f for f in self.quality[name].findings if f.severity == "error")
        return next((f for f in errors if f.code not in known), None)

    def _of(self, names: Sequence[str]) -> tuple[tuple[ModelInputs, ...], tuple[Quality, ...]]:
        ordered = in_order_of_content(names, self.inputs)
        parts = tuple(part for name in ordered for part in self.inputs[name])
        return parts, tuple(self._new(name) for name in ordered)

    def _saved(self, file: str, names: Sequence[str]) -> Fit | None:
        """The fit in a file, where it is of these data and this question and by this surae."""
        if self.root is None or not (self.root / file).is_file():
            return None
        try:
            fit = load(self.root / file)
        except InputError:
            return None
        same = (
            fit.result.versions.get("surae") == __version__
            and fit.settings == self.settings
            and _same_inputs(fit, self._of(names)[0])
        )
        return fit if same else None

    def _fit_or_saved(
        self, name: str, file: str, names: tuple[str, ...], beside: "_Beside | None" = None
    ) -> tuple[Fit | None, str]:
        """A fit, the one on disk where it is of the same, and how it went."""
        saved = self._saved(file, names)
        if saved is not None:
            return saved, f"{saved.adequacy.grade}, R² {saved.adequacy.r2:.2f} % (kept)"
        self._tell(f"fitting {name}" if len(names) == 1 else f"fitting {len(names)} together")
        begun = time.monotonic()
        fit = None
        if beside is not None:
            self.crossed()  # meanwhile
            fit = beside.fit(names)
        try:
            fit = fit or fit_inputs(self._of(names)[0], self.settings, self._of(names)[1])
        except (InputError, ComputationError) as error:
            return None, str(error)
        if fit.result.solution.is_interrupted:
            raise KeyboardInterrupt  # an unfinished fit is none
        if self.root is not None:
            fit.save(self.root / file)
        seconds = time.monotonic() - begun
        self._spent += seconds
        self._paid += self._cost[name]
        return fit, f"{fit.adequacy.grade}, R² {fit.adequacy.r2:.2f} %, {seconds:.0f} s"

    def _tell(self, step: str) -> None:
        self.progress(Step(step, self._done, len(self._steps), self._remaining_seconds()))

    def _step(self, name: str, outcome: str) -> None:
        self._done += 1
        self._cost.pop(name, None)
        self.progress(Step(name, self._done, len(self._steps), self._remaining_seconds(), outcome))

    def _remaining_seconds(self) -> float | None:
        """About how long the rest takes, by how long a sample has taken."""
        if self._paid <= 0.0:
            return None
        return self._spent * sum(self._cost.values()) / self._paid


class _Beside:
    """A process in which the joint fit is made while this one makes the others; a context."""

    def __init__(self) -> None:
        self._child, self._thread = Child(), ThreadPoolExecutor(1)
        self._folder = TemporaryDirectory(prefix="surae-")
        self._path = Path(self._folder.name, JOINT)
        self._names: tuple[str, ...] = ()
        self._end = self._submit("ready")  # to load all that a fit needs takes seconds

    def __enter__(self) -> "_Beside":
        return self

    def __exit__(self, *_: object) -> None:
        """End it, with the fit at work."""
        self._child.close()
        self._thread.shutdown()
        self._folder.cleanup()

    def begin(
        self,
        names: tuple[str, ...],
        inputs: Sequence[ModelInputs],
        quality: Sequence[Quality],
        settings: FitSettings,
    ) -> None:
        """Begin the fit of these trials."""
        self._names = names
        request = {"inputs": inputs, "quality": quality, "settings": settings}
        self._end = self._submit("fit_apart", path=str(self._path), **to_plain(request))

    def fit(self, names: tuple[str, ...]) -> Fit | None:
        """The fit of these trials, when it is there; None where none was made."""
        if names != self._names or self._end.result().how != "done":
            return None
        return load(self._path)

    def _submit(self, function: str, **arguments: Plain) -> Future[End]:
        return self._thread.submit(self._child.call, f"{__name__}:{function}", arguments)


def ready() -> None:
    """Nothing: to call it loads this module."""


def fit_apart(inputs: Plain, quality: Plain, settings: Plain, path: str) -> None:
    """Fit in another process, and write the fit there."""
    fit_inputs(
        from_plain(tuple[ModelInputs, ...], inputs),
        from_plain(FitSettings, settings),
        from_plain(tuple[Quality, ...], quality),
    ).save(path)


#: Uses of trials that the fit of a leg is held against.
_ASKED = ("fit", "hold")
#: Why the fit of a passive trial predicts no active one: none of it shows what EMG does.
NO_EFFORT = "no effort here"


def _known(trial: Trial) -> tuple[str, ...]:
    """Codes of findings that say again that a trial holds still, or is passive."""
    still = () if trial.moves else ("angle-still", "rom-not-covered")
    return (*still, *(("active-not-active",) if trial.effort == "passive" else ()))


def _apart(alone: Mapping[str, Fit], joint: Fit | None) -> tuple[Reason, ...]:
    """The trial that contradicts all together in parameters that stiffness rests on, if any."""
    together = None if joint is None else joint.assessment
    found = contradictions({name: fit.assessment for name, fit in alone.items()}, together)
    names = sorted(PASSIVE & found.keys())
    return (against("apart", trial=found[names[0]][0], names=", ".join(names)),) if names else ()


def _same_inputs(fit: Fit, inputs: Sequence[ModelInputs]) -> bool:
    """Whether a fit is of these signals."""
    fitted = fit.result.problem.inputs
    return len(fitted) == len(inputs) and all(map(same_signals, fitted, inputs))


def _crossed(fit: Fit, parts: Sequence[ModelInputs], fitted: bool) -> Crossed:
    """How a fit follows a trial, all parts of it together; one of its own as it was fitted."""
    moves = any(float(np.ptp(part.angle)) >= STILL for part in parts)
    grade = ""
    covers = None
    if fitted:
        pairs = list(zip(fit.result.problem.inputs, fit.result.residuals, strict=True))
        errors = [
            next(counted(own, left) for own, left in pairs if same_signals(own, part))
            for part in parts
        ]
    else:
        try:
            predictions = predict_others(fit.result, parts, fit.assessment.uncertainty)
        except (InputError, ComputationError) as error:
            return Crossed(reason=str(error))
        errors = [each.errors for each in predictions]
        covers = finite(covered(predictions))
        grades = [str(each.adequacy.grade) for each in predictions if each.adequacy]
        grade = max(grades, key=[str(each) for each in Grade].index, default="") if moves else ""
    measured, e = (np.concatenate(each) for each in zip(*errors, strict=True))
    return Crossed(
        finite(vaf(measured, e)),
        finite(centred_r2(errors)) if moves or fitted else None,
        finite(float(np.sqrt(np.mean(e**2)))),
        finite(float(e.mean())),
        covers=covers,
        fitted=fitted,
        grade=grade,
    )
