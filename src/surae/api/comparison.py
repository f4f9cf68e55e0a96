"""Rigid or elastic tendons, asked of recordings."""

from collections.abc import Sequence
from typing import Any

from surae.api.fitting import asks_as_fit
from surae.api.recordings import AnyRecording, read_in, several
from surae.assessment.comparison.compare import COMPARED, FEW_STARTS, compare_models
from surae.assessment.comparison.finding import Comparison
from surae.estimation import FitSettings
from surae.progress import NamedProgress


@asks_as_fit
def compare(
    recordings: AnyRecording | Sequence[AnyRecording],
    models: Sequence[str] = COMPARED,
    settings: FitSettings | None = None,
    *,
    mvc: AnyRecording | Sequence[AnyRecording] = (),
    progress: NamedProgress | None = None,
    **asked: Any,
) -> Comparison:
    """Rigid or elastic: whether the data need tendons that give way, and what it changes.

    Every model is fitted to all data, and again without each recording in turn (of a single one:
    each quarter in turn), which it then predicts. `Comparison.rule` says how the finding follows.

    Parameters
    ----------
    recordings : Recording, ModelInputs, path, or a sequence of them
        Several share all parameters.
    models : sequence of str
        At least one without tendons and one with.
    settings : FitSettings, optional
        What every model is asked, as far as it has the parameters, e.g. ``fit.settings``; by
        default what `fit` asks, from three starts.
    mvc : Recording, ModelInputs, path, or a sequence of them
        Maximum voluntary contractions, for ``normalise="mvc"``.
    progress : callable, optional
        Called before every fit with (what it is, fits done, all fits).
    **asked
        Keywords of `fit`: ``fixed``, ``priors``, ``weights``, ``starts``, model options, …

    Returns
    -------
    Comparison
        Ctrl-C keeps the fits that are complete; `missing` names the others.

    Raises
    ------
    InputError
        Something given is unknown, contradictory or unusable.
    """
    whole = FitSettings.of(settings or FitSettings(starts=FEW_STARTS), **asked)
    given = [read_in(recording) for recording in several(recordings)]
    inputs = whole.inputs(given, [read_in(recording) for recording in several(mvc)])
    return compare_models(inputs, models, whole, progress)
