"""A rule on standard errors, and what it gives at other noise: motion and noise told apart."""

from collections.abc import Callable, Sequence

from surae.reproduction.claims import Claim, Finding, judged
from surae.reproduction.simulation.cells import Cell, at_chirp
from surae.reproduction.simulation.designs import AMPLITUDES, CHOSEN_RATE
from surae.reproduction.simulation.torques import at_equal_noise, at_signed_noise

#: What a claim's rule says of cells, with our number.
Ruling = tuple[bool, str]


def under_both(
    claim: Claim,
    rule: Callable[[Sequence[Cell]], Ruling],
    found: Sequence[Cell],
    *,
    about: str = "",
    figure: str = "",
) -> Finding:
    """Judge SEMs as they are, and say what the rule gives at equal noise in every cell.

    Parameters
    ----------
    claim : Claim
        The claim.
    rule : callable
        From cells to whether it holds, and our number.
    found : sequence of Cell
        With the sizes of their torques.
    about : str
        What else to know, in sentences.
    figure : str
        Name of the figure that shows it.
    """
    holds, ours = rule(found)
    signed, by_mean = rule(at_signed_noise(found))
    also, equal = rule(at_equal_noise(found))
    sizes = [cell.torque.magnitude for cell in found if cell.torque and cell.amplitude == 0.0]
    large = [
        cell.torque.magnitude
        for cell in at_chirp(found, max(AMPLITUDES), CHOSEN_RATE)
        if cell.torque is not None
    ]
    text = (
        f"At equal noise in every cell it {_verb(also)}: {equal}. With noise of the torque's "
        f"signed mean it {_verb(signed)}: {by_mean}."
    )
    if holds != also and sizes and large:
        text += (
            " What makes the difference is the noise: 5 % of the torque's mean magnitude, which "
            f"the chirp's inertia raises from {min(sizes):.0f} to {max(sizes):.0f} Nm without "
            f"chirp to {min(large):.0f} to {max(large):.0f} Nm at {max(AMPLITUDES):g} rad, "
            f"{CHOSEN_RATE:g}; all SEMs grow with it, whatever the motion tells."
        )
    text = f"{text} {about}".strip()
    return judged(claim, holds, ours, why=text, remark=text, figure=figure)


def _verb(holds: bool) -> str:
    return "holds" if holds else "differs"
