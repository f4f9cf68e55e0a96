"""The parameters of the model of 2010; what computes it is in `muscle_2010.py`."""

from dataclasses import replace

from surae.base.frozen import FrozenDict
from surae.base.words import N_
from surae.model.parameter import Parameter
from surae.model.parameters import MUSCLE_PARAMETERS
from surae.model.prior import Prior

_OF = {p.name: p for p in MUSCLE_PARAMETERS}
#: The ten parameters of the model of 2010 (thesis Table 1, left), in the order of the thesis.
PARAMETERS_2010: tuple[Parameter, ...] = (
    _OF["m"],
    _OF["k_tri"],
    replace(_OF["x0_tri"], meaning="length shift, triceps surae"),
    *(
        replace(_OF[f"g{n}"], name=f"e{n}", meaning="I" + _OF[f"g{n}"].meaning)
        for n in (1, 2, 3, 4)
    ),
    replace(
        _OF["f0"],
        name="f",
        known=FrozenDict(),
        wide=Prior(1.96, 0.375, "about 2 Hz (van de Poll 2015, Table 1); spread assumed"),
    ),
    Parameter(
        "b_tri",
        "N·s/m",
        "viscosity, triceps surae",
        "passive",
        500.0,
        0.0,
        2e4,
        positive=False,
        wide=Prior(500.0, 1.5, "assumed, around the start of the model of 2010; none known"),
        advice=N_("stretch the relaxed triceps faster, and at several speeds"),
    ),
    Parameter(
        "F0",
        "N",
        "force shift, triceps surae",
        "passive",
        0.0,
        -500.0,
        500.0,
        False,
        True,
        N_("add a passive part with the triceps slack: plantarflexion at rest"),
    ),
)
WEIGHTS_2010 = ("e1", "e2", "e3", "e4")
