"""How often the 95 % intervals hold the truth: Markdown tables for white and correlated noise.

One virtual subject; the EMG is free of noise, so that the Cramér–Rao bound is that of the torque's
noise alone.
"""

import argparse
import time

import numpy as np
from scipy.signal import lfilter

from surae.protocol import Protocol, generate
from surae.studies import virtual_subject, virtual_trial
from surae_thesis.coverage import coverage, markdown


def main() -> None:
    parser = argparse.ArgumentParser(description=__doc__)
    parser.add_argument("--realisations", type=int, default=1000)
    parser.add_argument("--subject", type=int, default=1)
    parser.add_argument("--noise", type=float, default=0.05, help="part of the mean torque")
    parser.add_argument("--rate", type=float, default=125.0)
    parser.add_argument("--rho", type=float, nargs="+", default=[0.0, 0.9, 0.98])
    given = parser.parse_args()
    subject = virtual_subject(given.subject)
    protocol = Protocol(
        profile="multiple-holds",
        task="part-passive",
        chirp_amplitude=0.2,
        chirp_rate=0.5,
        rate_hz=given.rate,
    )
    clean = virtual_trial(subject, generate(protocol), noise=0.0)
    sd = given.noise * np.abs(clean.torque).mean()
    print(
        f"Subject {given.subject}, multiple holds, chirp 0.2 rad, 0.5 Hz/s, part-passive, "
        f"{given.rate:g} Hz, {clean.n} samples; torque noise {sd:.2f} Nm, no EMG noise; "
        f"{given.realisations} realisations.\n"
    )
    for rho in given.rho:
        # Noise of the same variance for every ρ.
        drive = sd * np.sqrt(1 - rho**2)

        def noise(rng, n, rho=rho, drive=drive):
            first = rng.standard_normal() * sd
            return lfilter([1], [1, -rho], drive * rng.standard_normal(n), zi=[rho * first])[0]

        def whiten(rows, rho=rho, drive=drive):
            later = (rows[..., 1:] - rho * rows[..., :-1]) / drive
            return np.concatenate([rows[..., :1] / sd, later], axis=-1)

        begin = time.perf_counter()
        outcome = coverage(
            clean, subject.parameters, noise, whiten, realisations=given.realisations
        )
        seconds = time.perf_counter() - begin
        title = "White noise" if rho == 0 else f"AR(1) noise, ρ = {rho:g}"
        print(
            f"## {title}\n\nRobust intervals in {100 * outcome.robust:.0f} % of the fits; "
            f"{1e3 * seconds / given.realisations:.0f} ms a realisation.\n"
        )
        print(markdown(outcome.rows) + "\n", flush=True)


if __name__ == "__main__":
    main()
