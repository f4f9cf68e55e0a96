"""The models and their tendons: Figures 39 and 45."""

from collections.abc import Mapping, Sequence
from dataclasses import dataclass
from functools import cache
from typing import Any

import numpy as np

import surae
from surae import ModelInputs
from surae.base.units import FloatArray
from surae.model import TendonState
from surae.protocol import generate
from surae.report.figures import GREY, INK, OCHRE, RED
from surae.studies import VirtualSubject, virtual_subject, virtual_trial
from surae_thesis.claims import Ruling, judge_all
from surae_thesis.cohort.members import make_cohort
from surae_thesis.cohort.work import inputs_of
from surae_thesis.legs import protocol
from surae_thesis.plots import Panel, PlotLine, draw
from surae_thesis.section import Context, Drawing, Result

MODEL = "muscle-tendon"
#: The virtual subject whose leg it is: the first; nothing is chosen by it.
SUBJECT = 1
#: The thesis's rates for the muscle-tendon model and for the muscle model [Hz] (4.4).
FINE = 1000.0
COARSE = 125.0
#: Far above both [Hz].
FINEST = 8000.0
SCHEMES = ("implicit", "explicit-euler")
#: Table 2: slack lengths [m], and of both tendons ε0, F̄toe [-], ktoe [-]; Fmax of the triceps [N].
SLACK_TRI = 0.415
SLACK_TIB = 0.216
EPS0 = 0.04
TOE = 0.3
K_TOE = 4.0
F_MAX = 8000.0


@dataclass(frozen=True, slots=True)
class Numbers:
    """RMS error of the torque by scheme, of the torque's RMS; and `toes`; in percent."""

    errors: Mapping[str, float]
    toes: Sequence[tuple[float, float]]


def subject() -> VirtualSubject:
    """Whose leg the section simulates."""
    return virtual_subject(SUBJECT)


@cache
def trial(rate_hz: float, profile: str = "multiple-holds", **which: Any) -> ModelInputs:
    """A trial without noise; by default that on which both schemes are compared."""
    motion = protocol(profile, rate_hz=rate_hz, **which)
    return virtual_trial(subject(), generate(motion), model=MODEL, noise=0.0)


def states(inputs: ModelInputs, scheme: str = "implicit", **options: str) -> TendonState:
    """What muscles and tendons do in a trial."""
    values = subject().truth(MODEL)
    if options.get("tendon_strain") == "slack-length":
        values |= {"dlt_tri": EPS0, "dlt_tib": EPS0}
    return surae.simulate_tendon(MODEL, values, inputs, integrator=scheme, **options)


def torque(inputs: ModelInputs, scheme: str) -> FloatArray:
    """The modelled torque [Nm], shape (n,)."""
    return surae.simulate(MODEL, subject().truth(MODEL), inputs, integrator=scheme)


def errors() -> dict[str, float]:
    """How far each scheme at the muscle model's rate is from the implicit one far above it [%].

    All start from the same EMG: that of the fine trial at the samples of the coarse one.
    """
    exact = trial(FINEST)
    coarse = trial(COARSE)
    reference = torque(exact, "implicit")
    at = np.interp(coarse.time, exact.time, reference)
    scale = np.sqrt(np.mean(reference**2))
    return {
        s: 100 * float(np.sqrt(np.mean((torque(coarse, s) - at) ** 2)) / scale) for s in SCHEMES
    }


def printed_force(length: FloatArray, slack: float = SLACK_TRI) -> FloatArray:
    """Force [N] of the triceps's tendon by equations (18) to (21), letter by letter, shape (n,).

    From its lengths lt and slack length lt0 [m], with ε0 in metres.
    """
    grown = np.exp(K_TOE)
    toe_force = TOE * F_MAX  # (19)
    toe_length = slack + EPS0 * TOE * K_TOE * grown / (
        grown * (1.0 - TOE + TOE * K_TOE) + TOE - 1.0
    )  # (20)
    stiffness = F_MAX / EPS0 * (1.0 - TOE + TOE * K_TOE * grown / (grown - 1.0))  # (21)
    part = np.clip((length - slack) / (toe_length - slack), 0.0, 1.0)
    toe = toe_force / (grown - 1.0) * (np.exp(K_TOE * part) - 1.0)
    force: FloatArray = np.where(
        length > toe_length, stiffness * (length - toe_length) + toe_force, toe
    )  # (18)
    return force


def _taken(state: TendonState) -> list[float]:
    """What the tendon takes of the length change of muscle and tendon, by group [%]."""
    whole = state.muscle_length + state.tendon_length
    taut = np.clip(state.elongation, 0.0, None)
    return [100 * float(np.ptp(taut[row]) / np.ptp(whole[row])) for row in range(2)]


def _passive(strain: str = "thesis") -> list[float]:
    inputs = trial(256.0, "ramp-and-hold", task="passive", amplitude=0.0)
    return _taken(states(inputs, tendon_strain=strain))


def stiff(_: Numbers, much: float, stiffer: float) -> Ruling:
    """What tendons take in the passive ramp and hold [%]: little, or less than the muscles."""
    shares = _passive()
    strain = _passive("slack-length")
    return Ruling(
        max(shares) < much,
        f"triceps {shares[0]:.0f} %, tibialis {shares[1]:.0f} % (with ε0 as a strain "
        f"{strain[0]:.0f} and {strain[1]:.0f} %)",
        less=much <= max(shares) < stiffer,
    )


def slack_length(_: Numbers) -> Ruling:
    """Forces by the printed equations with two slack lengths, and ours."""
    elongation = np.linspace(-0.005, 0.04, 400)
    ours = states(trial(COARSE)).laws[0].force(elongation)
    whole, shorter = (printed_force(s + elongation, s) for s in (SLACK_TRI, 0.5 * SLACK_TRI))
    worst = max(float(np.abs(a - b).max()) for a, b in ((whole, shorter), (whole, ours)))
    worst /= float(ours.max())
    return Ruling(worst < 1e-9, f"largest difference {worst:.0e} of the largest force")


def printed_lengths(_: Numbers) -> Ruling:
    """The room that the printed lengths leave a muscle of its slack length."""
    state = states(trial(COARSE))
    slack = subject().parameters["x0_tri"]
    # "Initial … length combined with the ankle rotation length change": 0.467 − 1.67·(r(θ) − r(0)).
    at_zero = 0.118 - 1.67 * 0.0480  # equations (4) and (9)
    length = 0.467 + state.muscle_length[0] + state.tendon_length[0] - SLACK_TRI - at_zero
    room = float(length.max()) - slack - SLACK_TRI
    return Ruling(
        room > 0.0,
        f"{1e3 * float(length.max()):.0f} mm at most, {1e3 * room:.0f} mm more than tendon and "
        "slack muscle",
    )


def toe(n: Numbers, around: float) -> Ruling:
    """Largest forces over the end of the toe, by subject of the cohort."""
    triceps, tibialis = zip(*n.toes, strict=True)
    below = sum(part < 100.0 for part in tibialis)
    return Ruling(
        max(*triceps, *tibialis) < 100.0 * around,
        f"triceps {min(triceps):.0f} to {max(triceps):.0f} % of Ftoe, tibialis {min(tibialis):.0f} "
        f"to {max(tibialis):.0f} %, below it in {below} of {len(tibialis)} subjects",
    )


def toes(*, quick: bool = False) -> tuple[tuple[float, float], ...]:
    """Largest force of both tendons over the end of their toe in multiple holds, by subject [%]."""
    parts = []
    for who in make_cohort(1)[: 3 if quick else None]:
        values = {**who.subject.parameters, **who.subject.tendons}
        inputs = inputs_of(who, "multiple-holds", 1)
        state = surae.simulate_tendon(MODEL, values, inputs)
        force = state.tendon_force.max(axis=1).tolist()
        triceps, tibialis = (
            100 * most / law.toe_force for most, law in zip(force, state.laws, strict=True)
        )
        parts.append((triceps, tibialis))
    return tuple(parts)


def reversals(speed: FloatArray, rate_hz: float) -> float:
    """How often a speed of shape (n,) changes its sign [1/s]."""
    signs = np.sign(speed[np.abs(speed) > 1e-6])
    return float(np.count_nonzero(np.diff(signs))) * rate_hz / len(speed)


def oscillates(_: Numbers) -> Ruling:
    """Reversals of the triceps's speed by both schemes."""
    speeds = {scheme: states(trial(FINE), scheme).muscle_velocity[0] for scheme in SCHEMES}
    often = {scheme: reversals(speed, FINE) for scheme, speed in speeds.items()}
    peak = {scheme: float(np.nanmax(np.abs(speed))) for scheme, speed in speeds.items()}
    return Ruling(
        often["explicit-euler"] >= 10 * often["implicit"],
        f"{often['explicit-euler']:.0f} reversals/s, up to {peak['explicit-euler']:.2f} m/s; "
        f"implicit {often['implicit']:.1f}/s, up to {peak['implicit']:.2f} m/s",
    )


def coarse_rate(n: Numbers, none: float) -> Ruling:
    """Errors of the torque at the muscle model's rate; those below `none` count as none [%]."""
    implicit, explicit = n.errors.values()
    return Ruling(
        explicit > none, f"at 125 Hz: explicit {explicit:.2g} %, implicit {implicit:.2g} % off"
    )


# Figures and tables


def drawings() -> tuple[Drawing, ...]:
    """Figures 39 and 45."""
    laws = states(trial(COARSE)).laws
    elongation = np.linspace(-0.005, 0.04, 400)
    half = 0.5 * SLACK_TRI
    dot: dict[str, Any] = {"marker": "o", "linestyle": "none", "markersize": 5}
    dashed: dict[str, Any] = {"linewidth": 1.2, "linestyle": (0, (4, 2))}
    without = [
        PlotLine(
            1e3 * elongation,
            laws[0].force(elongation),
            f"slack length {1e3 * SLACK_TRI:g} mm",
            {"color": GREY, "linewidth": 4.0},
        ),
        PlotLine(
            1e3 * elongation, printed_force(half + elongation, half), f"{1e3 * half:g} mm", dashed
        ),
        PlotLine(
            [1e3 * laws[0].toe_elongation],
            [laws[0].toe_force],
            "end of the toe",
            dot | {"color": RED},
        ),
    ]
    inputs = trial(FINE)
    speeds = [
        Panel(
            "Muscle speed\n[m/s]",
            [
                PlotLine(
                    inputs.time,
                    states(inputs, scheme).muscle_velocity[0],
                    "",
                    {"color": colour, "linewidth": 0.7},
                )
            ],
            xlabel,
            f"{said} at {FINE:g} Hz",
            {"xlim": (0.0, inputs.time[-1])},
        )
        for scheme, said, colour, xlabel in (
            ("explicit-euler", "Explicit scheme", OCHRE, ""),
            ("implicit", "Implicit scheme", INK, "Time [s]"),
        )
    ]
    return (
        Drawing(
            "figure-39",
            "Figure 39: tendon force against elongation",
            "Equations (18) to (21) with ε0 in metres: the slack length, once subtracted, changes "
            "nothing.",
            "Two curves that coincide: no force when slack, a curved toe, then a straight line.",
            draw(
                [
                    Panel(
                        "Tendon force [N]",
                        without,
                        "Elongation, length less slack length [mm]",
                        "Triceps surae",
                        legend=3,
                    )
                ],
                3.4,
            ),
        ),
        Drawing(
            "figure-45",
            "Figure 45: rate of length change of the triceps",
            "The same trial of the same subject by both integrators. The explicit one, the "
            "thesis's, chatters between the clamps ±vmax wherever the muscle is hardly active.",
            "Above, a dense band of oscillation between the clamps; below, a smooth speed.",
            draw(speeds, 4.6, sharex=True, sharey=True),
        ),
    )


def run(context: Context) -> Result:
    """Integrate one trial both ways, judge and draw."""
    context.progress("tendons", 0, 1)
    numbers = Numbers(errors(), toes(quick=context.quick))
    return Result(
        findings=judge_all("tendons", {"": numbers}, __name__),
        figures=drawings(),
        notes=(
            "Both integrators solve the same equations (18) to (30) on the same trial of a typical "
            "healthy subject: multiple holds with a chirp of 0.2 rad and factor 0.5, part-passive. "
            "The tendon's strain ε0 is in metres, as the printed equations take it.",
        ),
    )
