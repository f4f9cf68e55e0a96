"""Signs, units and zeros of a recording that are wrong: what it might be is tried by quick fits.

Numbers alone rarely say that an angle is turned. A model does: with the right signs it explains
the torque, with the wrong ones it cannot, for active muscles only pull.
"""

from surae.inference.diagnosis.findings import STILL, examined
from surae.inference.diagnosis.units import wrong_units

__all__ = ["STILL", "examined", "wrong_units"]
