"""Muscle-tendon model, implicit: torque, state and exact sensitivities in one pass (thesis 2.4).

Each step is a stiffly accurate two-stage SDIRK with γ = 1 − 1/√2 (Alexander 1977): second order and
L-stable, so that nothing rings and no clamp is needed where the active state vanishes and the
length of the muscle becomes an algebraic variable. A stage is one scalar equation, solved in
`surae.model.balance`. The sensitivities are those of the discrete solution, by the implicit
function theorem on every stage.

Steps are the recording's samples and are never divided: halving them changes a torque at 128 Hz by
some hundredths of a percent, and sub-steps chosen by an error estimate would make the torque jump
with the parameters. An underdamped activation filter swings below zero; no muscle pushes, and a
negative active state would leave the balance without a solution, so it counts as none.
"""

import numpy as np
import numpy.typing as npt

from surae.model.balance import solve
from surae.model.jit import jit
from surae.model.rigid import BETA, F0, K_REL, L0, TAU, X0, G, K, M
from surae.model.stages import ALPHA, BY_BETA, BY_F0, CHANNEL, GAMMA
from surae.model.tendon import tendon_curve, tendon_partials, tendon_shape
from surae.units import FloatArray

IntArray = npt.NDArray[np.int64]

# Positions of the tendon's parameters, after the muscle's fifteen.
EPS0, TOE, K_TOE, F_MAX = 15, 17, 19, 21
N_COMPLIANT = 23

#: Rows of the states of a muscle group.
LENGTH, SPEED, ELONGATION, FORCE, TISSUE = 0, 1, 2, 3, 4

#: The second stage starts from (1 − ρ) of the sample before and ρ of the first stage.
_RHO = (1.0 - GAMMA) / GAMMA


def compliant_torque(
    p: FloatArray, slots: IntArray, limb: FloatArray, arms: FloatArray, lengths: FloatArray,
    staged: FloatArray, alphas: FloatArray, by_drive: FloatArray, strain_lengths: FloatArray,
    factor: float, dt: float,
) -> tuple[FloatArray, FloatArray, FloatArray, IntArray]:  # fmt: skip
    """Reaction torque, equation (1) with (2) to (21), (25), (26), (29), (30), and derivatives.

    Parameters
    ----------
    p : ndarray, shape (23 + D,)
        The muscle's fifteen parameters, then ε0, F̄toe, ktoe and Fmax of triceps and tibialis, then
        those of D drives.
    slots : ndarray of int, shape (23 + D,)
        Row of the jacobian that belongs to each parameter; −1 where it is not wanted.
    limb : ndarray, shape (n,)
        Inertial and gravitational torque of 1 kg [Nm/kg].
    arms, lengths : ndarray, shape (2, n)
        Signed moment arms and muscle lengths on a rigid tendon, lmt − lt0 [m], triceps first.
    staged : ndarray, shape (2, n)
        `lengths` at the first stage of the step that ends at each sample [m].
    alphas : ndarray, shape (10, n, 2)
        Active states at both stages of every step with their derivatives, which may be zero where
        no jacobian is wanted; see `surae.model.stages.staged_activation`.
    by_drive : ndarray, shape (2, D, n, 2)
        Derivatives of both groups' active states by the parameters of the drives.
    strain_lengths : ndarray, shape (2,)
        What ε0 is multiplied by to be an elongation in metres: 1, or the slack length.
    factor : float
        vmax in optimal lengths per second.
    dt : float
        Sample time [s].

    Returns
    -------
    torque : ndarray, shape (n,)
        Torque [Nm].
    jacobian : ndarray, shape (number of wanted parameters, n)
        ∂T/∂p.
    states : ndarray, shape (2, 5, n)
        Per muscle group length x [m], speed x' [m/s], tendon elongation [m], tendon force [N] and
        passive force F_elas [N].
    unsolved : ndarray of int, shape (2,)
        First sample of each group whose force balance could not be solved, −1 where there is
        none; torque and states are NaN from there on.
    """
    wanted = int(slots.max()) + 1
    jacobian = np.zeros((wanted, len(limb)))
    if slots[M] >= 0:
        jacobian[slots[M]] = limb
    states = np.full((2, 5, len(limb)), np.nan)
    unsolved = np.full(2, -1)
    for muscle in range(2):
        unsolved[muscle] = _simulate(
            muscle, p, slots, arms[muscle], lengths[muscle], staged[muscle], alphas,
            by_drive[muscle], float(strain_lengths[muscle]), factor, dt, jacobian, states[muscle],
        )  # fmt: skip
    torque = p[M] * limb + arms[0] * states[0, FORCE] + arms[1] * states[1, FORCE]
    return torque, jacobian, states, unsolved


@jit
def _places(muscle: int, slots: IntArray) -> tuple[IntArray, IntArray]:
    """Wanted parameters that touch a group: their jacobian rows, and each parameter's place.

    Parameters that are not wanted share the last place, which nobody reads.
    """
    rows = np.empty(len(slots), np.int64)
    place = np.full(len(slots), -1)
    size = 0
    for j in range(1, len(slots)):
        if j in (TAU, K_REL, F0, BETA) or j >= N_COMPLIANT:
            touches = True
        elif G <= j < G + 4:
            touches = (j == G) == (muscle == 1)
        else:
            odd_pair = K <= j < TAU or L0 <= j < F0 or j >= EPS0
            touches = odd_pair and (j - K) % 2 == muscle
        if touches and slots[j] >= 0:
            rows[size] = slots[j]
            place[j] = size
            size += 1
    for j in range(len(slots)):
        if place[j] < 0:
            place[j] = size
    return rows[:size], place


@jit
def _simulate(
    muscle: int, p: FloatArray, slots: IntArray, arms: FloatArray, lengths: FloatArray,
    staged: FloatArray, alphas: FloatArray, by_drive: FloatArray, strain_length: float,
    factor: float, dt: float, jacobian: FloatArray, states: FloatArray,
) -> int:  # fmt: skip
    """One muscle group: fills its states, adds to the jacobian; its first unsolved sample or −1."""
    k, x0, l0, tau, k_rel = p[K + muscle], p[X0 + muscle], p[L0 + muscle], p[TAU], p[K_REL]
    own = (k, x0, l0, factor * l0)
    eps0, toe = p[EPS0 + muscle] * strain_length, p[TOE + muscle]
    curve = tendon_curve(eps0, toe, p[K_TOE + muscle], p[F_MAX + muscle])
    shape = tendon_shape(eps0, toe, p[K_TOE + muscle], p[F_MAX + muscle])
    rows, place = _places(muscle, slots)
    size = len(rows)
    # wanted sensitivities of length and relaxation: at the sample, before the stage, at the stage
    sens = np.zeros((6, size + 1))
    x_n, z_n, x_b, z_b, x_s, z_s = sens[0], sens[1], sens[2], sens[3], sens[4], sens[5]
    # what parameters do directly: to the balance, to the tendon force, to the relaxation, to α
    terms = np.zeros((4, size + 1))
    direct, pulled, relaxed, driven = terms[0], terms[1], terms[2], terms[3]
    i_k, i_x0, i_tau, i_rel = place[K + muscle], place[X0 + muscle], place[TAU], place[K_REL]
    i_l0, i_f0, i_beta = place[L0 + muscle], place[F0], place[BETA]
    i_eps, i_toe = place[EPS0 + muscle], place[TOE + muscle]
    i_bend, i_max = place[K_TOE + muscle], place[F_MAX + muscle]
    first, last = (1, 4) if muscle == 0 else (0, 1)  # EMG channels of this group

    # The start is one stage too: relaxation in its steady state, no active force.
    dc = 1.0 / (1.0 + k_rel)
    keep, keep_tau, keep_rel = 0.0, 0.0, 0.0
    take, take_tau, take_rel = k_rel * dc, 0.0, dc * dc
    per_h, alpha, pulling, guess = 1.0, 0.0, 1.0, 0.0
    rigid = x_before = lengths[0]
    z_before = x_now = z_now = x_1 = z_1 = 0.0
    e_0 = e_1 = e_2 = 0.0  # elongations at the three stages before
    for i in range(len(lengths)):
        if i == 1:  # from here on z = keep·ẑ + take·F0 is an implicit stage of (10)
            h = GAMMA * dt
            per_h = 1.0 / h
            keep = 1.0 / (1.0 + h * (1.0 + k_rel) / tau)
            take = keep * h * k_rel / tau
            keep_tau, keep_rel = keep * (1.0 - keep) / tau, -keep * keep * h / tau
            take_tau, take_rel = -take * keep / tau, keep * (1.0 - take) * h / tau
        for stage in range(1 if i == 0 else 0, 2):
            if i > 0:  # guess: the quadratic through the three stages before
                raw = alphas[ALPHA + muscle, i, stage]
                alpha = max(raw, 0.0)
                pulling = 1.0 if raw >= 0.0 else 0.0
                if stage == 0:
                    rigid, x_before, z_before = staged[i], x_now, z_now
                    guess = e_2 + 2.0 / _RHO * (e_2 - e_1) - (e_1 - e_0)
                    for j in range(size):
                        x_b[j], z_b[j] = x_n[j], z_n[j]
                else:
                    rigid = lengths[i]
                    x_before = x_now + _RHO * (x_1 - x_now)
                    z_before = z_now + _RHO * (z_1 - z_now)
                    guess = e_2 + 2.0 * _RHO * (e_2 - e_1) - (e_1 - e_0)
                    for j in range(size):
                        x_b[j] = x_n[j] + _RHO * (x_s[j] - x_n[j])
                        z_b[j] = z_n[j] + _RHO * (z_s[j] - z_n[j])
            held = keep * z_before
            solved, e, found = solve(
                guess, own, curve, (rigid, x_before, per_h, 1.0 - take, held, alpha)
            )
            if not solved:
                return i
            _, G_e, force, slope, elastic, taut, fl, fl_x, fv, fv_v = found
            x, z = rigid - e, held + take * elastic
            speed = (x - x_before) * per_h
            e_0, e_1, e_2 = e_1, e_2, e
            if stage == 0:
                x_1, z_1 = x, z
            else:
                x_now, z_now = x, z
                states[LENGTH, i], states[ELONGATION, i], states[FORCE, i] = x, e, force
                states[SPEED, i] = speed if i > 0 else 0.0
                states[TISSUE, i] = max(elastic - z, 0.0)
            if size == 0:
                continue

            stiff, stretched = k * elastic, (x - x0) * elastic
            relaxed[i_k], relaxed[i_x0] = take * stretched, -take * stiff
            relaxed[i_tau] = take_tau * elastic + keep_tau * z_before
            relaxed[i_rel] = take_rel * elastic + keep_rel * z_before
            direct[i_k] = taut * (relaxed[i_k] - stretched)
            direct[i_x0] = taut * (relaxed[i_x0] + stiff)
            direct[i_tau], direct[i_rel] = taut * relaxed[i_tau], taut * relaxed[i_rel]
            direct[i_l0] = alpha * (fl_x * fv * x + fl * fv_v * speed) / l0
            by_eps0, by_toe, by_k_toe, by_max = tendon_partials(e, force, slope, curve, shape)
            pulled[i_eps], pulled[i_toe] = by_eps0 * strain_length, by_toe
            pulled[i_bend], pulled[i_max] = by_k_toe, by_max
            driven[i_f0] = alphas[BY_F0 + muscle, i, stage]
            driven[i_beta] = alphas[BY_BETA + muscle, i, stage]
            for channel in range(first, last):
                driven[place[G + channel]] = alphas[CHANNEL + channel, i, stage]
            for drive in range(len(by_drive)):
                driven[place[N_COMPLIANT + drive]] = by_drive[drive, i, stage]

            share = 1.0 / G_e
            by_start, by_held = alpha * fl * fv_v * per_h * share, taut * keep * share
            by_alpha, taken = pulling * fl * fv * share, take * stiff
            for j in range(size):
                x_s[j] = (
                    by_start * x_b[j] + by_held * z_b[j] - by_alpha * driven[j]
                    + share * (direct[j] + pulled[j])
                )  # fmt: skip
                z_s[j] = keep * z_b[j] + taken * x_s[j] + relaxed[j]
            if stage == 1:
                for j in range(size):
                    x_n[j], z_n[j] = x_s[j], z_s[j]
                    jacobian[rows[j], i] += arms[i] * (pulled[j] - slope * x_s[j])
    return -1
