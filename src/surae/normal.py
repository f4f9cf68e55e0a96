"""A normal distribution's 95 % interval, and the standard error behind one."""

#: Half of a 95 % interval, in standard errors.
NORMAL = 1.959964


def standard_error_of(ci95: tuple[float, float]) -> float:
    """The standard error of which a 95 % interval is that of a normal distribution."""
    return (ci95[1] - ci95[0]) / (2.0 * NORMAL)
