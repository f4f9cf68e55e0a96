"""Every rule of the simulation study on made-up grids that obey the thesis, and that do not."""

from dataclasses import replace
from itertools import product

import pytest

from surae.reproduction.simulation import choice, dependency, goodness, precision
from surae.reproduction.simulation.cells import Cell, NoFitError, TorqueSize, cells, scores, select
from surae.reproduction.simulation.designs import AMPLITUDES, MODELS, PROFILES, TASKS
from surae.reproduction.simulation.torques import at_equal_noise

NAMES = ("m", "k_tri", "tau_rel", "k_rel", "g1")
GRID_RATES = (0.05, 0.1, 0.2, 0.35, 0.5, 0.6)
#: SEM by profile as the thesis's Figures 13 and 14 rank them.
RANKS = {
    "muscle": dict(zip(PROFILES, (5.0, 4.0, 1.0, 2.0, 3.0), strict=True)),
    "muscle-tendon": dict(zip(PROFILES, (5.0, 1.0, 4.0, 2.0, 3.0), strict=True)),
}
IPDE = {
    "muscle": dict(zip(PROFILES, (2.75, 2.60, 2.78, 2.64, 2.71), strict=True)),
    "muscle-tendon": dict(zip(PROFILES, (3.80, 3.45, 3.90, 3.44, 3.46), strict=True)),
}


def thesis_sem(place: dict, name: str) -> float:
    """As the thesis's figures have it."""
    amplitude, rate = place["amplitude"], place["rate"] or 0.0
    value = RANKS[place["model"]][place["profile"]]
    if name in ("tau_rel", "k_rel"):
        if place["model"] == "muscle":
            value *= 1.0 + abs(amplitude - 0.1) + (0.1 if 0.0 < rate < 0.2 else 0.0)
    else:
        value /= 1.0 + 3.0 * amplitude * (0.1 + rate) * (3.0 if name == "m" else 1.0)
    if place["model"] == "muscle-tendon" and amplitude == 0.3:
        value *= 3.0
    return value * (1.5 if place["task"] == "active" else 1.0)


def thesis_ipde(place: dict) -> float:
    away = abs((place["rate"] or 0.0) - 0.5) + 2.0 * (0.2 - place["amplitude"])
    task = 0.1 if place["task"] == "active" else 0.0
    return IPDE[place["model"]][place["profile"]] + away + task


def thesis_vaf(place: dict) -> float:
    if place["model"] == "muscle":
        return 99.91
    fails = place["amplitude"] == 0.3 or place["profile"] == "multi-sine"
    return 99.5 if fails else 99.89


def thesis_off(place: dict) -> float:
    return 0.2 if thesis_vaf(place) < 99.85 else 0.05


def grid(sem=thesis_sem, ipde=thesis_ipde, vaf=thesis_vaf, off=thesis_off, subjects=(1,)):
    found = []
    for model, profile, task, amplitude, rate, subject in product(
        MODELS, PROFILES, TASKS, AMPLITUDES, GRID_RATES, subjects
    ):
        if amplitude == 0.0 and rate != GRID_RATES[0]:
            continue
        place = {
            "model": model, "profile": profile, "task": task, "amplitude": amplitude,
            "rate": rate if amplitude else None, "subject": subject,
        }  # fmt: skip
        found.append(
            Cell(
                **place, repeat=1, vaf=vaf(place), ipde=ipde(place),
                sem={name: sem(place, name) for name in NAMES},
                off={name: off(place) if name == "g1" else 0.0 for name in NAMES},
                truth={"l0_tri": 0.045, "l0_tib": 0.08},
                torque=TorqueSize(10.0, 8.0, 12.0),
            )
        )  # fmt: skip
    return tuple(found)


def of_model(model, value):
    """The thesis's SEM, but for one model."""
    return lambda place, name: (
        value(place, name) if place["model"] == model else thesis_sem(place, name)
    )


def verdicts(findings) -> dict[str, str]:
    return {one.claim.name: one.verdict for one in findings}


def everything(found) -> dict[str, str]:
    passive = select(found, task="part-passive")
    return verdicts(
        [
            goodness.muscle_vaf(found),
            goodness.tendon_vaf(found),
            goodness.threshold(found),
            *goodness.failures(found, [(125, passive)]),
            precision.task(found),
            dependency.task(found),
            *precision.rates(found),
            *precision.amplitudes(found, passive),
            *precision.profiles(found, passive),
            *dependency.values(found, passive),
            *dependency.chirp(found),
            *choice.chosen(found),
        ]
    )


def test_a_grid_as_the_thesis_describes_it_makes_every_claim_hold() -> None:
    assert {name for name, verdict in everything(grid()).items() if verdict != "holds"} == set()


SPOILT = [
    ("vaf-muscle", {"vaf": lambda _: 99.80}),
    ("vaf-tendon", {"vaf": lambda _: 99.99}),
    ("vaf-tendon", {"vaf": lambda _: 99.0}),
    ("vaf-threshold", {"off": lambda _: 0.05}),
    ("tendon-fails-at-large-chirp", {"vaf": lambda _: 99.9}),
    ("tendon-fails-at-multi-sine", {"vaf": lambda _: 99.9}),
    ("task-sem", {"sem": lambda _, __: 1.0}),
    ("task-ipde", {"ipde": lambda _: 3.0}),
    ("rate-sem", {"sem": of_model("muscle", lambda _, __: 1.0)}),
    ("rate-sem-tendon", {"sem": of_model("muscle-tendon", lambda _, __: 1.0)}),
    ("rate-relaxation", {"sem": lambda place, __: place["rate"] or 1.0}),
    ("amplitude-sem", {"sem": lambda place, __: 1.0 + place["amplitude"]}),
    ("amplitude-relaxation", {"sem": lambda place, __: 1.0 + place["amplitude"]}),
    ("amplitude-sem-tendon", {"sem": lambda place, __: 1.0 + place["amplitude"]}),
    ("profile-sem", {"sem": lambda place, __: 9.0 - RANKS[place["model"]][place["profile"]]}),
    (
        "profile-sem-tendon",
        {"sem": lambda place, __: 9.0 - RANKS[place["model"]][place["profile"]]},
    ),
    ("ipde-values", {"ipde": lambda _: 2.2}),
    ("ipde-ranking", {"ipde": lambda place: 6.0 - IPDE[place["model"]][place["profile"]]}),
    ("ipde-rate", {"ipde": lambda place: 3.0 - (place["rate"] or 0.0) * -1.0}),
    ("ipde-amplitude", {"ipde": lambda place: 3.0 + place["amplitude"]}),
    ("ipde-tendon", {"ipde": lambda _: 3.0}),
    ("ipde-tendon-values", {"ipde": lambda _: 3.0}),
    ("ipde-tendon-rate", {"ipde": lambda place: 3.0 + (place["rate"] or 0.0)}),
    ("ipde-tendon-amplitude", {"ipde": lambda place: 3.0 + place["amplitude"]}),
    ("chosen-profiles", {"ipde": lambda place: 6.0 - IPDE[place["model"]][place["profile"]]}),
    ("chosen-chirp", {"sem": lambda place, __: 1.0 + place["amplitude"]}),
    ("chosen-task", {"sem": lambda place, __: 2.0 - (place["task"] == "active")}),
]


@pytest.mark.parametrize(("name", "spoilt"), SPOILT)
def test_each_claim_differs_where_the_grid_does(name, spoilt) -> None:
    assert everything(grid(**spoilt))[name] == "differs"


def noisy(vaf=0.0, sem=0.0, ipde=0.0):
    """Five repeats, the last of which is off by so much."""
    return [
        Cell(
            model="muscle", profile="sine", task="part-passive", amplitude=0.1, rate=rate,
            subject=1, repeat=repeat, vaf=99.9 + vaf * (repeat == 5),
            ipde=2.6 + ipde * (repeat == 5), sem={"k_tri": 1.0 + sem * (repeat == 5)},
            off={"k_tri": 0.0}, truth={"k_tri": 1.0},
        )
        for rate in (0.3, 0.6)
        for repeat in range(1, 6)
    ]  # fmt: skip


def test_noise_holds_below_the_thesis_spread_and_differs_above() -> None:
    assert set(verdicts(goodness.noise(noisy(0.005, 0.03, 0.01))).values()) == {"holds"}
    assert set(verdicts(goodness.noise(noisy(0.007, 0.05, 0.03))).values()) == {"differs"}


def test_patients_follow_the_healthy_or_do_not() -> None:
    healthy = select(grid(), task="part-passive")
    assert verdicts(choice.patients(healthy, healthy)) == {
        "patient-profiles": "holds",
        "patient-amplitude": "holds",
        "patient-rate": "holds",
        "patient-ipde": "holds",
    }
    other = grid(
        sem=lambda place, __: 1.0 + place["amplitude"] + (place["rate"] or 0.0),
        ipde=lambda place: float(PROFILES.index(place["profile"])),
    )
    assert set(verdicts(choice.patients(healthy, other)).values()) == {"differs"}


def test_the_fastest_rate_depends_on_the_optimal_length() -> None:
    slow = {"l0_tri": 0.045, "l0_tib": 0.08}
    rates = (0.1, 0.6, 9.0)
    assert choice.fastest_rate("sine", 0.5, slow, rates) == 0.6
    assert choice.fastest_rate("sine", 0.1, {"l0_tri": 1e-3, "l0_tib": 1e-3}, rates) is None
    assert choice.speed({"l0_tri": 1.0, "l0_tib": 1.0}, (0.1, 0.2)).verdict == "differs"
    just = {
        name: value * 0.6 / 0.475 for name, value in {"l0_tri": 0.0475, "l0_tib": 0.0725}.items()
    }
    rates = tuple(round(0.05 * k, 2) for k in range(8, 16))
    found = {profile: choice.fastest_rate(profile, 0.2, just, rates) for profile in choice.CHOSEN}
    finding = choice.speed(just, rates)
    near = all(rate is not None and 0.55 <= rate <= 0.65 for rate in found.values())
    assert finding.verdict == ("holds" if near else "differs")
    assert all(f"{profile} {rate:g} Hz/s" in finding.ours for profile, rate in found.items())


def test_equal_noise_divides_by_what_was_added() -> None:
    def noisier(place, name):
        return thesis_sem(place, name) * (1.0 + 9.0 * place["amplitude"] * (place["rate"] or 0.0))

    def sized(found):
        return tuple(
            replace(
                one,
                torque=TorqueSize(
                    10.0 * (1.0 + 9.0 * one.amplitude * (one.rate or 0.0)), 4.0, 20.0
                ),
            )
            for one in found
        )

    found = sized(grid(sem=noisier))
    finding = precision.rates(found)[0]
    assert finding.verdict == "differs"
    assert "At equal noise in every cell it holds" in finding.reason
    assert "10 to 10 Nm without chirp to 23 to 23 Nm" in finding.reason
    plain = sized(grid())
    expected = {name: value / 0.5 for name, value in plain[0].sem.items()}
    assert at_equal_noise(plain)[0].sem == pytest.approx(expected)


def test_a_claim_without_its_cells_says_so() -> None:
    with pytest.raises(NoFitError, match="muscle-tendon model with multiple-holds"):
        precision.rates(select(grid(), model="muscle"))
    with pytest.raises(NoFitError):
        precision.task(select(grid(), task="active"))
    with pytest.raises(NoFitError):
        goodness.noise([])


def test_rows_become_cells_once_without_failed_ones() -> None:
    row = {
        "model": "muscle", "protocol": "sine", "task": "active", "chirp_amplitude": 0.0,
        "chirp_factor": 0.1, "subject": 1, "repeat": 1, "status": "converged", "vaf": 99.0,
        "ipde": None, "m": 1.0, "m_sem": None, "m_true": 2.0, "dlt_tri": None,
        "dlt_tri_sem": None, "dlt_tri_true": None,
    }  # fmt: skip
    failed = row | {"status": "failed", "vaf": None, "task": "part-passive"}
    (cell,) = cells([row, row | {"chirp_factor": 0.2}, failed])
    assert (cell.rate, cell.sem, cell.off, cell.worst) == (None, {}, {"m": -0.5}, ("m", 0.5))


def test_scores_leave_out_what_no_cell_could_tell() -> None:
    some = list(select(grid(), model="muscle", task="active", amplitude=0.0))[:2]
    expected = scores(some)
    some[0] = replace(some[0], sem={k: v for k, v in some[0].sem.items() if k != "m"})
    assert scores(some)[0] == pytest.approx(expected[0], rel=0.3)
    assert scores([replace(one, sem=dict(one.sem)) for one in some]).shape == (2,)
