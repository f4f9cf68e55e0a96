"""One muscle group on a compliant tendon, implicit: states and exact sensitivities (thesis 2.4).

Each step is a stiffly accurate two-stage SDIRK with γ = 1 − 1/√2 (Alexander 1977): second order and
L-stable, so that nothing rings and no clamp is needed where the active state vanishes and the
length of the muscle becomes an algebraic variable. The rule is applied to the tendon's elongation,
and the speed of the whole unit is taken as it is: on a tendon that hardly gives way the muscle has
the unit's speed, where a difference of lengths would be of the first order. A stage is one scalar
equation, solved in `surae.model.equilibrium`. The sensitivities are those of the discrete solution,
by the implicit function theorem on every stage.

Steps are the recording's samples and are never divided: halving them changes a torque at 128 Hz by
some hundredths of a percent, and sub-steps chosen by an error estimate would make the torque jump
with the parameters. An underdamped activation filter swings below zero; no muscle pushes, and a
negative active state would leave the balance without a solution, so it counts as none.
"""

import math

import numpy as np

from surae.base.units import FloatArray
from surae.model.activation import IntArray
from surae.model.compliant_stage import (
    BEND,
    BRIDGE,
    BY_ACTIVE,
    BY_HELD,
    BY_START,
    BY_STRAIN,
    BY_X_N,
    BY_X_S,
    BY_Z_N,
    BY_Z_S,
    EPS0,
    F_MAX,
    FASTEST,
    GAIN,
    GAMMA,
    K_TOE,
    KEPT,
    LONG,
    PAST,
    PULLED,
    REACH,
    RHO,
    SHORT,
    STIFFNESS,
    STRAIN,
    STRAINED,
    TAKEN,
    TOE,
    X_BEGIN,
    X_LAST,
    Z_BEGIN,
    Instant,
    Tendon,
    begin,
    linearise,
    not_negative,
    places,
    remember,
    resting_rule,
    sensitivities,
    stage_rule,
    strain_bridges,
)
from surae.model.contraction import FECC, MVSH
from surae.model.equilibrium import Balance, Muscle, solve
from surae.model.jit import inner, jit
from surae.model.rigid import K_REL, L0, TAU, X0, K
from surae.model.tendon import tendon_curve, tendon_shape

#: Rows of a group's states.
LENGTH = 0
SPEED = 1
ELONGATION = 2
FORCE = 3
TISSUE = 4

#: Force over which tissue goes slack, as a part of the active state over which that reaches zero.
_SLACK = 0.1

#: How much ε0 is multiplied by to be an elongation in metres; vmax in optimal lengths per second;
#: sample time [s]; active state over which it reaches zero [N].
Constants = tuple[float, float, float, float]
#: Moment arm, lengths, their derivatives, and the rows of the jacobian these go to.
Unit = tuple[FloatArray, FloatArray, FloatArray, IntArray]
#: Active state, its derivatives, and the rows of the jacobian these go to.
Drive = tuple[FloatArray, FloatArray, IntArray]
#: What is filled: states, jacobian, linear, seen.
Room = tuple[FloatArray, FloatArray, FloatArray, FloatArray]


def stages(length: FloatArray, speed: FloatArray, dt: float) -> FloatArray:
    """Lengths of a unit at both stages of every step, and how it moves on, shape (…, 4, n).

    Between samples the length is a cubic Hermite spline. The last two rows are by how much the
    stage's rule, ẋ = (x − x_before)/(γ·dt), misses the unit's own speed, in metres.
    """
    s = GAMMA
    begin = length[..., :-1]
    end = length[..., 1:]
    slow = speed[..., :-1]
    fast = speed[..., 1:]
    staged = np.zeros((*length.shape[:-1], 4, length.shape[-1]))
    staged[..., :2, :] = length[..., None, :]
    between = (1 + 2 * s) * (1 - s) ** 2 * begin + s**2 * (3 - 2 * s) * end
    between += dt * s * (1 - s) * ((1 - s) * slow - s * fast)
    there = 6 * s * (1 - s) * (end - begin) / dt + (1 - s) * (1 - 3 * s) * slow
    there += s * (3 * s - 2) * fast
    staged[..., 0, 1:] = between
    staged[..., 2, 1:] = between - begin - s * dt * there
    staged[..., 3, 1:] = end - begin - RHO * (between - begin) - s * dt * fast
    return staged


@inner
def muscle_of(p: FloatArray, factor: float) -> Muscle:
    """A muscle of its group's parameters, as the force balance takes it."""
    vmax = factor * p[L0] * math.exp(p[FASTEST])
    bend = MVSH * math.exp(p[BEND])
    gain = (FECC - 1.0) * math.exp(p[GAIN])
    return p[K], p[X0], p[L0], vmax, p[SHORT], p[LONG], bend, gain


@inner
def _tendon(p: FloatArray, strain_length: float) -> Tendon:
    """A tendon of its group's parameters, with what its derivatives need."""
    eps0 = p[EPS0] * strain_length
    curve = tendon_curve(eps0, p[TOE], p[K_TOE], p[F_MAX])
    return strain_length, curve, tendon_shape(eps0, p[TOE], p[K_TOE], p[F_MAX])


@inner
def _any_wanted(slots: IntArray, first: int, last: int, unwanted: int) -> bool:
    """Whether derivatives are wanted by any of some parameters."""
    wanted = False
    for j in range(first, last):
        wanted = wanted or slots[j] != unwanted
    return wanted


@inner
def _write(states: FloatArray, i: int, z: float, here: Balance, now: Instant) -> None:
    """Fill in a sample's states; before the first one nothing moves."""
    states[LENGTH, i] = now[0]
    states[SPEED, i] = now[2] if i > 0 else 0.0
    states[ELONGATION, i] = now[1]
    states[FORCE, i] = here[2]
    states[TISSUE, i] = max(here[4] - z, 0.0)


@inner
def _add(
    i: int, rows: IntArray, arm: float, pulled: FloatArray, slope: float, sens: FloatArray, to: Room
) -> None:
    """Add a sample's sensitivities to the rows of the jacobian, and of the length."""
    _, jacobian, _, seen = to
    for j in range(len(rows)):
        sens[BY_X_N, j] = sens[BY_X_S, j]
        sens[BY_Z_N, j] = sens[BY_Z_S, j]
        jacobian[rows[j], i] += arm * (pulled[j] - slope * sens[BY_X_S, j])
    if len(seen) > 0:
        for j in range(len(rows)):
            seen[rows[j], i] += sens[BY_X_S, j]


@jit
def compliant_states(
    p: FloatArray, slots: IntArray, constants: Constants, unit: Unit, drive: Drive, to: Room
) -> int:
    """States of a muscle group, by (2) to (21), (25), (26), and derivatives of its torque.

    What has two rows is given at both stages of every step: at t[n−1] + γ·dt, and at the sample.

    Parameters
    ----------
    p : ndarray, shape (16,)
        The group's parameters: k, x0, l0, tau_rel, k_rel, then ε0, F̄toe, ktoe and Fmax, then the
        logarithms of the widths below and above l0, of vmax, mvsh and fecc − 1 over (16) and (17),
        then the stiffness K of bridges that hold, times l0, and the part of l0 at which they yield.
    slots : ndarray of int, shape (16,)
        Row of the jacobian that belongs to each; its last row is of those that are not wanted.
    constants : tuple of float
        What ε0 is multiplied by to be an elongation in metres: 1, or the slack length; vmax in
        optimal lengths per second; sample time [s]; active state over which it reaches zero [N]:
        ½·rest·ln(1 + exp(2·α/rest)) pulls; 0 for a kink. A part of it is the force over which
        tissue goes slack.
    unit : tuple of ndarray
        Signed moment arm [m], shape (n,). Muscle length on a rigid tendon, lmt − lt0 [m], at both
        stages, then by how much it moves on otherwise than the stage's rule has it (`stages`), so
        that the rule is the tendon's, shape (4, n). Derivatives of that, shape (s, 4, n), and the
        rows of the jacobian they go to, (s,).
    drive : tuple of ndarray
        Active state [N], shape (2, n), its derivatives, (q, 2, n), and the rows of the jacobian
        they go to, (q,).
    to : tuple of ndarray
        States, shape (5, n), are filled: length x [m], speed x' [m/s], tendon elongation [m],
        tendon force [N] and passive force F_elas [N]. The jacobian, shape (rows, n), is added to:
        derivatives of arm times tendon force, the arm held. If there is room, shape (2, 8, n) and
        not (0, 8, 0), what `drive_columns` needs of every stage is filled; and if there is room,
        shape (rows, n) and not (0, 0), derivatives of the length x are added.

    Returns
    -------
    int
        First sample whose force balance could not be solved, −1 where there is none.
    """
    strain_length, factor, dt, rest = constants
    arm, lengths, length_slopes, length_slots = unit
    alphas, alpha_slopes, alpha_slots = drive
    states, jacobian, linear, _ = to
    muscle = muscle_of(p, factor)
    holding = p[BRIDGE] / p[L0]
    unwanted = len(jacobian) - 1
    bridging = p[REACH] * p[L0] > 0.0 and (holding != 0.0 or slots[BRIDGE] != unwanted)
    shapes = _any_wanted(slots, SHORT, BRIDGE, unwanted)
    tendon = _tendon(p, strain_length)
    rows, place = places(slots, unwanted, alpha_slots, length_slots)
    group = (p, place, muscle, tendon, shapes, bridging)
    sens = np.zeros((7, len(rows) + 1))
    terms = np.zeros((4, len(rows) + 1))
    past = np.zeros(PAST)
    past[X_BEGIN] = lengths[1, 0]
    rule = resting_rule(p[K_REL])
    alpha = 0.0
    pulling = 1.0
    guess = 0.0
    for i in range(lengths.shape[1]):
        if i == 1:
            rule = stage_rule(p[TAU], p[K_REL], GAMMA * dt)
        keep, take, _, _, _, _, per_h = rule
        for stage in range(1 if i == 0 else 0, 2):
            if i > 0:
                alpha, pulling = not_negative(alphas[stage, i], rest)
                guess = begin(stage, i, lengths, length_slopes, past, sens)
            held = keep * past[Z_BEGIN]
            rigid = lengths[stage, i]
            solved, e, here = solve(
                guess,
                muscle,
                tendon[1],
                (rigid, past[X_BEGIN], per_h, 1.0 - take, held, alpha, _SLACK * rest),
                (holding if i > 0 else 0.0, p[REACH] * p[L0], past[X_LAST], past[STRAIN]),
            )
            if not solved:
                return i
            x = rigid - e
            z = held + take * here[4]
            speed = (x - past[X_BEGIN]) * per_h
            now = (x, e, speed, past[Z_BEGIN], alpha, pulling)
            bridged = (0.0, 0.0, 0.0, 0.0, 0.0)
            if bridging and i > 0:
                bridged = strain_bridges(past, p, x, alpha, here)
            there = (rule, here, now, bridged)
            remember(stage, past, x, z, e)
            if stage == 1:
                _write(states, i, z, here, now)
            if len(linear) > 0:
                linearise(linear[stage], i, p[K], there)
            if len(rows) == 0:
                continue
            sensitivities(stage, i, group, there, alpha_slopes, length_slopes, sens, terms)
            if stage == 1:
                _add(i, rows, arm[i], terms[PULLED], here[3], sens, to)
    return -1


@jit
def drive_columns(
    inputs: FloatArray,
    first: IntArray,
    steps: FloatArray,
    back: IntArray,
    linear: FloatArray,
    arm: FloatArray,
    keep: float,
    out: FloatArray,
) -> None:
    """How short changes of a group's excitation change its torque, to first order.

    Each goes through the activation filter and the linearised force balance (`compliant_states`).

    Parameters
    ----------
    inputs : ndarray, shape (c, w)
        Changes of the excitation [N] from sample `first` on; none before and after.
    first : ndarray of int, shape (c,)
        Their first samples.
    steps : ndarray, shape (2, 2, 3, 2, 4)
        Of `surae.model.activation` at both stages, and `back` their whole samples, shape (2,).
    linear : ndarray, shape (2, 8, n)
        From `compliant_states`.
    arm : ndarray, shape (n,)
        Signed moment arm [m].
    keep : float
        What a stage keeps of the relaxation's state.
    out : ndarray, shape (c, l)
        Is filled: the change of the torque [Nm] from sample `first` on.
    """
    n = len(arm)
    v = np.empty(2)
    w = np.empty(2)
    a = np.empty(2)  # the filter's state for each stage's own delay
    for c in range(len(first)):
        begin = first[c]
        width = inputs.shape[1]
        v[0] = v[1] = w[0] = w[1] = 0.0
        x_n = z_n = strained = 0.0
        for t in range(out.shape[1]):
            i = begin + t
            out[c, t] = 0.0
            if i >= n:
                continue
            for stage in range(2):
                j = t - back[stage]
                before = inputs[c, j - 1] if 0 < j <= width else 0.0
                now = inputs[c, j] if 0 <= j < width else 0.0
                a[stage] = 0.0
                if j >= 0:
                    to = steps[stage, 1, 0]
                    on = steps[stage, 0, 0]
                    a[stage] = advanced(to[0], v[stage], w[stage], before, now)
                    v[stage], w[stage] = (
                        advanced(on[0], v[stage], w[stage], before, now),
                        advanced(on[1], v[stage], w[stage], before, now),
                    )
            if i == 0:
                continue
            strained = linear[0, KEPT, i] * strained - linear[0, STRAINED, i] * x_n
            x_s = (
                linear[0, BY_START, i] * x_n
                + linear[0, BY_HELD, i] * z_n
                - linear[0, BY_ACTIVE, i] * a[0]
                - linear[0, BY_STRAIN, i] * strained
            )
            z_s = keep * z_n + linear[0, TAKEN, i] * x_s
            x_b = x_n + RHO * (x_s - x_n)
            z_b = z_n + RHO * (z_s - z_n)
            strained += linear[0, STRAINED, i] * x_s
            strained = linear[1, KEPT, i] * strained - linear[1, STRAINED, i] * x_s
            x_n = (
                linear[1, BY_START, i] * x_b
                + linear[1, BY_HELD, i] * z_b
                - linear[1, BY_ACTIVE, i] * a[1]
                - linear[1, BY_STRAIN, i] * strained
            )
            z_n = keep * z_b + linear[1, TAKEN, i] * x_n
            strained += linear[1, STRAINED, i] * x_n
            out[c, t] = -arm[i] * linear[1, STIFFNESS, i] * x_n


@inner
def advanced(row: FloatArray, v: float, w: float, before: float, now: float) -> float:
    """One state of the activation filter a step on, by a row of `filter_step`."""
    state: float = row[0] * v + row[1] * w + row[2] * before + row[3] * now
    return state
