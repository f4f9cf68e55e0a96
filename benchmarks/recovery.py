"""How well the fit finds the parameters of virtual subjects: a Markdown table per protocol."""

import argparse
import time

import numpy as np

from surae.estimation import STARTS
from surae.protocol import PROFILES, TASKS, Protocol
from surae.studies.virtual import POPULATIONS
from surae_thesis.recovery import markdown, recover, summarise


def main() -> None:
    parser = argparse.ArgumentParser(description=__doc__)
    parser.add_argument("--subjects", type=int, default=50)
    parser.add_argument("--starts", type=int, default=STARTS)
    parser.add_argument("--noise", type=float, default=0.05)
    parser.add_argument("--model", default="muscle")
    parser.add_argument("--population", choices=POPULATIONS, default="healthy")
    parser.add_argument("--task", choices=TASKS, default="part-passive")
    parser.add_argument(
        "--profile", choices=PROFILES, nargs="+", default=["multiple-holds", "multi-sine-holds"]
    )
    parser.add_argument("--rate", type=float, default=256.0)
    given = parser.parse_args()
    for profile in given.profile:
        protocol = Protocol(
            profile=profile,
            task=given.task,
            chirp_amplitude=0.2,
            chirp_rate=0.5,
            rate_hz=given.rate,
        )
        begin = time.perf_counter()
        recoveries = [
            recover(
                seed,
                protocol,
                population=given.population,
                model=given.model,
                noise=given.noise,
                starts=given.starts,
            )
            for seed in range(given.subjects)
        ]
        seconds = time.perf_counter() - begin
        vaf = np.array([leg.vaf for leg in recoveries])
        identified = [e for leg in recoveries for e in leg.estimates if e.identified]
        close = np.mean([abs(e.error) <= 0.1 for e in identified])
        agreeing = np.mean([leg.agreeing for leg in recoveries])
        print(f"## {profile}, chirp 0.2 rad, 0.5 Hz/s, {given.task}, {given.rate:g} Hz\n")
        print(
            f"{given.subjects} {given.population} subjects, model {given.model}, "
            f"{100 * given.noise:g} % noise on EMG and torque, {given.starts} starts "
            f"({agreeing:.1f} agree on average), {seconds / given.subjects:.2f} s per subject.\n"
            f"VAF median {np.median(vaf):.3f} %, lowest {vaf.min():.3f} %; "
            f"{sum(leg.status == 'converged' for leg in recoveries)} converged, "
            f"{sum(leg.status == 'at-bounds' for leg in recoveries)} with a parameter at a bound.\n"
            f"Of {len(identified)} parameters judged identified, {100 * close:.1f} % lie within "
            "10 % of the truth.\n"
        )
        print(markdown(summarise(recoveries)) + "\n")


if __name__ == "__main__":
    main()
