"""Answers of fits: predictions and changes."""

import math
from collections.abc import Sequence
from datetime import datetime
from pathlib import Path
from typing import Any

from surae.api.fitted import Fit
from surae.api.fitting import load
from surae.api.given import AnyRecording, several
from surae.api.recordings import as_in_fit
from surae.api.sides import Side, Visited, place_of, side_of
from surae.base.errors import InputError
from surae.base.files import PathLike
from surae.base.requests import ChangeSettings
from surae.base.setting import renamed, takes
from surae.inference import Grade
from surae.inference.judging.validation import Prediction, predict_others
from surae.inference.relaxed.curve import RelaxedCurve
from surae.measures.change.compare import compare_sessions
from surae.measures.change.result import Change
from surae.measures.compared import common_end
from surae.measures.course import Series, rest_series, strength_series
from surae.measures.relaxed_change import remounting, rest_change
from surae.measures.strength import strength_change
from surae.measures.visits import compare_visits
from surae.nerve.change import NerveChange, of_files
from surae.signals import Weighting, led_in, weighted
from surae.trials.folder import fit_in, require_own

#: Angles of changes by default [deg].
CHANGE_ANGLES = (0.0, 10.0)


@takes(ChangeSettings)
def change(
    before: Visited,
    after: Visited,
    *,
    baselines: Sequence[Fit | PathLike] = (),
    **keywords: Any,
) -> Change:
    """Whether a leg has changed between two sessions, or how its two legs differ.

    Parameters
    ----------
    before, after : Fit, path, Recording, or sequence of recordings
        Fits, files of fits, or folders of sessions (`surae session`), whose joint fit is taken; or
        recordings of a visit, or the folder of them, of which the relaxed leg is compared.
    baselines : sequence of Fit or path
        Further sessions of the leg from before anything changed; they show how much sessions
        differ by themselves.
    {settings}

    Returns
    -------
    Change
        Every measure and parameter: difference, interval and verdict; and one sentence.

    Raises
    ------
    InputError
        A file cannot be read, both are one, an angle is out of reach, a question names nothing
        that is compared, or baselines are given of two legs.

    Examples
    --------
    >>> surae.change("before.json", "after.json", question=["torque_rise"]).sentence
    """
    settings = ChangeSettings(**keywords)
    if place_of(before) == place_of(after):
        raise InputError("before and after are the same fit; give two sessions, or two legs")
    angles = _angles(settings)
    sides = [*map(side_of, (before, after, *baselines))]
    fits = [side.fit.result for side in sides if side.fit is not None]
    end = common_end(fits) if fits else math.inf
    brought = [side.quantities(angles, end) for side in sides]
    curves = [side.curve() for side in sides]
    rest = None
    if curves[0] is not None and curves[1] is not None:
        repeats = [curve for curve in curves[2:] if curve is not None]
        rest = rest_change(
            curves[0],
            curves[1],
            angles,
            legs=settings.legs,
            remounted=0.0 if settings.mounted else remounting(curves[0], repeats),
        )
    return compare_sessions(
        brought[0],
        brought[1],
        brought[2:],
        legs=settings.legs,
        rest=rest,
        strength=strength_change(sides[0].efforts, sides[1].efforts),
        question=settings.question,
    )


@takes(ChangeSettings)
def course(
    visits: Sequence[Visited], *, days: Sequence[float] | None = None, **keywords: Any
) -> Change:
    """Whether a leg changed over three visits or more: a straight line through every measure.

    Parameters
    ----------
    visits : sequence
        In order; each as of `surae.change`.
    days : sequence of float, optional
        When each visit was, in days; by default they are as far apart as one from the next.
    {settings}

    Returns
    -------
    Change
        `difference`, from the first visit to the last along the line, its interval and verdict;
        `series` has every measure at every visit.

    Raises
    ------
    InputError
        There are fewer than three visits, two are one, or a question names nothing.

    Examples
    --------
    >>> surae.course(["before.json", "fit.json", "after.json"], days=[0, 31, 92]).sentence
    """
    settings = ChangeSettings(**keywords)
    if settings.legs or settings.mounted:
        raise InputError("legs and mounted are of two visits; leave them out of a course")
    if len({str(place_of(visit)) for visit in visits}) < len(visits):
        raise InputError("two of the visits are the same; give each once")
    sides = [*map(side_of, visits)]
    angles = _angles(settings)
    fits = [side.fit.result for side in sides if side.fit is not None]
    end = common_end(fits) if fits else math.inf
    curves = [side.curve() for side in sides]
    resting = [curve for curve in curves if curve is not None]
    rest: tuple[dict[str, Series], str] = ({}, "")
    if len(resting) == len(sides):
        rest = rest_series(resting, angles)
    return compare_visits(
        [side.quantities(angles, end) for side in sides],
        list(range(len(sides))) if days is None else list(days),
        {**rest[0], **strength_series([side.efforts for side in sides])},
        rest[1],
        question=settings.question,
        names=[_called(visit, side) for visit, side in zip(visits, sides, strict=True)],
    )


def _called(visit: Visited, side: Side) -> str:
    """What a visit is called: its file or folder, else its recordings."""
    if isinstance(visit, str) or hasattr(visit, "__fspath__"):
        return Path(visit).name  # type: ignore[arg-type]
    return ", ".join(side.names)


def _angles(settings: ChangeSettings) -> tuple[float, ...]:
    """Angles [deg] that are compared: those given, and those of what is asked."""
    asked = [float(a) for a in map(_angle_in, settings.question) if a is not None]
    return tuple(dict.fromkeys((*(settings.angles or CHANGE_ANGLES), *asked)))


def _angle_in(name: str) -> float | None:
    """The angle [deg] at which a measure is asked; None where it is asked at none."""
    point = name.partition("@")[2]
    if not point.endswith("deg"):
        return None
    try:
        return float(point.removesuffix("deg").replace("−", "-"))
    except ValueError:
        return None


def other_change(before: PathLike, after: PathLike) -> NerveChange | None:
    """What differs between two I.json or R.json; None where the files are no such answers."""
    return of_files(before, after)


def write_change_page(
    path: PathLike,
    change: Change,
    fits: Sequence[Fit],
    *,
    language: str = "en",
    angle: float | None = None,
    curves: Sequence[RelaxedCurve] = (),
) -> None:
    """Write the page of what changed, HTML or by its ending PDF.

    `fits` are both that were compared, none where recordings were, and `curves` those of their
    rest, none where one has no rest; torque and stiffness are given at `angle` [deg], by default
    10, or what was measured near it.
    """
    from surae.report.change import change_report  # matplotlib

    change_report(
        change,
        fits,
        created=datetime.now().astimezone(),
        language=language,
        angle=angle,
        curves=curves,
    ).write(path)


def fits_of(*given: Visited) -> list[Fit]:
    """The fits of visits, where every one has its fit; else none."""
    fits = [side.fit for side in map(side_of, given)]
    return [fit for fit in fits if fit is not None] if None not in fits else []


def curves_of(*given: Visited) -> list[RelaxedCurve]:
    """The relaxed curves of visits, where every one rests; else none."""
    curves = [side.curve() for side in map(side_of, given)]
    return [curve for curve in curves if curve is not None] if None not in curves else []


def fit_of(given: Fit | PathLike) -> Fit:
    """A fit that is given as itself, as its file, or as the folder of a session."""
    if isinstance(given, Fit):
        return given
    place = Path(given)
    if not place.is_dir():
        return load(place)
    fit = load(fit_in(place))
    require_own(place, fit.result.problem.inputs)
    return fit


@renamed(fitted="fit")
def validate(
    fit: Fit | PathLike,
    recordings: AnyRecording | Sequence[AnyRecording],
    *,
    prepared: bool | None = None,
    weights: Weighting | Sequence[Weighting] | None = None,
) -> tuple[Prediction, ...]:
    """Predict recordings with the parameters of a fit to others (thesis 2.7).

    Parameters
    ----------
    fit : Fit or path
        Where the parameters come from; of a session's folder it is the joint fit.
    recordings : Recording, ModelInputs or path, or sequence of them
        With their measured torque.
    prepared : bool, optional
        Whether their signals are used as they are; by default as they were in the fit.
    weights : Weighting, or sequence of Weighting, optional
        Its windows of weight 0 are left out of the figures.

    Returns
    -------
    tuple of Prediction
        One for each recording: VAF, RMSE, bias, the predicted torque, in `adequacy` whether it is
        as good as the fit promises, with reasons, and in `baselines` what is predicted of it
        without a model.

    Examples
    --------
    >>> surae.validate(surae.load("fit.json"), ["other.csv"])[0].adequacy.grade
    """
    known = fit_of(fit)
    inputs = list(map(led_in, as_in_fit(known.result.problem, several(recordings), prepared)))
    counted = inputs if weights is None else weighted(inputs, weights)
    adequate = known.adequacy.grade == Grade.ADEQUATE
    return predict_others(known.result, counted, known.assessment.uncertainty, adequate=adequate)
