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
from surae.model.contraction import FECC, MVSH, bridge_strain, force_length, force_velocity
from surae.model.equilibrium import solve
from surae.model.jit import inner, jit
from surae.model.rigid import K_REL, L0, TAU, X0, K
from surae.model.tendon import tendon_curve, tendon_partials, tendon_shape

#: A group's own parameters: those of `surae.model.rigid`, its tendon's, and what shapes its curves:
#: logarithms over (16) and (17), 0 where they are as printed; then bridges that hold.
EPS0 = 5
TOE = 6
K_TOE = 7
F_MAX = 8
SHORT = 9
LONG = 10
FASTEST = 11
BEND = 12
GAIN = 13
BRIDGE = 14
REACH = 15
#: Rows of what `drive_columns` needs of every stage.
BY_START, BY_HELD, BY_ACTIVE, TAKEN, STIFFNESS, BY_STRAIN, STRAINED, KEPT = range(8)
LINEAR = 8

#: Rows of a group's states.
LENGTH = 0
SPEED = 1
ELONGATION = 2
FORCE = 3
TISSUE = 4

#: Abscissa and diagonal coefficient of the two-stage SDIRK, γ = 1 − 1/√2: L-stable, second order.
GAMMA = 1.0 - 0.5**0.5
#: The second stage starts from (1 − ρ) of the sample before and ρ of the first stage.
_RHO = (1.0 - GAMMA) / GAMMA

#: Force over which tissue goes slack, as a part of the active state over which that reaches zero.
_SLACK = 0.1


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
    staged[..., 3, 1:] = end - begin - _RHO * (between - begin) - s * dt * fast
    return staged


@jit
def compliant_states(
    p: FloatArray,
    slots: IntArray,
    strain_length: float,
    arm: FloatArray,
    lengths: FloatArray,
    alphas: FloatArray,
    alpha_slopes: FloatArray,
    alpha_slots: IntArray,
    length_slopes: FloatArray,
    length_slots: IntArray,
    factor: float,
    dt: float,
    rest: float,
    states: FloatArray,
    jacobian: FloatArray,
    linear: FloatArray,
    seen: FloatArray,
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
    strain_length : float
        What ε0 is multiplied by to be an elongation in metres: 1, or the slack length.
    arm : ndarray, shape (n,)
        Signed moment arm [m].
    lengths : ndarray, shape (4, n)
        Muscle length on a rigid tendon, lmt − lt0 [m], at both stages; then by how much it moves on
        otherwise than the stage's rule has it (`stages`), so that the rule is the tendon's.
    alphas : ndarray, shape (2, n)
        Active state [N].
    alpha_slopes, alpha_slots : ndarray, shape (q, 2, n) and (q,)
        Its derivatives, and the rows of the jacobian they go to.
    length_slopes, length_slots : ndarray, shape (s, 4, n) and (s,)
        Those of the lengths.
    factor : float
        vmax in optimal lengths per second.
    dt : float
        Sample time [s].
    rest : float
        Active state over which it reaches zero [N]: ½·rest·ln(1 + exp(2·α/rest)) pulls; 0 for a
        kink. A part of it is the force over which tissue goes slack.
    states : ndarray, shape (5, n)
        Is filled: length x [m], speed x' [m/s], tendon elongation [m], tendon force [N] and passive
        force F_elas [N].
    jacobian : ndarray, shape (rows, n)
        Is added to: derivatives of arm times tendon force, the arm held.
    linear : ndarray, shape (2, 8, n), or (0, 8, 0)
        Is filled, if there is room: what `drive_columns` needs of every stage.
    seen : ndarray, shape (rows, n), or (0, 0)
        Is added to, if there is room: derivatives of the length x.

    Returns
    -------
    int
        First sample whose force balance could not be solved, −1 where there is none.
    """
    k = p[K]
    x0 = p[X0]
    l0 = p[L0]
    tau = p[TAU]
    k_rel = p[K_REL]
    vmax = factor * l0 * math.exp(p[FASTEST])
    slack = _SLACK * rest
    short = p[SHORT]
    long = p[LONG]
    bend = MVSH * math.exp(p[BEND])
    gain = (FECC - 1.0) * math.exp(p[GAIN])
    own = (k, x0, l0, vmax, short, long, bend, gain)
    linearised = len(linear) > 0
    shapes = False
    holding = p[BRIDGE] / l0
    reach = p[REACH] * l0
    bridged = reach > 0.0 and (holding != 0.0 or slots[BRIDGE] != len(jacobian) - 1)
    for j in range(SHORT, BRIDGE):
        shapes = shapes or slots[j] != len(jacobian) - 1
    eps0 = p[EPS0] * strain_length
    toe = p[TOE]
    curve = tendon_curve(eps0, toe, p[K_TOE], p[F_MAX])
    shape = tendon_shape(eps0, toe, p[K_TOE], p[F_MAX])
    # wanted sensitivities: the group's parameters, then those of its active state and its length
    unwanted = len(jacobian) - 1
    by_alpha = len(alpha_slots)
    by_length = len(length_slots)
    rows = np.empty(len(p) + by_alpha + by_length, np.int64)
    place = np.empty(len(p), np.int64)
    size = 0
    for j in range(len(p)):
        if slots[j] != unwanted:
            rows[size] = slots[j]
            place[j] = size
            size += 1
    first = size
    for j in range(by_alpha):
        rows[first + j] = alpha_slots[j]
    last = first + by_alpha
    for j in range(by_length):
        rows[last + j] = length_slots[j]
    size = last + by_length
    for j in range(len(p)):
        if slots[j] == unwanted:
            place[j] = size  # which nobody reads
    # sensitivities of length and relaxation: at the sample, before the stage, at the stage
    sens = np.zeros((7, size + 1))
    x_n = sens[0]
    z_n = sens[1]
    x_b = sens[2]
    z_b = sens[3]
    x_s = sens[4]
    z_s = sens[5]
    strained = sens[6]  # of the bridges' strain, where the last stage has left it
    # what parameters do directly: to the balance, to the tendon force, to the relaxation, to α
    terms = np.zeros((4, size + 1))
    direct = terms[0]
    pulled = terms[1]
    relaxed = terms[2]
    driven = terms[3]
    i_k = place[K]
    i_x0 = place[X0]
    i_tau = place[TAU]
    i_rel = place[K_REL]
    i_l0 = place[L0]
    i_eps = place[EPS0]
    i_toe = place[TOE]
    i_bend = place[K_TOE]
    i_max = place[F_MAX]
    i_short = place[SHORT]
    i_long = place[LONG]
    i_fast = place[FASTEST]
    i_curve = place[BEND]
    i_gain = place[GAIN]
    i_bridge = place[BRIDGE]
    i_reach = place[REACH]

    # The start is one stage too: relaxation in its steady state, no active force.
    dc = 1.0 / (1.0 + k_rel)
    keep = 0.0
    keep_tau = 0.0
    keep_rel = 0.0
    take = k_rel * dc
    take_tau = 0.0
    take_rel = dc * dc
    per_h = 1.0
    alpha = 0.0
    pulling = 1.0
    guess = 0.0
    rigid = x_before = lengths[1, 0]
    z_before = x_now = z_now = x_1 = z_1 = 0.0
    e_0 = e_1 = e_2 = 0.0  # elongations at the three stages before
    x_last = strain = 0.0  # where the last stage has left muscle and bridges
    for i in range(lengths.shape[1]):
        if i == 1:  # from here on z = keep·ẑ + take·F0 is an implicit stage of (10)
            h = GAMMA * dt
            per_h = 1.0 / h
            keep = 1.0 / (1.0 + h * (1.0 + k_rel) / tau)
            take = keep * h * k_rel / tau
            keep_tau = keep * (1.0 - keep) / tau
            keep_rel = -keep * keep * h / tau
            take_tau = -take * keep / tau
            take_rel = keep * (1.0 - take) * h / tau
        for stage in range(1 if i == 0 else 0, 2):
            if i > 0:  # guess: the quadratic through the three stages before
                raw = alphas[stage, i]
                alpha = max(raw, 0.0)
                pulling = 1.0 if raw >= 0.0 else 0.0
                if rest > 0.0:
                    away = math.exp(-2.0 * abs(raw) / rest)
                    alpha += 0.5 * rest * math.log1p(away)
                    pulling = (1.0 if raw >= 0.0 else away) / (1.0 + away)
                if stage == 0:
                    rigid = lengths[0, i]
                    x_before = x_now + lengths[2, i]
                    z_before = z_now
                    guess = e_2 + 2.0 / _RHO * (e_2 - e_1) - (e_1 - e_0)
                    for j in range(size):
                        x_b[j] = x_n[j]
                        z_b[j] = z_n[j]
                else:
                    rigid = lengths[1, i]
                    x_before = x_now + _RHO * (x_1 - x_now) + lengths[3, i]
                    z_before = z_now + _RHO * (z_1 - z_now)
                    guess = e_2 + 2.0 * _RHO * (e_2 - e_1) - (e_1 - e_0)
                    for j in range(size):
                        x_b[j] = x_n[j] + _RHO * (x_s[j] - x_n[j])
                        z_b[j] = z_n[j] + _RHO * (z_s[j] - z_n[j])
                for j in range(by_length):
                    x_b[last + j] += length_slopes[j, 2 + stage, i]
            held = keep * z_before
            solved, e, here = solve(
                guess,
                own,
                curve,
                (rigid, x_before, per_h, 1.0 - take, held, alpha, slack),
                (holding if i > 0 else 0.0, reach, x_last, strain),
            )
            if not solved:
                return i
            _, G_e, force, slope, elastic, taut, fl, fl_x, fv, fv_v, hold = here
            pull = fv + hold
            x = rigid - e
            z = held + take * elastic
            speed = (x - x_before) * per_h
            e_0 = e_1
            e_1 = e_2
            e_2 = e
            by_strain = strain_x = kept = strain_reach = 0.0
            if bridged and i > 0:
                strain, strain_x, kept, strain_reach = bridge_strain(x - x_last, strain, reach)
                by_strain = alpha * fl * holding / G_e
            x_last = x
            if stage == 0:
                x_1 = x
                z_1 = z
            else:
                x_now = x
                z_now = z
                states[LENGTH, i], states[ELONGATION, i], states[FORCE, i] = x, e, force
                states[SPEED, i] = speed if i > 0 else 0.0
                states[TISSUE, i] = max(elastic - z, 0.0)
            if linearised:
                linear[stage, BY_START, i] = alpha * fl * fv_v * per_h / G_e
                linear[stage, BY_HELD, i] = taut * keep / G_e
                linear[stage, BY_ACTIVE, i] = pulling * fl * pull / G_e
                linear[stage, TAKEN, i] = take * k * elastic
                linear[stage, STIFFNESS, i] = slope
                linear[stage, BY_STRAIN, i] = by_strain
                linear[stage, STRAINED, i], linear[stage, KEPT, i] = strain_x, kept
            if size == 0:
                continue

            stiff = k * elastic
            stretched = (x - x0) * elastic
            relaxed[i_k], relaxed[i_x0] = take * stretched, -take * stiff
            relaxed[i_tau] = take_tau * elastic + keep_tau * z_before
            relaxed[i_rel] = take_rel * elastic + keep_rel * z_before
            direct[i_k] = taut * (relaxed[i_k] - stretched)
            direct[i_x0] = taut * (relaxed[i_x0] + stiff)
            direct[i_tau], direct[i_rel] = taut * relaxed[i_tau], taut * relaxed[i_rel]
            direct[i_l0] = alpha * (fl_x * pull * x + fl * fv_v * speed) / l0
            if shapes:
                by_width = alpha * pull * force_length(x, l0, short, long)[3]
                _, _, by_bend, by_gain = force_velocity(speed, vmax, bend, gain)
                direct[i_short], direct[i_long] = 0.0, 0.0
                direct[i_short if x < l0 else i_long] = -by_width
                direct[i_fast] = alpha * fl * fv_v * speed
                direct[i_curve], direct[i_gain] = -alpha * fl * by_bend, -alpha * fl * by_gain
            by_eps0, by_toe, by_k_toe, by_max = tendon_partials(e, force, slope, curve, shape)
            pulled[i_eps], pulled[i_toe] = by_eps0 * strain_length, by_toe
            pulled[i_bend], pulled[i_max] = by_k_toe, by_max
            for j in range(by_alpha):
                driven[first + j] = alpha_slopes[j, stage, i]
            for j in range(by_length):  # the unit pulls at its tendon
                pulled[last + j] = slope * length_slopes[j, stage, i]

            share = 1.0 / G_e
            by_start = alpha * fl * fv_v * per_h * share
            by_held = taut * keep * share
            by_active = pulling * fl * pull * share
            taken = take * stiff
            if bridged:  # what their strain changes by while the muscle stays
                for j in range(size):
                    strained[j] = kept * strained[j] - strain_x * x_s[j]
                strained[i_l0] += strain_reach * p[REACH]
                strained[i_reach] += strain_reach * l0
                direct[i_bridge] = -alpha * fl * strain / l0
                direct[i_l0] += alpha * fl * hold / l0
            for j in range(size):
                x_s[j] = (
                    by_start * x_b[j]
                    + by_held * z_b[j]
                    - by_active * driven[j]
                    + share * (direct[j] + pulled[j])
                    - by_strain * strained[j]
                )
                z_s[j] = keep * z_b[j] + taken * x_s[j] + relaxed[j]
                strained[j] += strain_x * x_s[j]
            if stage == 1:
                for j in range(size):
                    x_n[j] = x_s[j]
                    z_n[j] = z_s[j]
                    jacobian[rows[j], i] += arm[i] * (pulled[j] - slope * x_s[j])
                if len(seen) > 0:
                    for j in range(size):
                        seen[rows[j], i] += x_s[j]
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
            x_b = x_n + _RHO * (x_s - x_n)
            z_b = z_n + _RHO * (z_s - z_n)
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
