"""Which integrator solves the equations of compliant tendons: ours, the thesis's, a plugin's."""

from collections.abc import Sequence

from surae.base.errors import InputError
from surae.base.names import CHOICES
from surae.base.plugins import plugins
from surae.model.explicit import EXPLICIT
from surae.model.muscle_tendon import MuscleTendonSimulator
from surae.model.options import ModelOptions
from surae.signals import ModelInputs


def muscle_tendon_simulator(
    inputs: ModelInputs, options: ModelOptions, optional: Sequence[str] = ()
) -> MuscleTendonSimulator:
    """The simulator whose integrator `options` name, with these optional parameters."""
    if options.integrator == CHOICES["integrator"][0]:
        return MuscleTendonSimulator(inputs, options, optional)
    added = EXPLICIT | plugins("integrators", type)
    if options.integrator not in added:
        raise InputError(f"integrator {options.integrator} is not installed")
    tied: MuscleTendonSimulator = added[options.integrator](inputs, options, optional)
    return tied
