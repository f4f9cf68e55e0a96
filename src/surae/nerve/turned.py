"""A torque whose sign or clock is not the angle's: turned or moved back, and said."""

from dataclasses import replace

import numpy as np

from surae.base.words import N_, Message
from surae.nerve.fitting import Fitted, Problem, noise_of
from surae.nerve.judged import INTRINSIC, Judged
from surae.nerve.other_structures import PLAIN
from surae.nerve.piece import Piece
from surae.nerve.samples import Samples

#: Latenesses of the torque [s] that are tried beyond those that are estimated (± 8 ms), where it
#: would else be of the other sign.
LATER = (0.016, 0.03)


def turned(samples: Samples) -> tuple[Samples, list[Piece]]:
    """Turn a torque by which stiffness and inertia would both be negative, or one and none seen."""
    pieces = samples.pieces()
    problem = Problem(pieces, noise_of(pieces, [p.bins(p.torque) for p in pieces]))
    judged = Judged(problem, problem.fit(PLAIN, {}))
    both = [judged.number(name, INTRINSIC[name]) for name in ("intrinsic_stiffness", "inertia")]
    below = [n.high < 0.0 for n in (*both, judged.number("", INTRINSIC["intrinsic_viscosity"]))]
    if any(below) and (moved := _moved_back(samples, problem)) is not None:
        return moved, moved.pieces()
    if all(n.low < 0.0 for n in both) and any(n.high < 0.0 for n in both):
        note = Message(
            N_(
                "The torque’s sign was turned: as it stands, stiffness or inertia "
                "would be negative. Where the leg moved the device, and not the "
                "device the leg, the numbers are the device’s."
            )
        )
        turned = replace(samples, torque=-samples.torque, notes=(*samples.notes, note))
        return turned, turned.pieces()
    return samples, pieces


def _moved_back(samples: Samples, as_it_is: Problem) -> Samples | None:
    """The torque moved back where it comes later than the search of its lateness reaches.

    Late by 20 ms, inertia at 25 Hz bends the torque as if its sign were wrong. It is moved only
    where that leaves less than half of what any reflex beside tissue leaves of it as it is.
    """

    def best(problem: Problem) -> Fitted:
        fits = (problem.fit(replace(PLAIN, direction=d), {}) for d in (0, 1, -1))
        return min(fits, key=lambda fitted: fitted.loss)

    least = 0.5 * best(as_it_is).loss
    best_moved = None
    for late in LATER:
        n = round(late * samples.rate_hz)
        torque = np.concatenate([samples.torque[n:], np.full(n, samples.torque[-1])])
        moved = replace(samples, torque=torque)
        fitted = best(Problem(moved.pieces(), as_it_is.noise))
        if fitted.loss < least and min(fitted.values[n] for n in ("stiffness", "inertia")) > 0.0:
            least = fitted.loss
            best_moved = (late + fitted.values["late"], moved)
    if best_moved is None:
        return None
    late, moved = best_moved
    note = Message(
        N_(
            "The torque comes {late:.0f} ms later than the angle: it was moved "
            "back. Look at its filter and its clock; delays count from the torque "
            "of tissue."
        ),
        late=1e3 * late,
    )
    return replace(moved, notes=(*samples.notes, note))
