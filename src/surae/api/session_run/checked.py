"""The trials of a session as a run has checked them: signals, findings, and what is wrong."""

from collections.abc import Callable, Sequence
from dataclasses import replace

from surae.api.recordings import checks_for, electrodes_of_leg, explained, in_set
from surae.base.errors import InputError
from surae.quality import Finding, Quality
from surae.settings import FitSettings
from surae.signals import ModelInputs
from surae.trials import Trial, TrialSet, in_order_of_content, prepared_for


def _known(trial: Trial) -> tuple[str, ...]:
    """Codes of findings that say again that a trial holds still, or is passive."""
    still = () if trial.moves else ("angle-still", "rom-not-covered")
    return (*still, *(("active-not-active",) if trial.effort == "passive" else ()))


class CheckedTrials:
    """Signals and findings of each trial that can be read."""

    def __init__(self, session: TrialSet, settings: FitSettings) -> None:
        self.session = session
        self.settings = settings
        self.inputs: dict[str, tuple[ModelInputs, ...]] = {}
        self.quality: dict[str, Quality] = {}
        self.unreadable: dict[str, str] = {}  #: Why a trial has neither.

    def check(self, tell: Callable[[str], None]) -> None:
        """Prepare and check each trial."""
        reference = self.session.emg_reference(self.settings)
        electrodes = electrodes_of_leg(self.session, self.settings)
        for trial in self.session.trials:
            if trial.problem or trial.recording is None:
                self.unreadable[trial.name] = trial.problem
                continue
            tell(f"checking {trial.name}")
            try:
                self.inputs[trial.name] = prepared_for(self.settings, trial.recording, reference)
            except InputError as error:
                self.unreadable[trial.name] = str(explained(error, [trial.recording]))
                continue
            (self.quality[trial.name],) = checks_for(self.settings, [trial.recording], electrodes)
        self._weigh_holds()

    def _weigh_holds(self) -> None:
        """Judge holds by each other: what is wrong with one may be right in a set of them."""
        held = [t.name for t in self.session.trials if t.effort == "isometric" and t.use == "fit"]
        held = [name for name in held if name in self.quality]
        together = in_set([self.quality[name] for name in held])
        self.quality |= dict(zip(held, together, strict=True))

    def new(self, name: str) -> Quality:
        """What was found in a trial, but for what says again what it is known to be."""
        known = _known(self.session[name])
        checked = self.quality[name]
        return replace(checked, findings=tuple(f for f in checked.findings if f.code not in known))

    def wrong(self, name: str) -> Finding | None:
        """The first finding of a trial that is an error, and new; its parts have no gap."""
        known = (*_known(self.session[name]), *["time-gap"][: len(self.inputs[name]) - 1])
        errors = (f for f in self.quality[name].findings if f.severity == "error")
        return next((f for f in errors if f.code not in known), None)

    def parts_of(self, names: Sequence[str]) -> tuple[tuple[ModelInputs, ...], tuple[Quality, ...]]:
        """Signals and findings of some trials, in an order that their names do not set."""
        ordered = in_order_of_content(names, self.inputs)
        parts = tuple(part for name in ordered for part in self.inputs[name])
        return parts, tuple(self.new(name) for name in ordered)
