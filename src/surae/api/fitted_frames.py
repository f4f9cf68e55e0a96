"""A fit as tables of other packages: pandas, xarray, ArviZ."""

from typing import TYPE_CHECKING, Any

from surae.api.plots import numbered
from surae.inference import AssessedFit
from surae.inference.posterior.linearised import measured
from surae.recording.frames import library

if TYPE_CHECKING:
    pass


class FitFrames(AssessedFit):
    """What a fit gives to other packages."""

    __slots__ = ()

    def to_dataframe(self) -> Any:
        """The parameters as a pandas DataFrame, a row each by name.

        Returns
        -------
        pandas.DataFrame
            Value, unit, ends of the 95 % interval and of that of another trial, standard error,
            verdict, whether it is free and at a bound, meaning; NaN where there is no number.
        """
        from surae.recording.frames import frame

        rows = []
        for p in self.assessment.parameters.values():
            (low, high) = p.ci95 or (None, None)
            again = p.ci95_repeat or (None, None)
            rows.append(
                {
                    "parameter": p.name,
                    "value": p.value,
                    "unit": p.unit,
                    "low": low,
                    "high": high,
                    "repeat_low": again[0],
                    "repeat_high": again[1],
                    "sem": p.trusted_sem,
                    "verdict": str(p.verdict),
                    "free": p.free,
                    "at_bound": p.at_bound,
                    "meaning": p.meaning,
                }
            )
        return frame(rows, {}).set_index("parameter")

    def to_inference_data(
        self, draws: int = 1000, *, seed: int = 0, log_likelihood: bool = False
    ) -> Any:
        """Draws for ArviZ of what the fit leaves possible: estimates, intervals and correlations.

        Of a valley that bends they know nothing: `surae.profile` follows it.

        Parameters
        ----------
        draws : int
            How many.
        seed : int
            Of the draws.
        log_likelihood : bool
            Whether each sample's is computed at each draw, its noise taken for white, which
            simulates every one of them.

        Returns
        -------
        xarray.DataTree or arviz.InferenceData
            As the installed ArviZ has it: groups ``posterior``, ``observed_data`` and, where there
            are priors, ``prior``. Parameters without an interval are left out.

        Raises
        ------
        InputError
            arviz-stats or xarray is not installed, or no parameter has an interval.
        """
        from surae.sampling.arviz_data import of_fit

        return of_fit(self, draws, seed, log_likelihood=log_likelihood)

    def to_xarray(self, recording: int = 0) -> Any:
        """Angle, torque and modelled torque of the fit's first, second, … recording over time.

        Parameters
        ----------
        recording : int
            Its number, from 0.

        Returns
        -------
        xarray.Dataset
            By time [s], units as attributes.

        Raises
        ------
        InputError
            The package xarray is not installed, or the fit has no such recording.
        """
        xarray = library("xarray", "a Dataset")
        inputs = numbered(self.result.problem.inputs, recording)
        torque = measured(inputs)
        columns = {
            "angle": (inputs.angle, "rad"),
            "torque": (torque, "Nm"),
            "modelled": (torque - self.result.residuals[recording], "Nm"),
        }
        variables = {name: ("time", values, {"units": u}) for name, (values, u) in columns.items()}
        return xarray.Dataset(variables, {"time": inputs.time}, {"name": inputs.name})

    @property
    def correlation(self) -> Any:
        """Correlation of the estimates as a pandas DataFrame: ``.loc["k_tri", "x0_tri"]``.

        Without pandas, `Fit.covariance` has names and matrix.
        """
        known = self.assessment.covariance
        table = library("pandas", "a table of correlations")
        return table.DataFrame(known.correlation, index=known.names, columns=known.names)

    @property
    def fascicles(self) -> Any:
        """Filmed fascicles over time, measured and modelled [m], as a pandas DataFrame."""
        from surae.inference.judging.fascicles import fascicles_of
        from surae.recording.frames import frame

        return frame(
            [
                {
                    "recording": f.recording,
                    "channel": f.channel,
                    "time": t,
                    "measured": y,
                    "modelled": x,
                }
                for f in fascicles_of(self.result)
                for t, y, x in zip(f.time, f.measured, f.modelled, strict=True)
            ],
            {"time": "s", "measured": "m", "modelled": "m"},
        )
