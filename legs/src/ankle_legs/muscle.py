"""One muscle group and its tendon, integrated by backward Euler on a fine grid.

The equations are those of van de Poll (2015), *Estimating ankle muscle parameters*, with every
shape as a constant of its own, so that a leg may depart from them. SI units.
"""

from __future__ import annotations

import math
from dataclasses import dataclass
from typing import Any

import numpy as np
from numba import njit
from numpy.typing import NDArray

Array = NDArray[np.float64]


@dataclass(frozen=True)
class Muscle:
    """Constants of one muscle group; the defaults are the thesis's shapes."""

    k: float  # stiffness of the passive muscle's exponential [1/m]
    x0: float  # length at which its force is 1 N [m]
    tau_rel: float  # relaxation [s]
    k_rel: float  # share that relaxes: stiffness falls to 1/(1 + k_rel)
    l0: float  # optimal length [m]
    f0: float  # activation's bandwidth [Hz]
    beta: float  # activation's damping
    dlt: float = 0.0  # tendon's stretch at maximal force [m]; 0 is rigid
    f_max: float = 8000.0  # maximal force [N]
    toe: float = 0.3  # share of it at the toe's end
    k_toe: float = 4.0  # toe's curvature
    short_width: float = 0.1  # force-length, ascending limb
    long_width: float = 0.1  # force-length, descending limb
    vmax: float = 8.0  # fastest shortening [l0/s]
    curvature: float = 0.25  # Hill's a/F0 while shortening
    ecc_curvature: float = 0.125  # the same while lengthening
    ecc_plateau: float = 1.5  # force at fast lengthening
    srs: float = 0.0  # short-range stiffness [F/l0]
    srs_range: float = 0.01  # stretch at which it yields [l0]
    width: float = 0.0  # of a pennate muscle, across the line of pull [m]

    def constants(self) -> Array:
        """Return the constants in the order that the kernel reads."""
        tendon = (0.0, 1.0, 0.0, 0.0)
        if self.dlt > 0:
            grown = math.exp(self.k_toe)
            bent = self.toe * self.k_toe * grown
            rest = grown * (1 - self.toe + self.toe * self.k_toe) + self.toe - 1
            slope = 1 - self.toe + bent / (grown - 1)
            tendon = (
                self.dlt * bent / rest,
                self.toe * self.f_max / (grown - 1),
                self.k_toe,
                self.f_max / self.dlt * slope,
            )
        speed = self.vmax * self.l0
        return np.array(
            [
                *(self.k, self.x0, self.tau_rel, self.k_rel, self.l0),
                *(2 * math.pi * self.f0, self.beta, *tendon),
                *(self.short_width * self.l0**2, self.long_width * self.l0**2),
                *(speed, self.curvature, self.ecc_curvature * speed, self.ecc_plateau),
                *(self.srs / self.l0, self.srs_range * self.l0, self.width),
            ]
        )


@njit(cache=True)
def tendon_force(stretch: float, c: Array) -> tuple[float, float]:
    """Return a tendon's force and its slope over stretch, (18)-(21)."""
    if stretch <= 0:
        return 0.0, 0.0
    if stretch <= c[7]:
        grown = math.exp(c[9] * stretch / c[7])
        return c[8] * (grown - 1), c[8] * c[9] / c[7] * grown
    return c[8] * (math.exp(c[9]) - 1) + c[10] * (stretch - c[7]), c[10]


@njit(cache=True)
def _line_force(
    y: float, dy: float, h: float, act: float, extra: float, z: float, s: float, c: Array
) -> tuple[float, float, float, float]:
    """Return what ``_muscle_force`` does along the line of pull of a pennate muscle."""
    if c[19] == 0:
        return _muscle_force(y, dy, h, act, extra, z, s, c)
    y, before = max(y, 1e-4), max(y - dy, 1e-4)
    x = math.sqrt(y * y + c[19] ** 2)
    dx = x - math.sqrt(before * before + c[19] ** 2)
    force, slope, z, s = _muscle_force(x, dx, h, act, 0.0, z, s, c)
    cosine = y / x
    return force * cosine + extra, slope * cosine**2 + force * c[19] ** 2 / x**3, z, s


@njit(cache=True)
def _muscle_force(
    x: float, dx: float, h: float, act: float, extra: float, z: float, s: float, c: Array
) -> tuple[float, float, float, float]:
    """Return the muscle's force, its slope over length, and the two states after a step of h."""
    k, x0, tau, k_rel, l0 = c[0], c[1], c[2], c[3], c[4]
    elastic = math.exp(k * (x - x0))
    a, b = h * k_rel / tau, h * (1 + k_rel) / tau
    z_new = (z + a * elastic) / (1 + b)
    force, slope = elastic - z_new, k * elastic * (1 - a / (1 + b))
    if force < 0:
        force, slope = 0.0, 0.0
    s_new = s
    if act > 0:
        width = c[11] if x < l0 else c[12]
        fl = math.exp(-((x - l0) ** 2) / width)
        dfl = -2 * (x - l0) / width * fl
        v, vmax = dx / h, c[13]
        if v < 0:
            top, bottom = v + vmax, vmax - v / c[14]
            fv, dfv = top / bottom, (bottom + top / c[14]) / bottom**2
            if fv < 0:
                fv, dfv = 0.0, 0.0
        else:
            size = (1 + c[15] / vmax) * (c[16] - 1)
            fv = 1 + size * v / (c[15] + v)
            dfv = size * c[15] / (c[15] + v) ** 2
        held, dheld = 0.0, 0.0
        if c[17] > 0:
            grip = 1 + abs(dx) / c[18]
            s_new = (s + dx) / grip
            held = c[17] * s_new
            dheld = c[17] * (grip - (s + dx) * (1 if dx > 0 else -1) / c[18]) / grip**2
        force += act * fl * (fv + held)
        slope += act * (dfl * (fv + held) + fl * (dfv / h + dheld))
    elif c[17] > 0:
        s_new = 0.0
    return force + extra, slope, z_new, s_new


@njit(cache=True)
def _fibre(y: float, c: Array) -> float:
    """Return the fibre's length at a length along the line of pull [m]."""
    y = max(y, 1e-4) if c[19] > 0 else y
    return math.sqrt(y * y + c[19] * c[19]) if c[19] > 0 else y


@njit(cache=True)
def _held(y: float, act: float, c: Array) -> float:
    """Return the force along the line of a muscle that is held still, all relaxed [N]."""
    x = _fibre(y, c)
    width = c[11] if x < c[4] else c[12]
    force = math.exp(c[0] * (x - c[1])) / (1 + c[3]) + act * math.exp(-((x - c[4]) ** 2) / width)
    return float(force * (max(y, 1e-4) / x if c[19] > 0 else 1.0))


@njit(cache=True)
def integrate(
    h: float, path: Array, drive: Array, gain: Array, extra: Array, c: Array
) -> tuple[Array, Array, Array]:
    """Return length, force and activation at every fine step.

    ``path`` is the length of muscle and tendon less the tendon's slack length [m], ``drive`` what
    the activation follows [N], ``gain`` multiplies the active and ``extra`` [N] adds to the force.
    Activation begins at rest, the passive muscle relaxed and in balance with its tendon.
    """
    n = path.size
    length, force, active = np.empty(n), np.empty(n), np.empty(n)
    elastic_tendon = c[7] > 0
    x = path[0]
    if elastic_tendon:  # bisection: the balance is monotonous in x
        low, high = path[0] - 0.1, path[0]
        for _ in range(60):
            x = 0.5 * (low + high)
            if tendon_force(path[0] - x, c)[0] > _held(x, 0.0, c):
                low = x
            else:
                high = x
    z = c[3] / (1 + c[3]) * math.exp(c[0] * (_fibre(x, c) - c[1]))
    s = a = da = 0.0
    omega, damping = c[5], c[6]
    settle = 1 + h * damping * omega + (0.5 * h * omega) ** 2
    dx = 0.0
    for i in range(n):
        pull = drive[i] + drive[max(i - 1, 0)] - 2 * a - 0.5 * h * da  # the trapezoidal rule
        rate = (da + 0.5 * h * omega * (omega * pull - 2 * damping * da)) / settle
        a, da = a + 0.5 * h * (da + rate), rate
        act = max(a, 0.0) * gain[i]
        before = x
        if not elastic_tendon:
            x = path[i]
            f, _, z, s = _line_force(x, x - before, h, act, extra[i], z, s, c)
        else:
            low, high = path[i] - 0.1, path[i]
            x = min(max(before + dx, low), high)
            for _ in range(60):
                pull, stiff = tendon_force(path[i] - x, c)
                f, slope, _, _ = _line_force(x, x - before, h, act, extra[i], z, s, c)
                miss = pull - f
                if miss > 0:
                    low = x
                else:
                    high = x
                total = stiff + slope
                new = x + miss / total if total > 0 else 0.5 * (low + high)
                if not low <= new <= high:
                    new = 0.5 * (low + high)
                step = abs(new - x)
                x = new
                if step < 1e-13:
                    break
            _, _, z, s = _line_force(x, x - before, h, act, extra[i], z, s, c)
            f = tendon_force(path[i] - x, c)[0]
            dx = x - before
        length[i], force[i], active[i] = _fibre(x, c), f, a
    return length, force, active


def static_force(muscle: Muscle, path: float, active: float) -> tuple[float, float]:
    """Return the force of a muscle and its tendon held still [N], and its length in line [m]."""
    c = muscle.constants()
    low, high = path - 0.1, path
    for _ in range(70 if c[7] > 0 else 0):
        x = 0.5 * (low + high)
        low, high = (x, high) if tendon_force(path - x, c)[0] > _held(x, active, c) else (low, x)
    return _held(high, active, c), high


def relaxed_force(muscle: Muscle, path: Any) -> Array:
    """Return the force of the passive, fully relaxed muscle and its tendon at each path [N]."""
    return np.array([static_force(muscle, p, 0.0)[0] for p in np.atleast_1d(path)], float)
