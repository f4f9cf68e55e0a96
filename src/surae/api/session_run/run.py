"""A session's run: every trial checked and fitted, all together, each predicted by the others.

The joint fit takes longer than all others together, so it may run in a process beside them.
"""

import time
from collections.abc import Sequence
from contextlib import ExitStack
from dataclasses import replace
from pathlib import Path

from surae._version import __version__
from surae.api.fitted import Fit
from surae.api.fitting import fit_inputs, load
from surae.api.session_result import SessionResult, write_index, write_summary
from surae.api.session_run.agreement import held_against_others
from surae.api.session_run.beside import Beside
from surae.api.session_run.checked import CheckedTrials
from surae.api.session_run.predicted import predictions_by
from surae.api.session_run.progress import Progress, StepProgress
from surae.base.errors import ComputationError, InputError
from surae.base.files import PathLike
from surae.base.threads import cores
from surae.nerve.leg import Nerve
from surae.settings import FitSettings
from surae.signals import ModelInputs, same_signals
from surae.trials import Crossed, Trial, TrialSet, efforts_of
from surae.trials.folder import JOINT, TOO_FEW, claimed, fit_name
from surae.trials.nerve import nerve_of

#: The step in which all trials are fitted together.
_TOGETHER = "all together"
#: What a joint fit costs, in samples of fits of one trial.
_JOINT_COST = 1.5


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
        beside = stack.enter_context(Beside()) if (workers or cores()) > 1 else None
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
        self.trials = CheckedTrials(session, settings)
        self.fits: dict[str, Fit] = {}
        self.joint: Fit | None = None
        self.joined: tuple[str, ...] = ()
        self.failed: dict[str, str] = {}
        self.predictions: dict[str, dict[str, Crossed]] = {}
        self.joint_predictions: dict[str, Crossed] = {}
        self.nerve: Nerve | None = None
        self.interrupted = False
        names = [*(trial.name for trial in session.trials), _TOGETHER]
        self._progress = Progress(names, progress)

    def every_trial(self, beside: Beside | None) -> None:
        """Prepare and check each trial, and fit those that can be, the joint fit begun `beside`."""
        self.trials.check(self._progress.tell)
        inputs = self.trials.inputs
        cost = {
            name: float(sum(part.n for part in inputs[name]))
            for name in self.session.fitted
            if name in inputs
        }
        sound = tuple(name for name in cost if self.trials.wrong(name) is None)
        self._progress.expect({**cost, _TOGETHER: _JOINT_COST * sum(cost.values())})
        if beside is not None and len(sound) > 1 and self._saved(JOINT, sound) is None:
            beside.begin(sound, *self.trials.parts_of(sound), self.settings)
        for trial in self.session.trials:
            self._progress.step(trial.name, self._fit_alone(trial))

    def _fit_alone(self, trial: Trial) -> str:
        """Fit a trial by itself, if it can be; return what came of it."""
        name = trial.name
        if name in self.trials.unreadable:
            return self.trials.unreadable[name]
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

    def together(self, beside: Beside | None) -> None:
        """Fit all trials together that were fitted and have no error."""
        candidates = [
            name
            for name in self.session.fitted
            if name in self.fits or (name in self.trials.inputs and not self.session[name].moves)
        ]
        for name in candidates:
            if (finding := self.trials.wrong(name)) is not None:
                self.failed[name] = f"not in the joint fit: {finding.code}: {finding.message}"
        names = tuple(
            name
            for name in candidates
            if self.trials.wrong(name) is None
            and (name not in self.fits or self.fits[name].status != "failed")
        )
        if len(names) < 2:
            alone = "a joint fit needs two trials that can be fitted"
            self.failed["joint"] = TOO_FEW if len(candidates) > 1 else alone
            self._progress.step(_TOGETHER, self.failed["joint"])
            return
        fit, outcome = self._fit_or_saved(_TOGETHER, JOINT, names, beside)
        if fit is None:
            self.failed["joint"] = outcome
        else:
            self.joint = fit
            self.joined = names
        self._progress.step(_TOGETHER, outcome)

    def nerves(self) -> None:
        """What stretches and perturbations say of reflexes."""
        self._progress.tell("telling tissue from nerve")
        self.nerve = nerve_of(self.session.trials)

    def crossed(self) -> None:
        """Predict every trial by every fit that has not yet."""
        for name, fit in self.fits.items():
            if name not in self.predictions:
                self.predictions[name] = self._predictions(fit, (name,))
        if self.joint is not None:
            self.joint_predictions = self._predictions(self.joint, self.joined)

    def _predictions(self, fit: Fit, of: Sequence[str]) -> dict[str, Crossed]:
        return predictions_by(fit, of, self.session, self.trials.inputs)

    def asked(self) -> None:
        """Hold the fit that stands for the leg against all else that the folder has of it."""
        name, fit = "", self.joint
        if fit is None and len(self.fits) == 1:
            ((name, fit),) = self.fits.items()
        if fit is None:
            return
        recordings = self.joined if self.joint else (name,)
        judged = held_against_others(fit, recordings, self.trials, self.fits)
        if judged == fit.adequacy:
            return
        fit = replace(fit, assessment=replace(fit.assessment, adequacy=judged))
        if self.joint is None:
            self.fits[name] = fit
        else:
            self.joint = fit
        if self.root is not None:
            fit.save(self.root / (JOINT if self.joint else fit_name(name)))

    def result(self) -> SessionResult:
        """What there is; a check finds nothing new where it says what the trial is known to be."""
        quality = {name: self.trials.new(name) for name in self.trials.quality}
        return SessionResult(
            self.session,
            self.settings,
            self.fits,
            self.joint,
            self.joined,
            {**self.trials.unreadable, **self.failed},
            quality,
            self.predictions,
            self.joint_predictions,
            self.interrupted,
            self.nerve,
            efforts_of(
                part
                for trial in self.session.trials
                if trial.effort == "maximal"
                for part in self.trials.inputs.get(trial.name, ())
            ),
        )

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
            and _same_inputs(fit, self.trials.parts_of(names)[0])
        )
        return fit if same else None

    def _fit_or_saved(
        self, name: str, file: str, names: tuple[str, ...], beside: Beside | None = None
    ) -> tuple[Fit | None, str]:
        """A fit, the one on disk where it is of the same, and how it went."""
        saved = self._saved(file, names)
        if saved is not None:
            return saved, f"{saved.adequacy.grade}, R² {saved.adequacy.r2:.2f} % (kept)"
        self._progress.tell(
            f"fitting {name}" if len(names) == 1 else f"fitting {len(names)} together"
        )
        begun = time.monotonic()
        fit = None
        if beside is not None:
            self.crossed()  # meanwhile
            fit = beside.fit(names)
        try:
            fit = fit or fit_inputs(
                self.trials.parts_of(names)[0], self.settings, self.trials.parts_of(names)[1]
            )
        except (InputError, ComputationError) as error:
            return None, str(error)
        if fit.result.solution.is_interrupted:
            raise KeyboardInterrupt  # an unfinished fit is none
        if self.root is not None:
            fit.save(self.root / file)
        seconds = time.monotonic() - begun
        self._progress.made(name, seconds)
        return fit, f"{fit.adequacy.grade}, R² {fit.adequacy.r2:.2f} %, {seconds:.0f} s"


def _same_inputs(fit: Fit, inputs: Sequence[ModelInputs]) -> bool:
    """Whether a fit is of these signals."""
    fitted = fit.result.problem.inputs
    return len(fitted) == len(inputs) and all(map(same_signals, fitted, inputs))
