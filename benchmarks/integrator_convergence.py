"""Accuracy and speed of the integrators of the muscle-tendon model, as Markdown tables.

Run: python benchmarks/integrator_convergence.py
"""

import math
import time as clock

import numpy as np

from surae.base.units import FloatArray
from surae.model import ModelOptions, get_model
from surae.model.integrators import muscle_tendon_simulator
from surae.model.muscle_tendon import MuscleTendonSimulator
from surae.signals import ModelInputs

SPEC = get_model("muscle-tendon")
SECONDS = 32.0
FINE = 32_000.0  # Hz
HEALTHY = {
    "m": 2.0,
    "k_tri": 200.0,
    "k_tib": 110.0,
    "x0_tri": 0.018,
    "x0_tib": 0.065,
    "tau_rel": 2.0,
    "k_rel": 0.4,
    "g1": 0.6e6,
    "g2": 0.9e6,
    "g3": 1.3e6,
    "g4": 1.0e6,
    "l0_tri": 0.045,
    "l0_tib": 0.075,
    "f0": 2.0,
    "beta": 1.0,
}


def movement(rate_hz: float) -> ModelInputs:
    """Multi-sine through the range of motion, bursts of up to 3e-4 V and rests between them."""
    rng = np.random.default_rng(1)
    time = np.arange(round(SECONDS * rate_hz) + 1) / rate_hz
    omega = 2 * np.pi * rng.uniform(0.05, 1.5, 8)
    size = 0.65 * rng.dirichlet(np.ones(8))
    phase = np.outer(time, omega) + rng.uniform(0, 2 * np.pi, 8)
    beats, shift = rng.uniform(0.2, 0.8, 4), rng.uniform(0, 2 * np.pi, 4)
    emg = 3e-4 * np.maximum(np.sin(2 * np.pi * np.outer(time, beats) + shift), 0.0) ** 2
    return ModelInputs(
        name="multi-sine",
        rate_hz=rate_hz,
        time=time,
        angle=-0.15 + np.sin(phase) @ size,
        velocity=np.cos(phase) @ (size * omega),
        acceleration=-np.sin(phase) @ (size * omega**2),
        emg=emg,
        emg_unit="V",
        torque=None,
    )


def forces(rate_hz: float, options: ModelOptions) -> FloatArray:
    """Tendon forces of both groups [N], shape (2, n)."""
    simulator = muscle_tendon_simulator(movement(rate_hz), options)
    return simulator.tendon(SPEC.vector(HEALTHY, options)).tendon_force


def table(strain: str) -> None:
    """Relative RMS errors of the tendon forces against the fine solution."""
    implicit = ModelOptions(tendon_strain=strain)
    explicit = ModelOptions(tendon_strain=strain, integrator="explicit-euler")
    fine = forces(FINE, implicit)
    fine_time = np.arange(fine.shape[1]) / FINE

    def errors(rate_hz: float, options: ModelOptions) -> FloatArray:
        computed = forces(rate_hz, options)
        t = np.arange(computed.shape[1]) / rate_hz
        true = np.stack([np.interp(t, fine_time, force) for force in fine])
        share: FloatArray = np.mean((computed - true) ** 2, axis=1) / np.mean(true**2, axis=1)
        return np.asarray(np.sqrt(share))

    print(f"\nTendon force error, ε0 of mode {strain!r}: RMS, % of the force's RMS\n")
    print("| integrator | rate [Hz] | triceps | order | tibialis | order |")
    print("|---|---|---|---|---|---|")
    before = np.full(2, np.nan)
    for rate in (64.0, 128.0, 256.0, 512.0, 1024.0):
        error = errors(rate, implicit)
        order = ["–" if math.isnan(x) else f"{x:.2f}" for x in np.log2(before / error)]
        print(
            f"| implicit | {rate:.0f} | {100 * error[0]:.4f} | {order[0]} "
            f"| {100 * error[1]:.4f} | {order[1]} |"
        )
        before = error
    for rate in (125.0, 256.0, 1000.0):
        error = errors(rate, explicit)
        print(f"| explicit Euler | {rate:.0f} | {100 * error[0]:.2f} | | {100 * error[1]:.2f} | |")


def speed() -> None:
    """Milliseconds for 8192 samples, median of 50."""
    simulator = MuscleTendonSimulator(movement(8191 / SECONDS), ModelOptions())
    p = SPEC.vector(HEALTHY, ModelOptions())
    print("\n| 8192 samples | ms |\n|---|---|")
    for columns in (0, 2, 15, 17, 23):
        simulator.torque_jacobian(p, range(columns))
        taken = []
        for _ in range(50):
            begin = clock.perf_counter()
            simulator.torque_jacobian(p, range(columns))
            taken.append(clock.perf_counter() - begin)
        print(f"| torque and {columns} derivatives | {1e3 * float(np.median(taken)):.2f} |")


if __name__ == "__main__":
    for strain_mode in ("thesis", "slack-length"):
        table(strain_mode)
    speed()
