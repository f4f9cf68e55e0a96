"""What is wrong in most trials of a session alike: the mapping's fault, mended there once."""

from collections.abc import Iterable

from surae.quality import Quality


def common_errors(quality: Iterable[Quality]) -> tuple[str, ...]:
    """Errors that more than half of the trials have, at least two, with what to do.

    Parameters
    ----------
    quality : iterable of Quality
        What was found in each trial.

    Returns
    -------
    tuple of str
        A sentence each; empty where trials have errors of their own only.
    """
    every = list(quality)
    advice: dict[str, tuple[str, int]] = {}
    for checked in every:
        errors = {f.code: f.advice for f in checked.findings if f.severity == "error"}
        for code, text in errors.items():
            first, count = advice.get(code, (text, 0))
            advice[code] = first, count + 1
    return tuple(
        f"{code} in {count} of {len(every)} trials alike, so it is the mapping's: {text}"
        for code, (text, count) in advice.items()
        if count > 1 and 2 * count > len(every)
    )
