"""
How stiff is a measured ankle at rest?
======================================

Held angles and slow movements of a real leg on a dynamometer, through one description of their
columns. No muscle is modelled: the curve and its band come from rest alone.
``SURAE_DATA`` says where the published recordings are; where they are missing nothing is drawn.
"""

import os
from pathlib import Path

import surae

data = Path(os.environ.get("SURAE_DATA", "../../shared/data"))
mapping = data / "dynamometer" / "PL_50_01.toml"
trials = [data / "dynamometer" / "Pas_10.mat", *sorted((data / "repeats").glob("Pas_*.mat"))]
if mapping.is_file():
    relaxed = surae.relaxed(trials, mapping=mapping)
    print(relaxed)
    relaxed.plot()
else:
    print("the recordings are not here")
