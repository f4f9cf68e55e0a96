"""Forces of a muscle group at a sample, on a rigid tendon or on one that gives way."""

import math

from surae.base.units import FloatArray
from surae.causal.signals import Record
from surae.model.compliant import muscle_of
from surae.model.compliant_stage import (
    BRIDGE,
    E_0,
    E_1,
    E_2,
    EPS0,
    F_MAX,
    GAMMA,
    K_TOE,
    REACH,
    RHO,
    STRAIN,
    TOE,
    X_BEGIN,
    X_FIRST,
    X_LAST,
    X_NOW,
    Z_BEGIN,
    Z_FIRST,
    Z_NOW,
    remember,
    resting_rule,
    stage_rule,
    strain_bridges,
)
from surae.model.contraction import CF, FECC, MVSH, force_velocity
from surae.model.equilibrium import solve
from surae.model.jit import inner
from surae.model.rigid import K_REL, L0, TAU, X0, K
from surae.model.tendon import TendonCurve, tendon_curve


@inner
def rigid_force(
    n: Record, s: Record, group: int, length: float, speed: float
) -> tuple[float, float]:
    """Force of tissue and of the contractile element [N], (8) to (11), (15) to (17)."""
    p = n.groups[group]
    elastic = math.exp(p[K] * (length - p[X0]))
    if s.count == 0:
        s.relaxation[group] = p[K_REL] / (1.0 + p[K_REL]) * elastic
    else:
        s.relaxation[group] = (
            n.relax[0] * s.relaxation[group] + n.relax[1] * s.elastic[group] + n.relax[2] * elastic
        )
    s.elastic[group] = elastic
    u = (length - p[L0]) / p[L0]
    fl = math.exp(-u * u / CF)
    fv = force_velocity(speed, n.vmax_factor * p[L0], MVSH, FECC - 1.0)[0]
    return max(elastic - s.relaxation[group], 0.0), s.active[1] * fl * fv


@inner
def _stages(
    n: Record, s: Record, group: int, length: float, speed: float
) -> tuple[float, float, float]:
    """Length between samples, and by how much both stages' rules miss the unit's own speed."""
    g = GAMMA
    dt = n.dt
    begin, slow = s.length[group], s.speed[group]
    between = (1 + 2 * g) * (1 - g) ** 2 * begin + g**2 * (3 - 2 * g) * length
    between += dt * g * (1 - g) * ((1 - g) * slow - g * speed)
    there = 6 * g * (1 - g) * (length - begin) / dt + (1 - g) * (1 - 3 * g) * slow
    there += g * (3 * g - 2) * speed
    missed = between - begin - g * dt * there
    return between, missed, length - begin - RHO * (between - begin) - g * dt * speed


@inner
def _begin(stage: int, past: FloatArray, missed: float) -> float:
    """Set where a stage begins; a guess of the elongation at its end."""
    lately = past[E_2] - past[E_1]
    before = past[E_1] - past[E_0]
    if stage == 0:
        past[X_BEGIN] = past[X_NOW] + missed
        past[Z_BEGIN] = past[Z_NOW]
        return past[E_2] + 2.0 / RHO * lately - before  # type: ignore[no-any-return]
    past[X_BEGIN] = past[X_NOW] + RHO * (past[X_FIRST] - past[X_NOW]) + missed
    past[Z_BEGIN] = past[Z_NOW] + RHO * (past[Z_FIRST] - past[Z_NOW])
    return past[E_2] + 2.0 * RHO * lately - before  # type: ignore[no-any-return]


@inner
def _tendon(p: FloatArray, unit: float) -> TendonCurve:
    curve: TendonCurve = tendon_curve(p[EPS0] * unit, p[TOE], p[K_TOE], p[F_MAX])
    return curve


@inner
def compliant_force(
    n: Record, s: Record, group: int, length: float, speed: float
) -> tuple[float, float]:
    """Force of tissue and of the contractile element [N] on a tendon that gives way.

    As `surae.model.compliant` steps, from sample to sample. Where no balance is found the step has
    failed, and says so.
    """
    p = n.groups[group]
    past = s.past[group]
    muscle = muscle_of(p, n.vmax_factor)
    curve = _tendon(p, n.tendon_unit[group])
    holding = p[BRIDGE] / p[L0]
    bridging = p[REACH] * p[L0] > 0.0 and holding != 0.0
    rest = s.count == 0
    between, missed, missed_last = 0.0, 0.0, 0.0
    guess = 0.0
    alpha = 0.0
    force = 0.0
    tissue = 0.0
    rule = resting_rule(p[K_REL])
    if rest:
        past[X_BEGIN] = length
    else:
        rule = stage_rule(p[TAU], p[K_REL], GAMMA * n.dt)
        between, missed, missed_last = _stages(n, s, group, length, speed)
    keep, take, _, _, _, _, per_h = rule
    for stage in range(1 if rest else 0, 2):
        rigid = between if stage == 0 else length
        if not rest:
            alpha = max(s.active[stage], 0.0)
            guess = _begin(stage, past, missed if stage == 0 else missed_last)
        held = keep * past[Z_BEGIN]
        solved, e, here = solve(
            guess,
            muscle,
            curve,
            (rigid, past[X_BEGIN], per_h, 1.0 - take, held, alpha, 0.0),
            (0.0 if rest else holding, p[REACH] * p[L0], past[X_LAST], past[STRAIN]),
        )
        if not solved:
            s.failed = 1
            return math.nan, math.nan
        x = rigid - e
        z = held + take * here[4]
        if bridging and not rest:
            strain_bridges(past, p, x, alpha, here)
        remember(stage, past, x, z, e)
        force = here[2]
        tissue = max(here[4] - z, 0.0)
    s.length[group] = length
    s.speed[group] = speed
    return tissue, force - tissue
