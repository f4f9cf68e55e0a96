"""The models and their tendons: Tables 1 and 2, Figures 10, 39, 44 and 45."""

from collections.abc import Mapping, Sequence
from dataclasses import dataclass
from functools import cache
from typing import Any

import numpy as np

import surae
from surae import ModelInputs
from surae.model import MODELS, TendonState
from surae.protocol import Protocol, chirp_rate, generate
from surae.report.figures import BLUE, GREY, INK, MUTED, OCHRE, RED, Figure, new_figure
from surae.studies import VirtualSubject, virtual_subject, virtual_trial
from surae.units import FloatArray
from surae_thesis.claims import Claim, Ruling, judge_all
from surae_thesis.cohort.members import make_cohort
from surae_thesis.cohort.trials import cohort_inputs
from surae_thesis.plots import Panel, PlotLine, draw
from surae_thesis.section import Context, Drawing, Result, Table

MODEL = "muscle-tendon"
#: The virtual subject whose leg it is: the first; nothing is chosen by it.
SUBJECT = 1
#: The thesis's rates for the muscle-tendon model and for the muscle model [Hz] (4.4).
FINE, COARSE = 1000.0, 125.0
#: Rates at which both schemes are tried, and far above them [Hz].
RATES, FINEST = (125.0, 256.0, 512.0, 1000.0, 2000.0), 8000.0
SCHEMES = ("implicit", "explicit-euler")
#: Table 2: slack lengths [m], and of both tendons ε0, F̄toe [-], ktoe [-]; Fmax of the triceps [N].
SLACK_TRI, SLACK_TIB = 0.415, 0.216
EPS0, TOE, K_TOE, F_MAX = 0.04, 0.3, 4.0, 8000.0


@dataclass(frozen=True, slots=True)
class Numbers:
    """RMS error of the torque by scheme and rate, of the torque's RMS; and `toes`; in percent."""

    errors: Mapping[tuple[str, float], float]
    toes: Sequence[tuple[float, float]]


def subject() -> VirtualSubject:
    """Whose leg the section simulates."""
    return virtual_subject(SUBJECT)


@cache
def trial(
    rate_hz: float,
    profile: str = "multiple-holds",
    amplitude: float = 0.2,
    task: str = "part-passive",
) -> ModelInputs:
    """A trial without noise; by default that on which both schemes are compared."""
    motion = Protocol(
        profile=profile,
        task=task,
        chirp_amplitude=amplitude,
        chirp_rate=chirp_rate(0.5),
        rate_hz=rate_hz,
    )
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


def errors(*, quick: bool = False) -> dict[tuple[str, float], float]:
    """How far each scheme at each rate is from the implicit one at a rate far above.

    All start from the same EMG: that of the fine trial at the samples of the coarse one.
    """
    exact = trial(FINEST)
    reference = torque(exact, "implicit")
    scale = float(np.sqrt(np.mean(reference**2)))
    off = {}
    for rate in RATES[::2] if quick else RATES:
        inputs = trial(rate)
        at = np.interp(inputs.time, exact.time, reference)
        for scheme in SCHEMES:
            apart = torque(inputs, scheme) - at
            off[scheme, rate] = 100 * float(np.sqrt(np.mean(apart**2))) / scale
    return off


def printed_force(
    length: FloatArray, slack: float = SLACK_TRI, *, strain: bool = False
) -> FloatArray:
    """Force [N] of the triceps's tendon by equations (18) to (21), letter by letter, shape (n,).

    From its lengths lt and slack length lt0 [m]; with ε0 as a strain of that (Thelen 2003), while
    as printed it is in metres.
    """
    eps0 = EPS0 * slack if strain else EPS0
    grown = np.exp(K_TOE)
    toe_force = TOE * F_MAX  # (19)
    toe_length = slack + eps0 * TOE * K_TOE * grown / (
        grown * (1.0 - TOE + TOE * K_TOE) + TOE - 1.0
    )  # (20)
    stiffness = F_MAX / eps0 * (1.0 - TOE + TOE * K_TOE * grown / (grown - 1.0))  # (21)
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
    inputs = trial(256.0, "ramp-and-hold", 0.0, "passive")
    return _taken(states(inputs, tendon_strain=strain))


def stiff(_: Numbers) -> Ruling:
    """What tendons take in the passive ramp and hold."""
    shares = _passive()
    return Ruling(max(shares) < 10.0, f"triceps {shares[0]:.0f} %, tibialis {shares[1]:.0f} %")


def stiff_as_strain(_: Numbers, __: Claim) -> str:
    """The same with ε0 as a strain."""
    triceps, tibialis = _passive("slack-length")
    return (
        "With ε0 in metres, 4 cm at the largest force, the printed tendons give way at small "
        "forces. With Table 2's 0.04 as what it is called, a strain of the slack length, they take "
        f"{triceps:.0f} and {tibialis:.0f} %."
    )


def slack_length(_: Numbers) -> Ruling:
    """Forces by the printed equations with two slack lengths, and ours."""
    elongation = np.linspace(-0.005, 0.04, 400)
    ours = states(trial(COARSE)).laws[0].force(elongation)
    whole, shorter = (printed_force(s + elongation, s) for s in (SLACK_TRI, 0.5 * SLACK_TRI))
    worst = max(float(np.abs(a - b).max()) for a, b in ((whole, shorter), (whole, ours)))
    worst /= float(ours.max())
    return Ruling(worst < 1e-9, f"largest difference {worst:.0e} of the largest force")


def slack_length_as_strain(_: Numbers, __: Claim) -> str:
    """The same with ε0 as a strain."""
    whole, half = (
        printed_force(np.array([s + 0.01]), s, strain=True)[0] for s in (SLACK_TRI, 0.5 * SLACK_TRI)
    )
    return (
        "It cancels in the printed equations, which take ε0 in metres: so did the thesis's code. "
        "Where ε0 is a strain (--tendon-strain slack-length, Thelen 2003), half the slack length "
        f"multiplies the force at 1 cm by {half / whole:.1f}."
    )


def _longest() -> float:
    """Longest that muscle and tendon of the triceps are by the printed (23) [m]."""
    # x = 0.118 − 1.67 r by equation (9): what the printed (23) subtracts from 0.467 is 1.67 r.
    lengths = states(trial(COARSE)).muscle_length[0] + states(trial(COARSE)).tendon_length[0]
    return float((0.467 - (0.118 - (lengths - SLACK_TRI))).max())


def printed_lengths(_: Numbers) -> Ruling:
    """The room that the printed lengths leave."""
    room = _longest() - subject().parameters["x0_tri"] - SLACK_TRI
    return Ruling(
        room > 0.0,
        f"at most {1e3 * _longest():.0f} mm, of which the tendon alone takes "
        f"{1e3 * SLACK_TRI:.0f} mm",
    )


def toe(n: Numbers) -> Ruling:
    """Largest forces over the end of the toe, by subject of the cohort."""
    triceps, tibialis = zip(*n.toes, strict=True)
    below = sum(part < 100.0 for part in tibialis)
    return Ruling(
        max(*triceps, *tibialis) < 100.0,
        f"triceps {min(triceps):.0f} to {max(triceps):.0f} % of Ftoe, tibialis {min(tibialis):.0f} "
        f"to {max(tibialis):.0f} %, below it in {below} of {len(tibialis)} subjects",
    )


def toes(*, quick: bool = False) -> tuple[tuple[float, float], ...]:
    """Largest force of both tendons over the end of their toe in multiple holds, by subject [%]."""
    parts = []
    for who in make_cohort(1)[: 3 if quick else None]:
        values = {**who.subject.parameters, **who.subject.tendons}
        inputs = cohort_inputs(who, "multiple-holds", 1)
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
    explicit, implicit = (n.errors[scheme, COARSE] for scheme in ("explicit-euler", "implicit"))
    return Ruling(
        explicit > none, f"at 125 Hz: explicit {explicit:.2g} %, implicit {implicit:.2g} % off"
    )


# Figures and tables

#: Figure 10: where a model stands, what it changes, and below which.
_TREE = {
    "muscle": (0.5, 0.87, "rigid tendons", ""),
    "muscle-tendon": (0.5, 0.5, "compliant tendons", "muscle"),
    "muscle-tendon-strain": (0.25, 0.13, "tendon strain ε0 free", "muscle-tendon"),
    "muscle-tendon-toe": (0.75, 0.13, "tendon toe force free", "muscle-tendon"),
}


def _tree() -> Figure:
    figure = new_figure(3.6)
    axes = figure.add_subplot()
    axes.axis("off")
    for name, (x, y, said, above) in _TREE.items():
        spec = MODELS[name]
        number = spec.title[spec.title.index("[") :]
        axes.text(
            x, y, f"{name} {number}\n{said}, {len(spec.free)} parameters", ha="center",
            va="center", fontsize=9, color=INK,
            bbox={"boxstyle": "round,pad=0.8", "facecolor": "white", "edgecolor": INK},
        )  # fmt: skip
        if above:
            axes.annotate(
                "", xy=(x, y + 0.115), xytext=(_TREE[above][0], _TREE[above][1] - 0.115),
                arrowprops={"arrowstyle": "-|>", "color": MUTED, "linewidth": 1.1},
            )  # fmt: skip
    return figure


def drawings() -> tuple[Drawing, ...]:
    """Figures 10, 39, 44 and 45."""
    laws = states(trial(COARSE)).laws
    elongation, half = np.linspace(-0.005, 0.04, 400), 0.5 * SLACK_TRI
    dot: dict[str, Any] = {"marker": "o", "linestyle": "none", "markersize": 5}
    dashed: dict[str, Any] = {"linewidth": 1.2, "linestyle": (0, (4, 2))}
    without = [
        PlotLine(1e3 * elongation, laws[0].force(elongation),
             f"slack length {1e3 * SLACK_TRI:g} mm", {"color": GREY, "linewidth": 4.0}),
        PlotLine(1e3 * elongation, printed_force(half + elongation, half), f"{1e3 * half:g} mm",
             dashed),
        PlotLine([1e3 * laws[0].toe_elongation], [laws[0].toe_force], "end of the toe",
             dot | {"color": RED}),
    ]  # fmt: skip
    both = []
    looks: tuple[dict[str, Any], ...] = ({"color": INK}, dashed | {"color": BLUE})
    for law, slack, look, label in zip(
        laws, (SLACK_TRI, SLACK_TIB), looks, ("triceps surae", "tibialis anterior"),
        strict=True,
    ):  # fmt: skip
        length = np.concatenate([[0.0], slack + np.linspace(0.0, 0.04, 400)])
        toe = slack + law.toe_elongation
        both += [PlotLine(length, law.force(length - slack), label, look),
                 PlotLine([toe], [law.toe_force], "", dot | {"color": look["color"]})]  # fmt: skip
    inputs = trial(FINE)
    speeds = [
        Panel("Muscle speed\n[m/s]",
              [PlotLine(inputs.time, states(inputs, scheme).muscle_velocity[0], "",
                    {"color": colour, "linewidth": 0.7})], xlabel, f"{said} at {FINE:g} Hz",
              {"xlim": (0.0, inputs.time[-1])})
        for scheme, said, colour, xlabel in (
            ("explicit-euler", "Explicit scheme", OCHRE, ""),
            ("implicit", "Implicit scheme", INK, "Time [s]"),
        )
    ]  # fmt: skip
    return (
        Drawing("figure-10", "Figure 10: the tree of models",
            "Every step down changes one thing. 2.0, 2.1 and 2.2 are one model with other "
            "parameters freed.",
            "The muscle model, below it the muscle-tendon model, below that its two variants.",
            _tree()),
        Drawing("figure-39", "Figure 39: tendon force against elongation",
            "Equations (18) to (21) with ε0 in metres: the slack length, once subtracted, changes "
            "nothing.",
            "Two curves that coincide: no force when slack, a curved toe, then a straight line.",
            draw([Panel("Tendon force [N]", without,
                        "Elongation, length less slack length [mm]", "Triceps surae",
                        legend=3)], 3.4)),
        Drawing("figure-44", "Figure 44: tendon force against length",
            "No force up to the slack length, then a non-linear toe and a straight line.",
            "Two curves, flat at zero and then rising steeply, one at 0.216 m, one at 0.415 m.",
            draw([Panel("Tendon force [N]", both, "Tendon length [m]",
                        "Both tendons of Table 2; dots: end of the toe",
                        {"xlim": (0.0, 0.5), "ylim": (-100.0, 8000.0)}, legend=2)], 3.4)),
        Drawing("figure-45", "Figure 45: rate of length change of the triceps",
            "The same trial of the same subject by both integrators. The explicit one, the "
            "thesis's, chatters between the clamps ±vmax wherever the muscle is hardly active.",
            "Above, a dense band of oscillation between the clamps; below, a smooth speed.",
            draw(speeds, 4.6, sharex=True, sharey=True)),
    )  # fmt: skip


def _parameters(name: str, title: str, model: str) -> Table:
    return Table(
        name=name,
        title=title,
        columns=("parameter", "unit", "meaning", "part", "start", "lower", "upper"),
        rows=tuple(
            (p.name, p.unit, p.meaning, p.group, p.start, p.lower, p.upper)
            for p in MODELS[model].parameters
        ),
    )


def _tendons() -> Table:
    start = {p.name: p.start for p in MODELS[MODEL].parameters}
    return Table(
        name="table-2",
        title="Table 2: the tendons",
        columns=("parameter", "unit", "triceps surae", "tibialis anterior"),
        rows=(
            ("lt0", "m", SLACK_TRI, SLACK_TIB),
            *(
                (symbol, unit, start[f"{name}_tri"], start[f"{name}_tib"])
                for symbol, unit, name in (
                    ("ε0", "m", "dlt"), ("Fmax", "N", "fmax"), ("F̄toe", "-", "pt"),
                    ("ktoe", "-", "kt"),
                )
            ),
        ),
    )  # fmt: skip


def run(context: Context) -> Result:
    """Tabulate the parameters, integrate one trial both ways, judge and draw."""
    context.progress("tendons", 0, 1)
    numbers = Numbers(errors(quick=context.quick), toes(quick=context.quick))
    return Result(
        findings=judge_all("tendons", {"": numbers}, __name__),
        figures=drawings(),
        tables=(
            _parameters("table-1-left", "Table 1, left: the model of 2010", "muscle-2010"),
            _parameters("table-1-right", "Table 1, right: the muscle model [1.0]", "muscle"),
            _tendons(),
            Table(
                name="integrators",
                title=f"Torque of one chirped trial against the implicit scheme at {FINEST:g} Hz",
                columns=("rate [Hz]", "scheme", "RMS error [% of the torque's RMS]"),
                rows=tuple(
                    (rate, scheme, round(off, 4)) for (scheme, rate), off in numbers.errors.items()
                ),
            ),
        ),
        notes=(
            "Both integrators solve the same equations (18) to (30) on the same trial of a typical "
            "healthy subject: multiple holds with a chirp of 0.2 rad and factor 0.5, part-passive. "
            "The tendon's strain ε0 is in metres, as the printed equations take it.",
        ),
    )
