"""What a perturbation will tell: intervals of a usual ankle, before anybody is measured."""

import numpy as np

from surae.base.units import FloatArray
from surae_nerve.cascade import Structure
from surae_nerve.fitting import Fitted, Problem, noise_of, regressors
from surae_nerve.identify import INTRINSIC, REFLEX, Judged, Number
from surae_nerve.piece import TOP, Piece

#: A relaxed to moderately tense ankle with a reflex (Kearney 1997, Mirbagheri 2000).
USUAL = {
    "late": 0.0, "delay": 0.04, "omega": 20.0, "zeta": 0.8, "stiffness": 60.0, "viscosity": 1.0,
    "inertia": 0.018, "curvature": 0.0, "gain": 6.0,
}  # fmt: skip
#: Torque that a person makes beside, below this frequency [Nm, Hz], and a sensor's noise [Nm].
UNSTEADY, BELOW, SENSOR = 0.15, 3.0, 0.02


def expected(time: FloatArray, angle: FloatArray) -> dict[str, Number]:
    """Values of a usual ankle and the intervals that a perturbation would give, by measure.

    They are those of the covariance at the true values (Cramér and Rao), with noise as people make
    it: what structures disagree by comes on top.
    """
    draw, n, rate = np.random.default_rng(1), len(time), (len(time) - 1) / (time[-1] - time[0])
    f = np.fft.rfftfreq(n, 1.0 / rate)
    slow = np.fft.irfft(np.fft.rfft(draw.standard_normal(n)) / np.hypot(1.0, f / BELOW), n)
    torque = UNSTEADY * slow / slow.std() + SENSOR * draw.standard_normal(n)
    band, span = min(TOP, 0.36 * rate), (float(time[0]), float(time[-1]))
    piece = Piece(time, angle, torque, float(rate), band, anchor=float(angle.mean()), span=span)
    noise = noise_of([piece], [piece.bins(piece.torque)])
    structure = Structure("inertia, viscosity, stiffness", direction=1)
    vector = np.array([USUAL[name] for name in structure.linear])
    piece.torque = piece.torque + vector @ regressors(piece, structure, USUAL)
    judged = Judged(Problem([piece], noise), Fitted(structure, USUAL, 0.0, ()))
    names = ("reflex_gain", "reflex_delay")
    return {n: judged.number(n, (INTRINSIC | REFLEX)[n]) for n in (*INTRINSIC, *names)}
