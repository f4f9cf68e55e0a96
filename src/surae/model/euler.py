"""The thesis's own integration of the muscle-tendon model, equations (22) to (28), kept as it is.

One explicit Euler step a sample: the tendon force follows from the muscle length that the sample
before left behind, what tissue does not carry is the active force, the inverse of (17) makes a
speed of it, clamped at ±vmax (27), and the speed the next length (28). It divides by the active
state, is stiff, and where the muscle is hardly active it chatters between the clamps (Figure 45).
"""

from surae.base.units import FloatArray
from surae.model.compliant import ELONGATION, FORCE, LENGTH, SPEED, TISSUE
from surae.model.compliant_stage import EPS0, F_MAX, K_TOE, TOE
from surae.model.contraction import CURVES, FECC, MVSH, MVSHL, force_length, force_velocity
from surae.model.equilibrium import solve
from surae.model.jit import jit
from surae.model.passive import elastic_force, relaxation_step
from surae.model.rigid import K_REL, L0, TAU, X0, K
from surae.model.tendon import tendon_curve, tendon_force

#: Bisections of ±vmax: to a millionth of a millionth of it.
_HALVINGS = 40


@jit
def speed_of(factor: float, vmax: float) -> float:
    """Speed at a force-velocity factor, the inverse of (17) with the clamp (27).

    Nothing contracts faster than −vmax, where the factor is 0, nor is stretched faster than vmax,
    where it is fecc. A factor that is not a number (no active state and no force left to explain)
    is a muscle at rest.

    Parameters
    ----------
    factor : float
        f_v, of any size and sign.
    vmax : float
        Maximum shortening speed [m/s].

    Returns
    -------
    float
        x' [m/s].
    """
    if factor <= 0.0:
        return -vmax
    if factor < 1.0:
        return vmax * (factor - 1.0) / (1.0 + factor / MVSH)
    if factor >= FECC:
        return vmax
    if factor >= 1.0:
        a = MVSH * MVSHL
        return a * vmax * (factor - 1.0) / ((1.0 + a) * (FECC - 1.0) - (factor - 1.0))
    return 0.0


@jit
def damped_speed(force: float, active: float, vmax: float, damping: float) -> float:
    """Speed at which the active force and a damper beside it make a force [m/s], within ±vmax.

    Parameters
    ----------
    force : float
        What tissue does not carry [N].
    active : float
        Active force at rest, f_l·α [N].
    vmax : float
        Maximum shortening speed [m/s].
    damping : float
        Of the damper, above 0 [N·s/m].

    Returns
    -------
    float
        x' [m/s], where active·f_v(x') + damping·x' is the force.
    """
    low = -vmax
    high = vmax
    for _ in range(_HALVINGS):
        middle = 0.5 * (low + high)
        part = force_velocity(middle, vmax)[0]  # (17)
        if active * part + damping * middle < force:
            low = middle
        else:
            high = middle
    return 0.5 * (low + high)


@jit
def explicit_states(
    p: FloatArray,
    strain_length: float,
    lengths: FloatArray,
    alphas: FloatArray,
    factor: float,
    dt: float,
    damping: float,
    states: FloatArray,
) -> int:
    """States of a muscle group as the thesis integrates them.

    It starts, as the thesis does, with tendon and tissue in equilibrium and no active state.

    Parameters
    ----------
    p, strain_length, factor, dt, states
        As in `surae.model.compliant.compliant_states`.
    lengths : ndarray, shape (n,)
        Muscle length on a rigid tendon, lmt − lt0 [m].
    alphas : ndarray, shape (n,)
        Active state [N].
    damping : float
        Of a damper beside the active force, a part of the tendon's Fmax at vmax; 0 is the scheme as
        it is printed, more is the remedy of appendix B.

    Returns
    -------
    int
        0 where the start could not be solved, the only thing that ever is, else −1.
    """
    k = p[K]
    x0 = p[X0]
    l0 = p[L0]
    vmax = factor * l0
    eps0 = p[EPS0] * strain_length
    toe = p[TOE]
    curve = tendon_curve(eps0, toe, p[K_TOE], p[F_MAX])
    step = relaxation_step(p[TAU], p[K_REL], dt)
    decay = step[0]
    b0 = step[1]
    b1 = step[2]
    dc = p[K_REL] / (1.0 + p[K_REL])

    start = (lengths[0], lengths[0], 1.0, 1.0 - dc, 0.0, 0.0, 0.0)
    solved, e, _ = solve(0.0, (k, x0, l0, vmax, *CURVES), curve, start)
    if not solved:
        return 0
    x = lengths[0] - e
    before = elastic_force(x, k, x0)
    z = dc * before
    for i in range(len(lengths)):
        e = lengths[i] - x  # (22)
        force = tendon_force(e, curve)[0]
        elastic = elastic_force(x, k, x0)
        if i > 0:
            z = decay * z + b0 * before + b1 * elastic
        before = elastic
        tissue = max(elastic - z, 0.0)
        active = max(alphas[i], 0.0)
        at_rest = force_length(x, l0)[0] * active
        if damping > 0.0:
            speed = damped_speed(force - tissue, at_rest, vmax, damping * p[F_MAX] / vmax)
        else:
            speed = speed_of((force - tissue) / at_rest, vmax)  # (25) to (27)
        states[LENGTH, i], states[SPEED, i], states[ELONGATION, i] = x, speed, e
        states[FORCE, i], states[TISSUE, i] = force, tissue
        x += speed * dt  # (28)
    return -1
