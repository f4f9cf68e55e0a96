"""What designed protocols gain on the thesis's, and what it costs: figures for decision 19.

    python benchmarks/design.py aim passive_stiffness@10deg
    python benchmarks/design.py curve muscle 5 10 20 40 60
    python benchmarks/design.py curve muscle-tendon-strain 5 10 20 40 60 120 300
    python benchmarks/design.py nowhere muscle 5 10 20 40 60
    python benchmarks/design.py limits
    python benchmarks/design.py fits 10

All of 35 s on Achilles with torque noise of 0.5 Nm, over legs that no search saw, half of them
patients'. A ratio is to the better of multiple-holds and multi-sine-holds with their chirps, leg by
leg, averaged. Seconds are those of one processor: other work on the computer does not count.
"""

import json
import sys
import tempfile
import time
from collections.abc import Callable, Iterator
from dataclasses import replace
from pathlib import Path

import numpy as np

import surae
from surae.api import designing, ready_trajectory
from surae.planning import genes as genes_module
from surae.planning import search as search_module
from surae.planning.design import Design, _along
from surae.planning.expectation import expected
from surae.planning.information import information, prior_precision
from surae.planning.legs import Legs, population_legs
from surae.planning.plan import held_to_torque
from surae.planning.search import make_aim
from surae.planning.torque import within_torque
from surae.protocol import Device, Protocol, Trajectory, generate, named_device
from surae.recording import write_csv
from surae.studies import virtual_subject, virtual_trial

RATE, NOISE, SECONDS, LEGS = 128.0, 0.5, 35.0, 20
ACHILLES = named_device("achilles")
#: The thesis's two, with their chirps.
THESIS = (("multiple-holds", 0.1), ("multi-sine-holds", 0.2))

#: Of a trajectory: what is compared, one number for each leg.
Errors = Callable[[Trajectory], dict[str, np.ndarray]]


def asked(profile: str, amplitude: float) -> Protocol:
    """A protocol of the thesis."""
    return Protocol(
        profile=profile, chirp_amplitude=amplitude, duration=SECONDS, rate_hz=RATE, device=ACHILLES
    )


def of_all(legs: Legs) -> Errors:
    """Largest error and geometric mean of all parameters."""

    def errors(trajectory: Trajectory) -> dict[str, np.ndarray]:
        relative = expected(trajectory, legs, NOISE).relative
        return {"worst": relative.max(axis=1), "mean": np.exp(np.log(relative).mean(axis=1))}

    return errors


def of_aim(legs: Legs, aim: str) -> Errors:
    """The error of one parameter or measure."""
    slopes = make_aim(aim, legs).slopes

    def errors(trajectory: Trajectory) -> dict[str, np.ndarray]:
        told = information(trajectory, legs, NOISE)
        precision = told.matrices + prior_precision(told.names, legs)
        rows = zip(precision, slopes, legs.estimated, strict=True)
        return {aim: np.array([_along(*row)[0] for row in rows]) ** 0.5}

    return errors


def against(errors: Errors, *, held: bool = False) -> Callable[[Trajectory], dict[str, float]]:
    """Ratios of a trajectory to the better of the thesis's two, as they are or held to 80 Nm."""
    both = []
    for each in THESIS:
        settings = asked(*each)
        both.append(errors(held_to_torque(settings)[0] if held else generate(settings)))
    better = {key: min((b[key] for b in both), key=np.mean) for key in both[0]}

    def ratios(trajectory: Trajectory) -> dict[str, float]:
        mine = errors(trajectory)
        told = {key: round(float((mine[key] / better[key]).mean()), 3) for key in mine}
        percents = {f"{key}_percent": round(100.0 * float(mine[key].mean()), 3) for key in mine}
        theirs = {f"{key}_thesis": round(100.0 * float(better[key].mean()), 3) for key in mine}
        return {**told, **percents, **theirs}

    return ratios


def design(model: str = "muscle", device: Device | None = ACHILLES, **more: object) -> Design:
    """A design as `surae design` makes it."""
    return surae.design(SECONDS, device=device, model=model, noise=NOISE, rate_hz=RATE, **more)


def aim(name: str) -> Iterator[dict[str, object]]:
    """What aiming at one question gains."""
    legs = population_legs("muscle", None, LEGS)
    begun = time.process_time()
    made = design(aim=name)
    seconds = round(time.process_time() - begun, 1)
    for held in (False, True):
        compared = against(of_aim(legs, name), held=held)
        yield {
            "against": "thesis within 80 Nm" if held else "thesis",
            "seconds": seconds,
            "effort": round(float(made.trajectory.effort.sum()), 1),
            **compared(made.trajectory),
        }


class _Noted(search_module._Judge):
    """A judge of plans that notes when it had found what."""

    found: list[tuple[float, int, np.ndarray]]
    genes: genes_module.Genes

    def __init__(self, *arguments: object) -> None:
        super().__init__(*arguments)  # type: ignore[arg-type]
        type(self).found, type(self).genes = [], self._genes
        self._began = time.process_time()

    def __call__(self, x: np.ndarray) -> float:
        before = self.cost
        cost = super().__call__(x)
        if self.cost < before:
            self.found.append((time.process_time() - self._began, self.count, self.best))
        return cost


def curve(model: str, marks: list[float], *, nowhere: bool = False) -> Iterator[dict[str, object]]:
    """How good the best plan is after so many seconds of a search of the usual length, which begins
    with a ready protocol, or with none."""
    if nowhere:
        designing.start_for = lambda *_: None  # type: ignore[assignment]
    legs = population_legs(model, None, LEGS)
    compared = against(of_all(legs))
    search_module._Judge = _Noted  # type: ignore[misc]
    begun = time.process_time()
    made = design(model)
    whole = time.process_time() - begun
    genes, judged = _Noted.genes, population_legs(model, None, 40)
    for mark in [0.0, *marks]:
        known = [each for each in _Noted.found if each[0] <= mark] or _Noted.found[:1]
        _, count, best = known[-1]
        plan, limits, _ = within_torque(genes.plan(best), genes.limits, judged, ACHILLES)
        yield {"seconds": mark, "plans": count, **compared(plan.trajectory(limits, RATE))}
    yield {"whole_s": round(whole, 1), **compared(made.trajectory)}


def limits() -> Iterator[dict[str, object]]:
    """What each limit costs: the search with it, and without."""
    legs = population_legs("muscle", None, LEGS)
    free = replace(ACHILLES, max_torque=float("inf"), max_acceleration=ACHILLES.acceleration_limit)
    budget = genes_module.effort_budget
    whole, held = against(of_all(legs)), against(of_all(legs), held=True)
    cases = {
        "all limits": (ACHILLES, 1.0),
        "torque free": (free, 1.0),
        "torque free, effort three times": (free, 3.0),
        "torque free, 3 rad/s": (replace(free, max_velocity=3.0), 1.0),
    }
    for name, (device, times) in cases.items():
        genes_module.effort_budget = lambda s, times=times: tuple(times * e for e in budget(s))
        made = design(device=device)
        told = {"limits": name, "plans": made.curve[-1][0], **whole(made.trajectory)}
        against_held = {f"held_{key}": held(made.trajectory)[key] for key in ("worst", "mean")}
        yield {**told, **against_held, "torque": [round(t) for t in made.expectation.torque]}
    genes_module.effort_budget = budget


def fits(count: int) -> Iterator[dict[str, object]]:
    """Parameters identified by real fits of noisy trials: designed, and the thesis's two."""
    ready = ready_trajectory("everything-35", ACHILLES, (-0.9, 0.6), RATE)
    trials = {"everything-35": ready} | {name: generate(asked(name, a)) for name, a in THESIS}
    sums = {name: [0, 0.0, 0.0] for name in trials}
    for seed in range(count):
        population = ("healthy", "patient")[seed % 2]
        subject = virtual_subject(200 + seed, population)
        line: dict[str, object] = {"leg": seed, "population": population}
        for name, trajectory in trials.items():
            identified, right, error = fitted(subject, trajectory, seed)
            line[name] = [identified, right]
            for k, value in enumerate((identified, right, error)):
                sums[name][k] += value / count
        yield line
    for name, (identified, right, error) in sums.items():
        yield {
            "protocol": name,
            "identified": round(identified, 2),
            "of_them_within_10_percent": round(right, 2),
            "median_error_percent": round(100.0 * error, 3),
        }


def fitted(subject: object, trajectory: Trajectory, seed: int) -> tuple[int, int, float]:
    """How many parameters a fit calls identified, how many of them are within 10 % of the truth,
    and the median error of all."""
    trial = virtual_trial(subject, trajectory, noise=0.0)
    torque = trial.torque + NOISE * np.random.default_rng(seed).standard_normal(trial.n)
    columns = {
        "time_s": trial.time,
        "angle_rad": trial.angle,
        "torque_Nm": torque,
        "angular_velocity_rad_s": trial.velocity,
        "angular_acceleration_rad_s2": trial.acceleration,
    }
    emg = {f"emg_{m}_V": trial.emg[:, i] for i, m in enumerate(("ta", "gl", "sol", "gm"))}
    with tempfile.TemporaryDirectory() as folder:
        path = Path(folder) / "trial.csv"
        write_csv(path, columns | emg, ["emg: envelope"])
        fit = surae.fit(path, "muscle", prepared=True, starts=2)
    errors = {n: abs(p.value / subject.parameters[n] - 1.0) for n, p in fit.parameters.items()}
    identified = [n for n, p in fit.parameters.items() if p.verdict == "identified"]
    return (
        len(identified),
        sum(errors[n] < 0.1 for n in identified),
        float(np.median(list(errors.values()))),
    )


if __name__ == "__main__":
    what, *rest = sys.argv[1:]
    lines = {
        "aim": lambda: aim(rest[0]),
        "curve": lambda: curve(rest[0], [float(mark) for mark in rest[1:]]),
        "nowhere": lambda: curve(rest[0], [float(mark) for mark in rest[1:]], nowhere=True),
        "limits": limits,
        "fits": lambda: fits(int(rest[0])),
    }[what]()
    for each in lines:
        print(json.dumps(each), flush=True)
