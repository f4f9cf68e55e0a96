"""The tendon's force as the thesis prints it: over lengths, with the slack length in it."""

import numpy as np

from surae.model.tendon import SLACK_TRI
from surae.units import FloatArray

#: Table 2, triceps surae: ε0, F̄toe [-], ktoe [-], Fmax [N].
EPS0, TOE, K_TOE, F_MAX = 0.04, 0.3, 4.0, 8000.0


def printed_force(
    length: FloatArray, slack: float = SLACK_TRI, *, strain: bool = False
) -> FloatArray:
    """Force of the triceps's tendon by equations (18) to (21), letter by letter.

    Parameters
    ----------
    length : ndarray, shape (n,)
        lt [m].
    slack : float
        lt0 [m].
    strain : bool
        Take ε0 as a strain of `slack` (Thelen 2003); as printed it is in metres.

    Returns
    -------
    ndarray, shape (n,)
        F_t [N]; none where the tendon is slack.
    """
    eps0 = EPS0 * slack if strain else EPS0
    grown = np.exp(K_TOE)
    toe_force = TOE * F_MAX  # (19)
    toe_length = slack + eps0 * TOE * K_TOE * grown / (
        grown * (1.0 - TOE + TOE * K_TOE) + TOE - 1.0
    )  # (20)
    stiffness = F_MAX / eps0 * (1.0 - TOE + TOE * K_TOE * grown / (grown - 1.0))  # (21)
    part = np.clip((length - slack) / (toe_length - slack), 0.0, 1.0)
    toe = toe_force / (grown - 1.0) * (np.exp(K_TOE * part) - 1.0)
    force: FloatArray = np.where(
        length > toe_length, stiffness * (length - toe_length) + toe_force, toe
    )  # (18)
    return force
