"""What the thesis says of tendons and of their integration, each claim computed."""

import numpy as np

from surae.model import ModelOptions, TendonState
from surae.model.geometry import paths
from surae.model.tendon import SLACK_TRI
from surae.reproduction.claims import Claim, Finding, judged
from surae.reproduction.tendons.printed import printed_force
from surae.reproduction.tendons.trials import (
    Errors,
    chirped,
    states,
    subject,
    torque,
    trial,
)
from surae.units import FloatArray

#: The thesis's rates for the muscle-tendon model and for the muscle model [Hz] (4.4).
FINE, COARSE = 1000.0, 125.0
#: ε0 of Table 2 as a strain.
FOUR_PERCENT = {"dlt_tri": 0.04, "dlt_tib": 0.04}
#: An error of the torque below this counts as none [% of its RMS].
_NONE = 0.5


def findings(measured: Errors) -> tuple[Finding, ...]:
    """All of them."""
    return (_stiff(), _slack_length(), _printed(), _toe(), _oscillates(), _rate(measured))


def _stiff() -> Finding:
    claim = Claim(
        name="passive-tendon-stiff",
        source="2.4",
        text="During passive tasks the tendon is much stiffer than the passive muscle.",
        number="no number",
        rule="in passive ramp and hold the tendons take less than 10 % of the length change",
    )
    inputs = trial(256.0, "ramp-and-hold", 0.0, "passive")
    shares = _taken(states(inputs, "implicit"))
    strict = _taken(states(inputs, "implicit", tendon_strain="slack-length", **FOUR_PERCENT))
    return judged(
        claim,
        max(shares) < 10.0,
        f"triceps {shares[0]:.0f} %, tibialis {shares[1]:.0f} %",
        why="With ε0 in metres, 4 cm at the largest force, and a soft toe the printed tendons give "
        "way at small forces. With Table 2's 0.04 as a strain of the slack length they would take "
        f"{strict[0]:.0f} and {strict[1]:.0f} %.",
    )


def _taken(state: TendonState) -> list[float]:
    """What the tendon takes of the length change of muscle and tendon, by group [%]."""
    whole = state.muscle_length + state.tendon_length
    taut = np.clip(state.elongation, 0.0, None)
    return [100 * float(np.ptp(taut[row]) / np.ptp(whole[row])) for row in range(2)]


def _slack_length() -> Finding:
    claim = Claim(
        name="slack-length-irrelevant",
        source="4.3, Figure 39",
        text="The slack length does not affect the tendon's force once it is subtracted.",
        number="one curve for two slack lengths",
        rule="over the elongation, the printed equations give the same force with the triceps's "
        "slack length, with half of it, and in our model: within 1e-9 of the largest",
    )
    elongation = np.linspace(-0.005, 0.04, 400)
    ours = states(chirped(COARSE), "implicit").laws[0].force(elongation)
    half = 0.5 * SLACK_TRI
    whole, shorter = (printed_force(slack + elongation, slack) for slack in (SLACK_TRI, half))
    worst = max(float(np.abs(a - b).max()) for a, b in ((whole, shorter), (whole, ours)))
    worst /= float(ours.max())
    at = np.array([0.01])
    by_strain = [printed_force(slack + at, slack, strain=True)[0] for slack in (SLACK_TRI, half)]
    return judged(
        claim,
        worst < 1e-9,
        f"largest difference {worst:.0e} of the largest force",
        why="The curve depends on the slack length.",
        remark="It cancels in the printed equations, which take ε0 in metres. Where ε0 is a "
        "strain (`--tendon-strain slack-length`, Thelen 2003), half the slack length multiplies "
        f"the force at 1 cm by {by_strain[1] / by_strain[0]:.1f}.",
        figure="figure-39",
    )


def _printed() -> Finding:
    claim = Claim(
        name="printed-initial-lengths",
        source="2.4, equations (23) and (24)",
        text="Muscle and tendon together are 0.467 m (triceps) and 0.291 m (tibialis) less the "
        "arm's share.",
        number="0.467 m, 0.291 m",
        rule="with these lengths and a muscle at least as long as its slack length, the triceps's "
        "tendon is taut somewhere in the range of motion",
    )
    angle = np.linspace(-0.9, 0.6, 301)
    triceps, _ = paths(angle=angle, velocity=np.zeros_like(angle), options=ModelOptions())
    # x = 0.118 − 1.67 r by equation (9): what the printed (23) subtracts from 0.467 is 1.67 r.
    longest = float((0.467 - (0.118 - triceps.length)).max())
    muscle = subject().parameters["x0_tri"]
    room = longest - muscle - SLACK_TRI
    return judged(
        claim,
        room > 0.0,
        f"at most {1e3 * longest:.0f} mm, of which the tendon alone takes {1e3 * SLACK_TRI:.0f} mm",
        why="The arm is subtracted twice: 0.467 = 0.415 + 0.052 contains the muscle at the neutral "
        f"arm already, and {1e3 * longest:.0f} mm leave no room for any muscle. We use "
        "lmt(θ) = lt0 + x(θ) of equation (9).",
    )


def _toe() -> Finding:
    claim = Claim(
        name="toe-region",
        source="2.6 and 4.2",
        text="The forces of the trials lie in the tendon's non-linear toe region.",
        number="no number",
        rule="in the chirped trial, with torques near 80 Nm, both tendons stay below Ftoe",
    )
    inputs = chirped(256.0)
    state, largest = states(inputs, "implicit"), float(np.abs(torque(inputs, "implicit")).max())
    parts = [100 * float(state.tendon_force[row].max()) / state.laws[row].toe_force
             for row in range(2)]  # fmt: skip
    return judged(
        claim,
        max(parts) < 100.0,
        f"triceps up to {parts[0]:.0f} %, tibialis {parts[1]:.0f} % of Ftoe, at torques to "
        f"{largest:.0f} Nm",
        why="Ftoe is 0.3·Fmax: 2,400 N of the triceps but 420 N of the tibialis, whose tendon goes "
        "beyond it in hard dorsiflexion.",
        figure="figure-44",
    )


def reversals(speed: FloatArray, rate_hz: float) -> float:
    """How often a speed of shape (n,) changes its sign [1/s]."""
    signs = np.sign(speed[np.abs(speed) > 1e-6])
    return float(np.count_nonzero(np.diff(signs))) * rate_hz / len(speed)


def _oscillates() -> Finding:
    claim = Claim(
        name="explicit-oscillates",
        source="appendix B, Figure 45",
        text="Integrated step by step at 1000 Hz, the triceps's speed oscillates.",
        number="±0.5 m/s",
        rule="it changes sign at least ten times as often as by the implicit scheme at that rate",
    )
    speeds = {
        s: states(chirped(FINE), s).muscle_velocity[0] for s in ("explicit-euler", "implicit")
    }
    often = {scheme: reversals(v, FINE) for scheme, v in speeds.items()}
    peak = {scheme: float(np.nanmax(np.abs(v))) for scheme, v in speeds.items()}
    return judged(
        claim,
        often["explicit-euler"] >= 10 * often["implicit"],
        f"{often['explicit-euler']:.0f} reversals/s, up to {peak['explicit-euler']:.2f} m/s; "
        f"implicit {often['implicit']:.1f}/s, up to {peak['implicit']:.2f} m/s",
        why="The explicit scheme chatters where the muscle is hardly active, in this trial less "
        "often than the rule asks.",
        remark="It divides by the active state and chatters between its clamps while the muscle is "
        "hardly active; solved implicitly, the same equations need no clamp.",
        figure="figure-45",
    )


def _rate(measured: Errors) -> Finding:
    claim = Claim(
        name="muscle-model-rate",
        source="4.4 and 4.5, future work",
        text="The muscle-tendon model needs 1000 Hz where the muscle model needs 125 Hz; to run it "
        "at that rate is left as future work.",
        number="1000 Hz against 125 Hz",
        rule=f"at 125 Hz the explicit scheme is off by more than {_NONE:g} % of the torque's RMS",
    )
    explicit, implicit = (measured.of[s, COARSE] for s in ("explicit-euler", "implicit"))
    return judged(
        claim,
        explicit > _NONE,
        f"at 125 Hz: explicit {explicit:.2g} %, implicit {implicit:.2g} % off",
        why="The explicit scheme is good enough at 125 Hz.",
        remark=(
            "Solved implicitly the model runs at the muscle model's rate."
            if implicit <= _NONE
            else "The implicit scheme is off too: what is left is mostly the chirp's sampling."
        ),
        figure="figure-45",
    )
