"""How much is nerve: tissue and reflex of an ankle, from perturbations and from stretches."""

from surae.nerve.answer import Impedance, joined
from surae.nerve.identify import Number
from surae.nerve.impedance import NerveMeasure, Perturbed, ReflexPath, inertia_of_empty, perturbed
from surae.nerve.stretches import StretchAnswer, Stretches, answers

__all__ = [
    "Impedance", "NerveMeasure", "Number", "Perturbed", "ReflexPath", "StretchAnswer", "Stretches",
    "answers", "inertia_of_empty", "joined", "perturbed",
]  # fmt: skip
