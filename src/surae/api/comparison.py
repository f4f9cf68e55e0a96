"""Rigid or elastic tendons, asked of recordings."""

from collections.abc import Mapping, Sequence
from typing import Any

from surae.api.recordings import AnyRecording, as_inputs, several
from surae.assessment.comparison.compare import COMPARED, FEW_STARTS, Told, compare_models
from surae.assessment.comparison.finding import Comparison
from surae.model import ModelOptions


def compare(
    recordings: AnyRecording | Sequence[AnyRecording],
    models: Sequence[str] = COMPARED,
    *,
    fixed: Mapping[str, float] | None = None,
    prepared: bool = False,
    starts: int = FEW_STARTS,
    seed: int = 0,
    progress: Told | None = None,
    **options: Any,
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
    fixed : mapping of str to float, optional
        Parameters that are not estimated, by every model that has them.
    prepared : bool
        The signals are filtered and at the model's rate already: use them as they are.
    starts : int
        Number of starts of each fit to all data.
    seed : int
        Seed of the random starts.
    progress : callable, optional
        Called before every fit with (what it is, fits done, all fits).
    **options
        Model options, see `surae.model.ModelOptions`, e.g. ``tendon_strain="slack-length"``.

    Returns
    -------
    Comparison
        Ctrl-C keeps the fits that are complete; `missing` names the others.

    Raises
    ------
    InputError
        Something given is unknown, contradictory or unusable.
    """
    return compare_models(
        [as_inputs(one, prepared) for one in several(recordings)],
        models,
        fixed=fixed,
        options=ModelOptions.of(**options),
        starts=starts,
        seed=seed,
        progress=progress,
    )
