"""What a model reads of recordings, by the settings of a fit."""

from collections.abc import Mapping, Sequence
from typing import TYPE_CHECKING, Any

from surae.base.errors import InputError
from surae.model.knowledge import Knowledge

if TYPE_CHECKING:  # what computes comes when it is needed: help reads the fields alone
    from surae.recording import Recording
    from surae.signals import ModelInputs, Weighting


class PreparesInputs:
    """The part of `FitSettings` that recordings are prepared by."""

    __slots__ = ()

    if TYPE_CHECKING:
        prepared: bool
        preparation: Mapping[str, Any]
        normalise: str | None
        weights: Weighting | tuple[Weighting, ...] | None
        knowledge: Knowledge | None

    def inputs(
        self,
        recordings: "Sequence[Recording | ModelInputs]",
        mvc: "Sequence[Recording | ModelInputs]" = (),
    ) -> "tuple[ModelInputs, ...]":
        """What the model reads of recordings: prepared, normalised, weighted.

        Parameters
        ----------
        recordings : sequence of Recording or ModelInputs
            What is to be fitted; model inputs are prepared already.
        mvc : sequence of Recording or ModelInputs
            Maximum voluntary contractions, for ``normalise="mvc"``.

        Returns
        -------
        tuple of ModelInputs
            For `make_problem`.

        Raises
        ------
        InputError
            A recording cannot be prepared so.
        """
        from surae.signals import normalise, settled, weighted

        made: tuple[ModelInputs, ...] = tuple(self.prepare(recording) for recording in recordings)
        if self.normalise is not None:
            made = normalise(made, self.normalise, mvc=[self.prepare(each) for each in mvc])
        elif mvc:
            raise InputError("mvc has no effect without normalise='mvc'; give both")
        made = settled(made)
        return made if self.weights is None else weighted(made, self.weights)

    def prepare(self, recording: "Recording | ModelInputs") -> "ModelInputs":
        """What the model reads of one recording, before EMG is normalised and samples weighted.

        Parameters
        ----------
        recording : Recording or ModelInputs
            Model inputs are prepared already.

        Returns
        -------
        ModelInputs
            The signals on one time axis.
        """
        from surae.model.tare import without
        from surae.signals import ModelInputs, Preparation, prepare

        if isinstance(recording, ModelInputs):
            return recording
        how = Preparation().updated(self.preparation)
        made = prepare(recording, how, prepared=self.prepared)
        plate = None if self.knowledge is None else self.knowledge.plate
        return made if plate is None else without(plate, made)
