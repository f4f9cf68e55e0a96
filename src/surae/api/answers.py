"""Answers of more than one fit: changes of a leg, and cohorts."""

from collections.abc import Sequence
from datetime import datetime
from pathlib import Path
from typing import TYPE_CHECKING, Any

from surae.api.fitted import Fit
from surae.api.fitting import load
from surae.errors import InputError
from surae.files import PathLike
from surae.measures.change import Change, compare_sessions
from surae.measures.cohort import Cohort, borrowed, pool
from surae.measures.members import measured, read_table, refitted
from surae.measures.quantity import Quantities, quantities
from surae.progress import Progress
from surae.requests import ChangeSettings, CohortSettings
from surae.runner import Engine
from surae.setting import takes
from surae.trials.folder import fit_in

if TYPE_CHECKING:
    from surae.assessment import Prediction

#: Angles of changes by default [deg].
CHANGE_ANGLES = (0.0, 10.0)


@takes(ChangeSettings)
def change(
    before: Fit | PathLike,
    after: Fit | PathLike,
    *,
    baselines: Sequence[Fit | PathLike] = (),
    **keywords: Any,
) -> Change:
    """Whether a leg has changed between two sessions, or how its two legs differ.

    Parameters
    ----------
    before, after : Fit or path
        Fits, files of fits, or folders of sessions (`surae session`), whose joint fit is taken.
    baselines : sequence of Fit or path
        Further sessions of the leg from before anything changed; they show how much sessions
        differ by themselves.
    {settings}

    Returns
    -------
    Change
        Every measure and parameter: difference, interval and verdict.

    Raises
    ------
    InputError
        A file cannot be read, both are one, an angle is out of reach, or baselines are given of
        two legs.
    """
    settings = ChangeSettings(**keywords)
    places = [
        id(each) if isinstance(each, Fit) else _file_of(each).resolve() for each in (before, after)
    ]
    if places[0] == places[1]:
        raise InputError("before and after are the same fit; give two sessions, or two legs")
    angles = settings.angles or CHANGE_ANGLES
    sides = [_quantities(each, angles) for each in (before, after, *baselines)]
    return compare_sessions(sides[0], sides[1], sides[2:], legs=settings.legs)


@takes(CohortSettings)
def cohort(
    table: PathLike,
    *,
    engine: Engine | None = None,
    progress: Progress | None = None,
    **keywords: Any,
) -> Cohort:
    """Groups of legs, their differences and changes, and each leg among them.

    Parameters
    ----------
    table : path
        A CSV with the columns ``fit`` (a FIT.json or the folder of a session, from where the table
        is), ``subject``, and as far as there are ``side``, ``group``, ``session``; every other
        column is a clinical scale.
    engine : Engine, optional
        Where the work is done; by default in one process.
    progress : callable, optional
        Called with legs done and all legs.
    {settings}

    Returns
    -------
    Cohort
        A fit that cannot be read leaves its leg out, and its reason is kept.

    Raises
    ------
    InputError
        The table is damaged, or has no fit that can be read.
    """
    settings, where = CohortSettings(**keywords), engine or Engine("threads", 1)
    rows = read_table(table)
    members = measured(rows, settings.angles, where, progress=progress)
    pooled = pool(members)
    if not settings.refit:
        return pooled
    again, rounds = refitted(rows, members, settings.angles, where, progress)
    return borrowed(pooled, again, rounds)


def write_cohort_page(path: PathLike, cohort: Cohort) -> None:
    """Write the page of a cohort: groups, differences, changes, and every leg.

    Parameters
    ----------
    path : path
        HTML, or a PDF where it ends in ``.pdf``.
    cohort : Cohort
        As `cohort` made it.

    Raises
    ------
    InputError
        The file cannot be written.
    """
    from surae.report.cohort import cohort_report  # matplotlib

    cohort_report(cohort, created=datetime.now().astimezone()).write(path)


def write_change_page(
    path: PathLike,
    change: Change,
    fits: Sequence[Fit],
    *,
    baselines: Sequence[Fit] = (),
    language: str = "en",
    angle: float | None = None,
) -> None:
    """Write the page of what changed: three measures fixed beforehand, then every measure.

    Parameters
    ----------
    path : path
        HTML, or a PDF where it ends in ``.pdf``.
    change : Change
        As `change` made it.
    fits : sequence of Fit
        Both that were compared.
    baselines : sequence of Fit
        Further sessions from before anything changed.
    language : {"en", "nl", "de", "fr"}
        The reader's.
    angle : float, optional
        Where torque and stiffness are given [deg]; by default 10, or what was measured near it.

    Raises
    ------
    InputError
        The language is not known, or the page cannot be written.
    """
    from surae.report.change import change_report  # matplotlib

    sides, before = ([(f.result, f.assessment) for f in each] for each in (fits, baselines))
    change_report(
        change, sides, created=datetime.now().astimezone(), baselines=before, language=language,
        angle=angle,
    ).write(path)  # fmt: skip


def change_part(before: Fit | PathLike, after: Fit | PathLike) -> str:
    """What changed between two visits, as a part of the leg's page.

    Parameters
    ----------
    before, after : Fit or path
        Of the leg: fits, files of fits, or folders of sessions.

    Returns
    -------
    str
        HTML.

    Raises
    ------
    InputError
        A file cannot be read.
    """
    from surae.report import part_of
    from surae.report.cards import change_card
    from surae.report.language import words_in
    from surae.report.leg import compared, visit_angle  # matplotlib

    first, second = ((fit.result, fit.assessment) for fit in map(fit_of, (before, after)))
    card = change_card(compared(first, second), visit_angle(second), words_in("en"))
    return part_of(card, {})


def predictions_part(fit: Fit, predictions: "Sequence[Prediction]") -> str:
    """How other recordings are predicted, as a part of a page.

    Parameters
    ----------
    fit : Fit
        Whose parameters predict.
    predictions : sequence of Prediction
        As `validate` makes them.

    Returns
    -------
    str
        HTML.
    """
    from surae.report import part_of
    from surae.report.fit import predictions_report  # matplotlib

    return part_of(**predictions_report(fit.assessment, predictions).plain())


def fit_of(given: Fit | PathLike) -> Fit:
    """A fit that is given as itself, as its file, or as the folder of a session.

    Raises
    ------
    InputError
        There is none, or a folder has several and no joint one.
    """
    return given if isinstance(given, Fit) else load(_file_of(given))


def _file_of(place: PathLike) -> Path:
    """A file of a fit, or that of the folder of a session."""
    path = Path(place)
    return fit_in(path) if path.is_dir() else path


def _quantities(given: Fit | PathLike, angles: Sequence[float]) -> Quantities:
    fit = fit_of(given)
    return quantities(fit.result, fit.assessment, angles)
