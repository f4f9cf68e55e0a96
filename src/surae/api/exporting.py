"""A fit as a model file of another simulator."""

from surae.api.answers import fit_of
from surae.api.fitted import Fit
from surae.exchange import ExportedModel, exported
from surae.files import PathLike


def export(fit: Fit | PathLike, *, to: str) -> ExportedModel:
    """The leg of a fit as a model of OpenSim or MuJoCo, with how far its torque is from ours.

    Parameters
    ----------
    fit : Fit or path
        A fit, its file, or the folder of a session, whose joint fit is taken.
    to : {"osim", "mjcf"}
        Whose model file: OpenSim's (4.5 or later) or MuJoCo's.

    Returns
    -------
    ExportedModel
        The file's text, and the difference of both torques; `save` writes it.

    Raises
    ------
    InputError
        The format is not known, the fit cannot be read, or its model has no such muscles.
    """
    given = fit_of(fit)
    return exported(given.result, given.assessment, to)
