"""What README promises of one trial, and when a count keeps it.

Shares are README's table, counted on legs that depart from every model. Values of few legs scatter
about them: a count fails only where so few true ones came once in twenty times.
"""

from scipy.stats import binom

#: Part of what is called identified that is true; part of what is free that is identified.
PROMISED, IDENTIFIED = 0.93, 0.09


def keeps_the_promise(true: int, claimed: int, promised: float = PROMISED) -> bool:
    """Whether so few true ones come once in twenty times at least where `promised` are true."""
    return bool(true >= binom.ppf(0.05, claimed, promised))
