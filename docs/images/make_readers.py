"""Draw the pictures of the readers' pages: the relaxed leg, and stretches taken apart."""

import sys
import tempfile
from pathlib import Path

import surae
from surae.api import words_in
from surae.nerve.leg import stretch_torque
from surae.report.figures import png
from surae.report.nerve_card import stretches_figure

HERE = Path(__file__).parent
sys.path.insert(0, str(HERE.parents[1] / "tests"))
from perturbed_ankle import ramps  # noqa: E402

with tempfile.TemporaryDirectory() as folder:
    leg = surae.api.example_leg(folder)
    relaxed = surae.relaxed([path for path in leg if path.stem != "active_2"])
    (HERE / "relaxed.png").write_bytes(png(relaxed.plot().figure))
found = surae.stretches(ramps((10.0, 10.0, 60.0, 120.0, 180.0), neural=6.0, rate=500.0))
each = [stretch_torque(stretch) for stretch in found.stretches]
(HERE / "nerve.png").write_bytes(png(stretches_figure(each, words_in("en"))))
