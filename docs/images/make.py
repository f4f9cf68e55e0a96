"""Draw the README's picture: the fit of a virtual subject on the Achilles manipulator."""

from pathlib import Path

import surae
from surae.protocol import Protocol, generate, named_device
from surae.report.figures import png
from surae.report.figures.torque import torque_figure
from surae.report.traces import traces_of
from surae.studies import virtual_subject, virtual_trial

protocol = Protocol(
    profile="multiple-holds", chirp_amplitude=0.2, chirp_rate=0.159, device=named_device("achilles")
)
fit = surae.fit(virtual_trial(virtual_subject(seed=1), generate(protocol)), "muscle")
(traces,) = traces_of(fit.result)
(Path(__file__).parent / "fit.png").write_bytes(png(torque_figure(traces)))
