"""A fit as users hold it: what was found, what it is worth, and what follows from it."""

from collections.abc import Mapping, Sequence
from dataclasses import dataclass
from typing import TYPE_CHECKING, Literal

import numpy as np

from surae.api.estimates import Estimates
from surae.api.fitted_frames import FitFrames
from surae.api.fitted_pages import FitPages
from surae.api.given import AnyRecording
from surae.api.plots import Plots, numbered
from surae.api.recordings import as_in_fit
from surae.api.simulation import parts_of, tendon_of
from surae.base.files import PathLike
from surae.base.tables import Tabular, TextTable
from surae.base.units import FloatArray
from surae.inference import Grade
from surae.inference.judging.assessment import assess
from surae.inference.judging.criteria import criteria_of
from surae.inference.judging.grade import Adequacy
from surae.inference.judging.parameter import ParameterEstimate
from surae.inference.judging.validation import Prediction, predict_others
from surae.inference.saved.fit_json import save_fit
from surae.inference.uncertainty.covariance import Covariance
from surae.model import TendonState, TorqueParts
from surae.settings import FitSettings

if TYPE_CHECKING:
    from surae.causal.predictor import Predictor
    from surae.measures import Measures


@dataclass(frozen=True, slots=True, repr=False)
class Fit(Tabular, FitFrames, FitPages):
    """A fit and what it is worth."""

    def as_table(self) -> TextTable:
        """The fit on one screen, as texts.

        Returns
        -------
        TextTable
            What it is worth, its parameters and their verdicts.
        """
        from surae.report.summary import fit_table

        return fit_table(self)

    def summary(self) -> str:
        """The fit on one screen: what it is worth, its parameters and their verdicts.

        Returns
        -------
        str
            Some thirty lines.
        """
        return self.as_table().text()

    def reassess(self) -> "Fit":
        """The same fit as this version of surae judges it; `load` keeps what its file says.

        Returns
        -------
        Fit
            Its values are the same.
        """
        quality = self.quality
        return Fit(self.result, assess(self.result, alternatives=True, quality=quality), quality)

    @property
    def plot(self) -> Plots:
        """Plots that return Matplotlib axes: ``fit.plot()``, ``fit.plot.torque()``, …."""
        return Plots(self.result, self.assessment)

    def fit_report(self, min_correlation: float = 0.1) -> str:
        """The fit as lmfit's users read one: statistics, variables, correlations.

        Parameters
        ----------
        min_correlation : float
            Correlations that are smaller are left out.

        Returns
        -------
        str
            Standard errors are those of `ParameterEstimate.trusted_sem`, systematics included.
        """
        from surae.report.lmfit_like import fit_report

        return fit_report(self, min_correlation)

    def __getitem__(self, name: str) -> ParameterEstimate:
        """A parameter or nuisance by name: ``fit["l0_tri"].ci95``.

        Raises
        ------
        InputError
            The fit has none of that name.
        """
        return Estimates({**self.parameters, **self.nuisances})[name]

    @property
    def parameters(self) -> Estimates:
        """Every parameter of the model by name: value, sem, ci95, verdict and more."""
        return Estimates(self.assessment.parameters)

    @property
    def nuisances(self) -> Estimates:
        """What was found of the laboratory, by name; empty for a named model."""
        return Estimates(self.assessment.nuisances)

    @property
    def values(self) -> Mapping[str, float]:
        """Every parameter's value by name, ready for `simulate`."""
        return self.result.values

    @property
    def settings(self) -> FitSettings:
        """The settings; `surae.fit` takes them to fit other recordings alike."""
        return self.result.problem.settings

    @property
    def status(self) -> str:
        """``"converged"``, ``"at-bounds"`` or ``"failed"``."""
        return self.result.status

    @property
    def message(self) -> str:
        """What happened, with advice where it failed."""
        return self.result.message

    @property
    def residual(self) -> FloatArray:
        """Measured minus modelled torque [Nm], of all recordings one after the other, shape (n,).

        At the fit's rate, by the parameters alone: what `auto` lays on a moment is in it.
        """
        return np.concatenate(self.result.residuals)

    @property
    def aic(self) -> float | None:
        """Akaike's information criterion of the samples that count; see `surae.compare`."""
        return criteria_of(self.result).aic

    @property
    def bic(self) -> float | None:
        """Bayes' information criterion of the samples that count; see `surae.compare`."""
        return criteria_of(self.result).bic

    @property
    def vaf(self) -> float:
        """Variance accounted for over all recordings, equation (31) [%]."""
        return self.assessment.vaf

    @property
    def adequacy(self) -> Adequacy:
        """Whether the fit is good enough for its numbers to mean something: grade and reasons."""
        return self.assessment.adequacy

    @property
    def vaf_weighted(self) -> float | None:
        """VAF with the samples counted as the fit did; None where all count alike [%]."""
        return self.assessment.vaf_weighted

    @property
    def covariance(self) -> Covariance:
        """Names and covariance matrix of the estimates that have one, equation (33)."""
        return self.assessment.covariance

    @property
    def ipde(self) -> float | None:
        """Inter-parameter dependency, equation (35); None where there is none."""
        return self.assessment.ipde

    def parts(self, recording: int = 0) -> TorqueParts:
        """The modelled torque of the fit's first, second, … recording, split into its parts.

        Parameters
        ----------
        recording : int
            Its number, from 0.

        Returns
        -------
        TorqueParts
            Each part over time [Nm], shape (n,).

        Raises
        ------
        InputError
            The fit has no such recording.
        ComputationError
            The torque is not finite, as in a fit that failed at its start.
        """
        problem = self.result.problem
        inputs = numbered(problem.inputs, recording)
        return parts_of(problem.spec, self.values, inputs, problem.options)

    def tendon(self, recording: int = 0) -> TendonState:
        """What muscles and tendons do in the fit's first, second, … recording.

        Parameters
        ----------
        recording : int
            Its number, from 0.

        Returns
        -------
        TendonState
            Lengths, velocities and forces over time.

        Raises
        ------
        InputError
            The fit has no such recording, or its model has rigid tendons.
        """
        problem = self.result.problem
        inputs = numbered(problem.inputs, recording)
        return tendon_of(problem.spec, self.values, inputs, problem.options)

    def predict(self, recording: AnyRecording, *, prepared: bool | None = None) -> Prediction:
        """Predict the torque of another recording, and how well it does (thesis 2.7).

        Parameters
        ----------
        recording : Recording, ModelInputs or path
            With its measured torque.
        prepared : bool, optional
            Whether its signals are used as they are; by default as they were in the fit.

        Returns
        -------
        Prediction
            Predicted torque, VAF, RMS error and bias; and what is predicted without a model. Where
            a fit of `auto` to inverse dynamics is not adequate and the movement is another one, its
            torque is averaged with that of the muscle model without departures.

        Raises
        ------
        InputError
            It has no torque, or EMG that the fit's weights do not go with.
        """
        inputs = as_in_fit(self.result.problem, [recording], prepared)
        adequate = self.adequacy.grade == Grade.ADEQUATE
        known = self.assessment.uncertainty
        return predict_others(self.result, inputs, known, adequate=adequate)[0]

    def predictor(
        self,
        rate_hz: float = 1000.0,
        *,
        emg: Literal["raw", "envelope"] | None = None,
        even_if_doubtful: bool = False,
    ) -> "Predictor":
        """The torque while it is measured: angle and EMG of each sample in, torque out.

        Its filters do not look ahead. Of the same signals, as its `run` gives them, `predict` has
        the same torque.

        Parameters
        ----------
        rate_hz : float
            Samples in a second [Hz].
        emg : {"raw", "envelope"}, optional
            How EMG will come; by default as it came to the fit.
        even_if_doubtful : bool
            Whether a fit that is not adequate has one too.

        Returns
        -------
        Predictor
            ``p.step(angle_rad, emg_V)`` [Nm], ``p.sd`` [Nm], ``p.reset()``; `to_c` writes it in C.

        Raises
        ------
        InputError
            The fit is not adequate, or its model, geometry or integrator has no predictor.

        Examples
        --------
        >>> p = surae.load("fit.json").predictor(1000)
        >>> torque = p.step(0.1, [0.0, 1e-4, 1e-4, 1e-4])
        """
        from surae.causal.predictor import predictor_of  # compiles

        return predictor_of(
            self.result, self.assessment, rate_hz, emg=emg, even_if_doubtful=even_if_doubtful
        )

    def measures(self, angles: Sequence[float] = (-10.0, 0.0, 10.0)) -> "Measures":
        """Torque, stiffness and more in a clinician's units, with intervals and verdicts.

        Parameters
        ----------
        angles : sequence of float
            Where torque and stiffness are given [deg], dorsiflexion positive.

        Returns
        -------
        Measures
            By name, e.g. ``"passive_stiffness@10deg"``.

        Raises
        ------
        InputError
            An angle is out of reach of an ankle.
        """
        from surae.measures import measures

        return measures(self, angles)

    def save(self, path: PathLike) -> None:
        """Write FIT.json; `load` reads it back without loss.

        Parameters
        ----------
        path : path
            Where to.

        Raises
        ------
        InputError
            The file cannot be written.
        """
        save_fit(path, self)
