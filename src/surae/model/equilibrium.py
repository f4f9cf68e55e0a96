"""Force balance of a muscle and its tendon, equations (25) and (26), solved for one instant.

The unknown is the tendon's elongation e, so that a stiff tendon loses no digits; the muscle's
length is x = x_rigid − e. Its speed is that of an implicit step, x' = (x − x̂)/h, and the relaxation
(10) is eliminated: F_elas = max(w·F0(x) − held, 0). The residual

    G(e) = F_t(e) − F_elas(x) − α·f_l(x)·f_v(x')

never divides by α; with α = 0 it is the equilibrium of tendon and passive tissue.

The root always exists. Where e = 0, or where the muscle shortens at vmax if that is shorter still,
G ≤ 0; as e grows, F_t grows without bound while the muscle's force does not. Only with α = 0 and
tissue that would have to push can tendon and muscle both be slack, with a whole interval of roots;
then e = 0 is taken, the end of that interval at which the tendon becomes taut and the muscle has
the length it has on a rigid tendon. An overstretched muscle whose f_v is saturated may have several
roots; the one nearest to the predicted elongation is kept for as long as it exists, and where it
ends the muscle yields in a jump, which is what the equations say.
"""

import math

from surae.model.contraction import MVSHL, bridge_strain, force_length, force_velocity
from surae.model.jit import inner, jit
from surae.model.passive import elastic_force
from surae.model.tendon import TendonCurve, tendon_force

#: A Newton step is the last one below this fraction of the length over which forces bend; what it
#: leaves is its square, 1e-14 of that length.
TOLERANCE = 1e-7
#: Newton steps from the predicted root before the bracketed search takes over, and its limit.
NEWTON_STEPS = 8
SEARCH_STEPS = 400

Muscle = tuple[float, float, float, float, float, float, float, float]
Step = tuple[float, float, float, float, float, float, float]
Bridges = tuple[float, float, float, float]
Balance = tuple[float, float, float, float, float, float, float, float, float, float, float]
#: None that hold.
FREE = (0.0, 1.0, 0.0, 0.0)


@inner
def balance(
    e: float, muscle: Muscle, curve: TendonCurve, step: Step, bridges: Bridges = FREE
) -> Balance:
    """Residual of the force balance and what its derivatives are made of.

    Parameters
    ----------
    e : float
        Elongation of the tendon [m].
    muscle : tuple
        k [1/m], x0 [m], l0 [m], vmax [m/s]; then what shapes its curves: logarithms of the widths
        below and above l0, mvsh and fecc − 1.
    curve : tuple
        From `surae.model.tendon.tendon_curve`.
    step : tuple
        x_rigid [m], x̂ [m], 1/h [1/s], w [-], held [N], α [N]; the force over which tissue goes
        slack [N], ½·(f + √(f² + that²)) being left of f, 0 for a kink.
    bridges : tuple
        Of bridges that hold, see `bridge_strain`: K/l0 [1/m], ρ [m], x̂ [m] and ŝ [m].

    Returns
    -------
    tuple of float
        G [N]; ∂G/∂e [N/m]; F_t [N]; ∂F_t/∂e [N/m]; F0 [N]; 1 where the tissue pulls, else 0,
        and between where it goes slack; f_l;
        ∂f_l/∂x [1/m]; f_v; ∂f_v/∂x' [s/m]; what bridges add to f_v.
    """
    k, x0, l0, vmax, short, long, bend, gain = muscle
    rigid, start, per_h, w, held, alpha, rounded = step
    x = rigid - e
    force, slope = tendon_force(e, curve)
    elastic = elastic_force(x, k, x0)
    fl, fl_x, _, _ = force_length(x, l0, short, long)
    fv, fv_v, _, _ = force_velocity((x - start) * per_h, vmax, bend, gain)
    G = force - alpha * fl * fv
    G_e = slope + alpha * (fl_x * fv + fl * fv_v * per_h)
    hold = 0.0
    if bridges[0] != 0.0:
        strain, strain_x, _, _ = bridge_strain(x - bridges[2], bridges[3], bridges[1])
        hold = bridges[0] * strain
        G -= alpha * fl * hold
        G_e += alpha * (fl_x * hold + fl * bridges[0] * strain_x)
    pulls = 0.0
    tissue = w * elastic - held
    if rounded > 0.0:
        far = math.sqrt(tissue * tissue + rounded * rounded)
        pulls = 0.5 * (1.0 + tissue / far)
        G -= 0.5 * (tissue + far)
        G_e += pulls * w * k * elastic
    elif tissue > 0.0:
        pulls = 1.0
        G -= tissue
        G_e += w * k * elastic
    return G, G_e, force, slope, elastic, pulls, fl, fl_x, fv, fv_v, hold


@jit
def solve(
    guess: float, muscle: Muscle, curve: TendonCurve, step: Step, bridges: Bridges = FREE
) -> tuple[bool, float, Balance]:
    """Elongation at which the forces balance.

    Newton from the guess; where that does not settle, a bracketed search, which always does as
    long as every number is finite.

    Parameters
    ----------
    guess : float
        Where to begin [m].
    muscle, curve, step, bridges
        As in `balance`.

    Returns
    -------
    solved : bool
        False only when a number is not finite.
    e : float
        The root [m].
    here : tuple
        As from `balance`, at the root to within the last Newton step, forces corrected for it.
    """
    scale = min(1.0 / curve[1], 1.0 / muscle[0], muscle[6] * MVSHL * muscle[3] / step[2])
    tolerance = TOLERANCE * scale
    e = guess
    for _ in range(NEWTON_STEPS):
        here = balance(e, muscle, curve, step, bridges)
        if not here[1] > 0.0:
            break
        # Halley's step, which saves about every fourth evaluation; Newton's where it would not be
        G = here[0]
        square = here[1] * here[1]
        bent = 0.5 * G * _curvature(here, step, muscle)
        if abs(bent) > 0.5 * square:
            bent = 0.0
        change = -G * here[1] / (square - bent)
        e += change
        if abs(change) <= tolerance:
            return True, e, _corrected(here, change, muscle[0])
    return _search(tolerance, muscle, curve, step, bridges)


@inner
def _curvature(here: Balance, step: Step, muscle: Muscle) -> float:
    """Second derivative of the residual, as far as it is the force-velocity curve's [N/m²]."""
    fl = here[6]
    fv = here[8]
    fv_v = here[9] * step[2]
    if fv < 1.0:  # both branches of (17) are hyperbolas: f'' follows from f and f'
        return -step[5] * fl * 2.0 * fv_v * fv_v / (muscle[6] + fv)
    top = 1.0 + (1.0 + muscle[6] * MVSHL) * muscle[7]
    return step[5] * fl * 2.0 * fv_v * fv_v / (top - fv)


@inner
def _corrected(here: Balance, change: float, k: float) -> Balance:
    """The balance with its forces carried along the last Newton step."""
    force = max(here[2] + here[3] * change, 0.0)
    elastic = here[4] * (1.0 - k * change)
    return (
        here[0] + here[1] * change,
        here[1],
        force,
        here[3],
        elastic,
        here[5],
        here[6],
        here[7],
        here[8],
        here[9],
        here[10],
    )


@inner
def _search(
    tolerance: float, muscle: Muscle, curve: TendonCurve, step: Step, bridges: Bridges
) -> tuple[bool, float, Balance]:
    """Newton inside a bracket that halves whenever Newton would leave it or slow down."""
    here = balance(0.0, muscle, curve, step, bridges)
    if here[0] == 0.0:
        return True, 0.0, here
    if here[0] > 0.0:  # both slack: the muscle takes up the slack at most at vmax
        low = step[0] - step[1] + muscle[3] / step[2]
        high = 0.0
    else:
        low = 0.0
        high = curve[0]
        while balance(high, muscle, curve, step, bridges)[0] < 0.0:
            low = high
            high *= 2.0
    e = 0.5 * (low + high)
    last = high - low
    for _ in range(SEARCH_STEPS):
        here = balance(e, muscle, curve, step, bridges)
        if math.isnan(here[0]):
            break
        if here[0] < 0.0:
            low = e
        elif here[0] > 0.0:
            high = e
        else:
            return True, e, here
        change = -here[0] / here[1]
        if not (low < e + change < high and abs(change) < 0.5 * abs(last)):
            change = 0.5 * (low + high) - e
        last = change
        e += change
        if abs(change) <= tolerance:
            return True, e, _corrected(here, change, muscle[0])
    return False, e, here
