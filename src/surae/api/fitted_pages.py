"""A fit on paper: its report, its figure."""

from collections.abc import Sequence
from typing import TYPE_CHECKING, Any

from surae.base.files import PathLike
from surae.inference import AssessedFit
from surae.inference.judging.validation import Prediction

if TYPE_CHECKING:
    from surae.report.output import Report


class FitPages(AssessedFit):
    """What a fit writes for people."""

    __slots__ = ()

    def figure(self, path: PathLike, *, width: float = 170.0) -> None:
        """Draw the fit for a paper: lines with embedded fonts as ``.svg`` or ``.pdf``, or a PNG.

        Of one recording it shows the EMG, the angle, the torque and its parts, of movement that
        repeats itself over the cycle too; of several their torque.

        Parameters
        ----------
        path : path
            Where to.
        width : float
            Width of the figure [mm].

        Raises
        ------
        InputError
            The file cannot be written.
        """
        from surae.report.figures import write_figure
        from surae.report.figures.torque import fit_figure

        notes = [f"R² {recording.r2:.1f} %" for recording in self.assessment.recordings]
        write_figure(path, fit_figure(self.result, notes, width=width / 25.4))

    def report(self, path: PathLike, *, validation: Sequence[Prediction] = ()) -> None:
        """Write the report: one self-contained HTML file, or a PDF where it ends in ``.pdf``.

        Parameters
        ----------
        path : path
            Where to.
        validation : sequence of Prediction, optional
            Predictions of other recordings to show, as `validate` makes them.
        """
        self._report(validation).write(path)

    def blocks(self) -> dict[str, Any]:
        """The report as plain data: its blocks, its images as data URLs, and its signals."""
        return self._report().plain()

    def _report(self, predictions: Sequence[Prediction] = ()) -> "Report":
        from datetime import datetime

        from surae.report.fit import fit_report  # matplotlib, only when one is made

        now = datetime.now().astimezone()
        versions = self.result.versions
        return fit_report(self, predictions, versions=versions, created=now)
