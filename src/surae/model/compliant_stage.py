"""One stage of a muscle group on a compliant tendon: its rule, its start, exact sensitivities.

What `surae.model.compliant` does at every stage of every step, apart from the force balance itself
(`surae.model.equilibrium`). The sensitivities follow from it by the implicit function theorem.
"""

import math

import numpy as np

from surae.base.units import FloatArray
from surae.model.activation import IntArray
from surae.model.contraction import bridge_strain, force_length, force_velocity
from surae.model.equilibrium import Balance, Muscle
from surae.model.jit import inner
from surae.model.rigid import K_REL, L0, TAU, X0, K
from surae.model.tendon import TendonCurve, TendonShape, tendon_partials

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

#: Rows of what `surae.model.compliant.drive_columns` needs of every stage.
BY_START, BY_HELD, BY_ACTIVE, TAKEN, STIFFNESS, BY_STRAIN, STRAINED, KEPT = range(8)
LINEAR = 8

#: Abscissa and diagonal coefficient of the two-stage SDIRK, γ = 1 − 1/√2: L-stable, second order.
GAMMA = 1.0 - 0.5**0.5
#: The second stage starts from (1 − ρ) of the sample before and ρ of the first stage.
RHO = (1.0 - GAMMA) / GAMMA

#: Where length and relaxation are: at the sample before, at the first stage, and where the stage
#: begins; elongations at the three stages before; where the last stage has left muscle and bridges.
X_NOW, Z_NOW, X_FIRST, Z_FIRST, X_BEGIN, Z_BEGIN, E_0, E_1, E_2, X_LAST, STRAIN = range(11)
PAST = 11

#: Rows of sensitivities: of length and relaxation at the sample, where the stage begins, and at the
#: stage; of the bridges' strain, where the last stage has left it.
BY_X_N, BY_Z_N, BY_X_B, BY_Z_B, BY_X_S, BY_Z_S, BY_BRIDGES = range(7)
#: Rows of what parameters do directly: to the balance, the tendon force, the relaxation, and α.
DIRECT, PULLED, RELAXED, DRIVEN = range(4)

#: Of a stage's relaxation, z = keep·ẑ + take·F0: keep and take, their derivatives by τ and k_rel
#: (keep's, then take's), and 1/h [1/s].
Rule = tuple[float, float, float, float, float, float, float]
#: Length [m], elongation [m], speed [m/s], where the relaxation begins [N], α [N] and its slope.
Instant = tuple[float, float, float, float, float, float]
#: Of bridges: their strain [m], its derivatives by the length, by the strain before and by the
#: reach, and by how much a strain before moves the muscle.
Bridged = tuple[float, float, float, float, float]
#: A stage: its rule, balance, instant and bridges.
Stage = tuple[Rule, Balance, Instant, Bridged]
#: What elongation in metres is made of ε0 by, then the tendon's curve and its derivatives.
Tendon = tuple[float, TendonCurve, TendonShape]
#: A muscle group: parameters, their places among what is wanted, muscle, tendon, whether curves'
#: shapes are wanted, and whether bridges hold.
Group = tuple[FloatArray, IntArray, Muscle, Tendon, bool, bool]


@inner
def resting_rule(k_rel: float) -> Rule:
    """The start is one stage too: relaxation in its steady state, no active force."""
    dc = 1.0 / (1.0 + k_rel)
    return 0.0, k_rel * dc, 0.0, 0.0, 0.0, dc * dc, 1.0


@inner
def stage_rule(tau: float, k_rel: float, h: float) -> Rule:
    """An implicit stage of (10), h [s] after where it begins."""
    keep = 1.0 / (1.0 + h * (1.0 + k_rel) / tau)
    take = keep * h * k_rel / tau
    keep_tau = keep * (1.0 - keep) / tau
    keep_rel = -keep * keep * h / tau
    take_tau = -take * keep / tau
    take_rel = keep * (1.0 - take) * h / tau
    return keep, take, keep_tau, keep_rel, take_tau, take_rel, 1.0 / h


@inner
def not_negative(raw: float, rest: float) -> tuple[float, float]:
    """What an active state pulls with [N], ½·rest·ln(1 + exp(2·α/rest)), and its slope."""
    alpha = max(raw, 0.0)
    pulling = 1.0 if raw >= 0.0 else 0.0
    if rest > 0.0:
        away = math.exp(-2.0 * abs(raw) / rest)
        alpha += 0.5 * rest * math.log1p(away)
        pulling = (1.0 if raw >= 0.0 else away) / (1.0 + away)
    return alpha, pulling


@inner
def places(
    slots: IntArray, unwanted: int, alpha_slots: IntArray, length_slots: IntArray
) -> tuple[IntArray, IntArray]:
    """Rows of the jacobian that are wanted, and the place of each parameter among them.

    The group's parameters come first, then those of its active state and its length. What is not
    wanted has the place after them, which nobody reads.
    """
    size = 0
    for j in range(len(slots)):
        if slots[j] != unwanted:
            size += 1
    first = size
    last = first + len(alpha_slots)
    rows = np.empty(last + len(length_slots), np.int64)
    place = np.empty(len(slots), np.int64)
    size = 0
    for j in range(len(slots)):
        if slots[j] != unwanted:
            rows[size] = slots[j]
            place[j] = size
            size += 1
        else:
            place[j] = len(rows)
    for j in range(len(alpha_slots)):
        rows[first + j] = alpha_slots[j]
    for j in range(len(length_slots)):
        rows[last + j] = length_slots[j]
    return rows, place


@inner
def begin(
    stage: int,
    i: int,
    lengths: FloatArray,
    length_slopes: FloatArray,
    past: FloatArray,
    sens: FloatArray,
) -> float:
    """Set where a stage begins, with sensitivities; return a guess of the elongation at its end.

    The guess is the quadratic through the three stages before.
    """
    size = sens.shape[1] - 1
    lately = past[E_2] - past[E_1]
    before = past[E_1] - past[E_0]
    if stage == 0:
        past[X_BEGIN] = past[X_NOW] + lengths[2, i]
        past[Z_BEGIN] = past[Z_NOW]
        guess = past[E_2] + 2.0 / RHO * lately - before
        for j in range(size):
            sens[BY_X_B, j] = sens[BY_X_N, j]
            sens[BY_Z_B, j] = sens[BY_Z_N, j]
    else:
        past[X_BEGIN] = past[X_NOW] + RHO * (past[X_FIRST] - past[X_NOW]) + lengths[3, i]
        past[Z_BEGIN] = past[Z_NOW] + RHO * (past[Z_FIRST] - past[Z_NOW])
        guess = past[E_2] + 2.0 * RHO * lately - before
        for j in range(size):
            sens[BY_X_B, j] = sens[BY_X_N, j] + RHO * (sens[BY_X_S, j] - sens[BY_X_N, j])
            sens[BY_Z_B, j] = sens[BY_Z_N, j] + RHO * (sens[BY_Z_S, j] - sens[BY_Z_N, j])
    last = size - len(length_slopes)
    for j in range(len(length_slopes)):
        sens[BY_X_B, last + j] += length_slopes[j, 2 + stage, i]
    return guess  # type: ignore[no-any-return]


@inner
def remember(stage: int, past: FloatArray, x: float, z: float, e: float) -> None:
    """Keep where a stage ends, for those after it."""
    past[E_0] = past[E_1]
    past[E_1] = past[E_2]
    past[E_2] = e
    past[X_LAST] = x
    if stage == 0:
        past[X_FIRST] = x
        past[Z_FIRST] = z
    else:
        past[X_NOW] = x
        past[Z_NOW] = z


@inner
def strain_bridges(
    past: FloatArray, p: FloatArray, x: float, alpha: float, here: Balance
) -> Bridged:
    """What bridges that hold are strained by when the muscle moves to a length [m]."""
    strain, strain_x, kept, strain_reach = bridge_strain(
        x - past[X_LAST], past[STRAIN], p[REACH] * p[L0]
    )
    past[STRAIN] = strain
    by_strain = alpha * here[6] * (p[BRIDGE] / p[L0]) / here[1]
    return strain, strain_x, kept, strain_reach, by_strain


@inner
def linearise(row: FloatArray, i: int, k: float, there: Stage) -> None:
    """Fill a stage's rows of what `surae.model.compliant.drive_columns` needs."""
    rule, here, now, bridged = there
    keep, take, _, _, _, _, per_h = rule
    _, G_e, _, slope, elastic, taut, fl, _, fv, fv_v, hold = here
    _, _, _, _, alpha, pulling = now
    _, strain_x, kept, _, by_strain = bridged
    row[BY_START, i] = alpha * fl * fv_v * per_h / G_e
    row[BY_HELD, i] = taut * keep / G_e
    row[BY_ACTIVE, i] = pulling * fl * (fv + hold) / G_e
    row[TAKEN, i] = take * k * elastic
    row[STIFFNESS, i] = slope
    row[BY_STRAIN, i] = by_strain
    row[STRAINED, i] = strain_x
    row[KEPT, i] = kept


@inner
def sensitivities(
    stage: int,
    i: int,
    group: Group,
    there: Stage,
    alpha_slopes: FloatArray,
    length_slopes: FloatArray,
    sens: FloatArray,
    terms: FloatArray,
) -> None:
    """Carry the sensitivities through a stage, by all that is wanted."""
    p, place, muscle, tendon, shapes, bridging = group
    rule, here, now, bridged = there
    _by_tissue(terms, place, muscle, rule, here, now)
    if shapes:
        _by_curves(terms[DIRECT], place, muscle, here, now)
    _by_tendon(terms[PULLED], place, tendon, here, now[1])
    _by_inputs(terms, stage, i, alpha_slopes, length_slopes, here[3])
    if bridging:
        _by_bridges(sens, terms[DIRECT], place, p, here, now[4], bridged)
    _carry(sens, terms, p[K], there)


@inner
def _by_tissue(
    terms: FloatArray,
    place: IntArray,
    muscle: Muscle,
    rule: Rule,
    here: Balance,
    now: Instant,
) -> None:
    """What stiffness, slack length, relaxation and optimal length do directly."""
    k, x0, l0, _, _, _, _, _ = muscle
    _, take, keep_tau, keep_rel, take_tau, take_rel, _ = rule
    _, _, _, _, elastic, taut, fl, fl_x, fv, fv_v, hold = here
    x, _, speed, z_before, alpha, _ = now
    stiff = k * elastic
    stretched = (x - x0) * elastic
    terms[RELAXED, place[K]] = take * stretched
    terms[RELAXED, place[X0]] = -take * stiff
    terms[RELAXED, place[TAU]] = take_tau * elastic + keep_tau * z_before
    terms[RELAXED, place[K_REL]] = take_rel * elastic + keep_rel * z_before
    terms[DIRECT, place[K]] = taut * (terms[RELAXED, place[K]] - stretched)
    terms[DIRECT, place[X0]] = taut * (terms[RELAXED, place[X0]] + stiff)
    terms[DIRECT, place[TAU]] = taut * terms[RELAXED, place[TAU]]
    terms[DIRECT, place[K_REL]] = taut * terms[RELAXED, place[K_REL]]
    terms[DIRECT, place[L0]] = alpha * (fl_x * (fv + hold) * x + fl * fv_v * speed) / l0


@inner
def _by_curves(
    direct: FloatArray, place: IntArray, muscle: Muscle, here: Balance, now: Instant
) -> None:
    """What shapes the curves of force over length and speed does directly."""
    _, _, l0, vmax, short, long, bend, gain = muscle
    fl, fv, fv_v, hold = here[6], here[8], here[9], here[10]
    x, _, speed, _, alpha, _ = now
    by_width = alpha * (fv + hold) * force_length(x, l0, short, long)[3]
    _, _, by_bend, by_gain = force_velocity(speed, vmax, bend, gain)
    direct[place[SHORT]] = 0.0
    direct[place[LONG]] = 0.0
    direct[place[SHORT] if x < l0 else place[LONG]] = -by_width
    direct[place[FASTEST]] = alpha * fl * fv_v * speed
    direct[place[BEND]] = -alpha * fl * by_bend
    direct[place[GAIN]] = -alpha * fl * by_gain


@inner
def _by_tendon(
    pulled: FloatArray, place: IntArray, tendon: Tendon, here: Balance, e: float
) -> None:
    """What the tendon's parameters do to its force."""
    strain_length, curve, shape = tendon
    by_eps0, by_toe, by_k_toe, by_max = tendon_partials(e, here[2], here[3], curve, shape)
    pulled[place[EPS0]] = by_eps0 * strain_length
    pulled[place[TOE]] = by_toe
    pulled[place[K_TOE]] = by_k_toe
    pulled[place[F_MAX]] = by_max


@inner
def _by_inputs(
    terms: FloatArray,
    stage: int,
    i: int,
    alpha_slopes: FloatArray,
    length_slopes: FloatArray,
    slope: float,
) -> None:
    """What moves the active state and the unit's length: the unit pulls at its tendon."""
    last = terms.shape[1] - 1 - len(length_slopes)
    first = last - len(alpha_slopes)
    for j in range(len(alpha_slopes)):
        terms[DRIVEN, first + j] = alpha_slopes[j, stage, i]
    for j in range(len(length_slopes)):
        terms[PULLED, last + j] = slope * length_slopes[j, stage, i]


@inner
def _by_bridges(
    sens: FloatArray,
    direct: FloatArray,
    place: IntArray,
    p: FloatArray,
    here: Balance,
    alpha: float,
    bridged: Bridged,
) -> None:
    """What bridges that hold do directly; what they are strained by while the muscle stays."""
    strain, strain_x, kept, strain_reach, _ = bridged
    fl = here[6]
    hold = here[10]
    l0 = p[L0]
    for j in range(sens.shape[1] - 1):
        sens[BY_BRIDGES, j] = kept * sens[BY_BRIDGES, j] - strain_x * sens[BY_X_S, j]
    sens[BY_BRIDGES, place[L0]] += strain_reach * p[REACH]
    sens[BY_BRIDGES, place[REACH]] += strain_reach * l0
    direct[place[BRIDGE]] = -alpha * fl * strain / l0
    direct[place[L0]] += alpha * fl * hold / l0


@inner
def _carry(sens: FloatArray, terms: FloatArray, k: float, there: Stage) -> None:
    """Sensitivities of length, relaxation and bridges at the end of a stage."""
    rule, here, now, bridged = there
    keep, take, _, _, _, _, per_h = rule
    _, G_e, _, _, elastic, taut, fl, _, fv, fv_v, hold = here
    _, _, _, _, alpha, pulling = now
    _, strain_x, _, _, by_strain = bridged
    share = 1.0 / G_e
    by_start = alpha * fl * fv_v * per_h * share
    by_held = taut * keep * share
    by_active = pulling * fl * (fv + hold) * share
    taken = take * (k * elastic)
    for j in range(sens.shape[1] - 1):
        sens[BY_X_S, j] = (
            by_start * sens[BY_X_B, j]
            + by_held * sens[BY_Z_B, j]
            - by_active * terms[DRIVEN, j]
            + share * (terms[DIRECT, j] + terms[PULLED, j])
            - by_strain * sens[BY_BRIDGES, j]
        )
        sens[BY_Z_S, j] = keep * sens[BY_Z_B, j] + taken * sens[BY_X_S, j] + terms[RELAXED, j]
        sens[BY_BRIDGES, j] += strain_x * sens[BY_X_S, j]
