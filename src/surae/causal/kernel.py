"""One step: angle and EMG in, torque and its doubt out."""

import math

import numpy as np

from surae.base.units import FloatArray
from surae.causal.drive import hold, own_envelopes, respond, stretch_drive
from surae.causal.force import compliant_force, rigid_force
from surae.causal.layout import DOUBT
from surae.causal.path import joint_turn, muscle_path
from surae.causal.signals import Record, follow_angle, follow_emg
from surae.model.jit import inner, jit
from surae.model.movement import GRAVITY
from surae.model.parameters import JOINT_RESTS

_RESTS = JOINT_RESTS
_G = GRAVITY
#: Parts of the torque that a step gives.
PARTS = (
    "tissue_tri",
    "tissue_tib",
    "neural_tri",
    "neural_tib",
    "inertial",
    "gravitational",
    "joint",
    "zero",
)


@inner
def _curve(s: Record, curve: FloatArray, relaxing: FloatArray) -> float:
    """Torque of a tissue's curve, see `surae.model.tissue_curve` [Nm]."""
    if curve.shape[1] == 0:
        return 0.0
    degrees = math.degrees(s.angle)
    elastic = np.interp(degrees, curve[0], curve[1])
    if s.count == 0:
        s.curve_first = elastic
    beyond = elastic - s.curve_first
    torque = elastic
    for j in range(relaxing.shape[1]):
        stays = relaxing[1, j]
        s.curve[j] = (1.0 - stays) * beyond + stays * s.curve[j]
        torque += relaxing[0, j] * (beyond - s.curve[j])
    return float(torque)


@inner
def _limb(n: Record, s: Record, turn: tuple[float, float, float]) -> None:
    """Torques of foot, plate, joint and sensor."""
    angle, velocity, acceleration = s.angle, s.velocity, s.acceleration
    joint, factor, bend = turn
    swinging = factor * acceleration + bend * velocity * velocity
    cos, sin = math.cos(angle), math.sin(angle)
    parts = s.parts
    parts[4] = n.mass * factor * n.strap**2 * swinging + n.plate[0] * acceleration
    weight = n.mass * factor * _G * n.strap * math.cos(joint - n.theta_foot)
    parts[5] = weight + n.plate[1] * cos + n.plate[2] * sin
    parts[6] = n.joint[0] * (angle - _RESTS) + n.joint[1] + n.joint[2] * velocity
    parts[7] = n.zero


@inner
def _doubt(n: Record, s: Record, terms: FloatArray) -> None:
    """Standard deviation of the torque: a quadratic form of what it is made of."""
    for k in range(2):
        if s.count == 0:
            s.neural[k] = s.parts[2 + k]
        s.neural[k] += n.effort_gain * (s.parts[2 + k] - s.neural[k])
        s.neural_rate[k] = (s.parts[2 + k] - s.neural[k]) * n.effort_gain / n.dt
    doubt_terms(s, terms)
    total = n.noise * n.noise
    for j in range(DOUBT):
        row = 0.0
        for k in range(DOUBT):
            row += n.doubt[j, k] * terms[k]
        total += row * row
    s.sd = math.sqrt(total)


@inner
def doubt_terms(s: Record, terms: FloatArray) -> None:
    """What the doubt of a torque is made of: its parts, what turns them, and movement."""
    parts = s.parts
    terms[0] = 1.0
    terms[1] = s.angle
    terms[2] = s.angle * s.angle
    terms[3] = s.velocity
    terms[4] = parts[4]
    for k in range(4):
        terms[5 + k] = parts[k]
        terms[9 + k] = parts[k] * s.angle
    terms[13] = parts[2] * s.velocity
    terms[14] = parts[3] * s.velocity
    terms[15] = s.neural_rate[0]
    terms[16] = s.neural_rate[1]


@jit
def step(
    numbers: Record,
    path: FloatArray,
    tissue: tuple[FloatArray, FloatArray],
    state: Record,
    room: tuple[FloatArray, FloatArray, FloatArray],
    angle: float,
    emg: FloatArray,
) -> float:
    """One sample: the torque [Nm] at this angle [rad] and EMG, and its doubt in the state.

    Parameters
    ----------
    numbers : record
        Of `surae.causal.layout.NUMBERS`, shape (1,).
    path : ndarray, shape (k, 17)
        Cubics of lengths and arms.
    tissue : tuple of ndarray
        A tissue's curve, shape (2, q), and how it relaxes, (2, r).
    state : record
        Of `surae.causal.layout.STATE`, shape (1,): is changed.
    room : tuple of ndarray
        Drives that are remembered, (4, d), what a drive that stays makes, (2,), and the terms of
        the doubt, (17,): are changed.
    angle : float
        As it is measured [rad].
    emg : ndarray, shape (4,)
        Of TA, GL, SOL, GM, raw or envelopes.

    Returns
    -------
    float
        Modelled torque [Nm].
    """
    n = numbers[0]
    s = state[0]
    late, held, terms = room
    follow_angle(n, s, angle)
    follow_emg(n, s, emg)
    own_envelopes(n, s)
    hold(n, s, held)
    turn = joint_turn(n, s.angle)
    _limb(n, s, turn)
    s.parts[6] += _curve(s, tissue[0], tissue[1])
    for group in range(2):
        arm, length, speed = muscle_path(n, path, group, turn, s.velocity)
        s.active[0] = s.active[1] = 0.0
        first, last = (1, 4) if group == 0 else (0, 1)
        drive = 0.0
        for c in range(first, last):
            drive += n.weights[c] * s.own[c]
        respond(n, s, (group, 0), drive, late[2 * group], held)
        drive = stretch_drive(n, group, length, speed)
        respond(n, s, (group, 1), drive, late[2 * group + 1], held)
        if n.compliant:
            passive, contractile = compliant_force(n, s, group, length, speed)
        else:
            passive, contractile = rigid_force(n, s, group, length, speed)
        s.parts[group] = arm * passive
        s.parts[2 + group] = arm * contractile
    torque = 0.0
    for k in range(8):
        torque += s.parts[k]
    s.torque = torque
    _doubt(n, s, terms)
    s.count += 1
    return torque


@jit
def run(
    numbers: Record,
    path: FloatArray,
    tissue: tuple[FloatArray, FloatArray],
    state: Record,
    room: tuple[FloatArray, FloatArray, FloatArray],
    signals: tuple[FloatArray, FloatArray],
    out: FloatArray,
) -> None:
    """Many steps; `out`, shape (rows, n), is filled with what each leaves.

    Torque, its standard deviation, angle, speed, acceleration, and whether it failed; envelopes,
    their rates, effort and its rates of four muscles; terms of the doubt.
    """
    angle, emg = signals
    s = state[0]
    for i in range(len(angle)):
        out[0, i] = step(numbers, path, tissue, state, room, angle[i], emg[i])
        out[1, i] = s.sd
        out[2, i] = s.angle
        out[3, i] = s.velocity
        out[4, i] = s.acceleration
        out[5, i] = s.failed
        for c in range(4):
            out[6 + c, i] = s.envelope[c]
            out[10 + c, i] = s.envelope_rate[c]
            out[14 + c, i] = s.smooth[c, 2]
            out[18 + c, i] = s.smooth_rate[c]
        for k in range(DOUBT):
            out[22 + k, i] = room[2][k]


#: Rows of `run`'s output.
ROWS = 22 + DOUBT
