"""What becomes of finished jobs, and what is shown of fits."""

import json
from collections.abc import Mapping
from dataclasses import asdict
from typing import TYPE_CHECKING, Any

import numpy as np

from surae.errors import InputError
from surae.report.adequacy import adequacy_words
from surae.report.budget import budget_section
from surae.report.decimate import extremes
from surae.report.laboratory import family_section, laboratory_section, trials_section
from surae.web.draft import normal, settings_of, shown, upgraded
from surae.web.jobs import Kind
from surae.web.live import plain
from surae.web.project import when
from surae.web.rows import Thing
from surae.web.sessions import Session

if TYPE_CHECKING:
    from surae.api import Fit
    from surae.settings import FitSettings
    from surae.signals import ModelInputs
    from surae.web.workbench import Workbench

_PARTS = ("tissue_tri", "tissue_tib", "neural_tri", "neural_tib", "inertial", "gravitational")
#: Of a FIT.json, what pages do not need: it is long.
_LONG = ("R", "traces", "outliers")


def submit_fit(
    bench: "Workbench", session: Session, draft: dict[str, Any], name: str | None
) -> Thing:
    """Ask for the fit that a draft describes; wrong settings are refused now, not in the job."""
    recordings = bench.draft_recordings(draft)
    check_draft(bench, draft)
    label = f"{draft['model']} · {', '.join(one['name'] for one in recordings)}"
    task = {"draft": draft, "name": name, "recordings": [one["id"] for one in recordings]}
    return bench.jobs.submit("fit", (name or label)[:200], session, task, recordings[0]["id"])


def submit_comparison(
    bench: "Workbench",
    session: Session,
    draft: dict[str, Any],
    models: list[str],
    fit: str | None,
) -> Thing:
    """Ask whether the draft's recordings need tendons that give way; `fit` is what for."""
    recordings = bench.draft_recordings(draft)
    check_draft(bench, draft)
    names = ", ".join(one["name"] for one in recordings)
    task = {
        "draft": draft,
        "models": models,
        "fit": fit,
        "recordings": [one["id"] for one in recordings],
    }
    return bench.jobs.submit(
        "compare", f"compare models · {names}"[:200], session, task, recordings[0]["id"]
    )


def check_draft(bench: "Workbench", draft: dict[str, Any]) -> None:
    """Refuse a draft that no fit can be made of, with the line that the fit would give."""
    from surae.estimation import make_problem

    settings, inputs = prepared_draft(bench, draft)
    make_problem(inputs, settings)


def prepared_draft(
    bench: "Workbench", draft: dict[str, Any]
) -> "tuple[FitSettings, tuple[ModelInputs, ...]]":
    """What a draft asks, and what a model reads of its recordings."""
    settings = settings_of(draft, draft["recordings"])
    inputs, contractions = (
        [bench.prepared(id_, settings) for id_ in draft[key]] for key in ("recordings", "mvc")
    )
    return settings, settings.inputs(inputs, contractions)


def job_kinds(bench: "Workbench") -> dict[str, Kind]:
    """What the workbench's jobs are, and what becomes of them."""
    return {
        "fit": Kind("fits", lambda job, end: keep_fit(bench, job, end)),
        "profile": Kind("fits", lambda job, end: keep_profile(bench, job, end)),
        "compare": Kind("fits", lambda job, end: keep_comparison(bench, job, end)),
        "study": Kind("studies", lambda job, end: keep_study(bench, job, end)),
    }


def keep_fit(bench: "Workbench", job: Thing, end: Mapping[str, Any]) -> str:
    """Add a finished fit to the project."""
    task, told = job["task"], end["summary"]
    names = ", ".join(told["names"])
    data = {
        **told,
        "name": task["name"] or f"{told['model']} · {names}"[:200],
        "recordings": task["recordings"],
        "settings": task["draft"],
    }
    id_ = bench.project.add("fit", data, job["id"])
    bench.changed("fits")
    return id_


def keep_profile(bench: "Workbench", job: Thing, end: Mapping[str, Any]) -> str:
    """Add finished profiles to those of their fit."""
    del end
    id_ = str(job["about"])
    made = bench.project.path("fits", job["id"], ".profiles.json")
    found = json.loads(made.read_text(encoding="utf-8"))["profiles"]
    made.unlink(missing_ok=True)
    fit = bench.project.need("fit", id_)
    kept = {**fit.get("profiles", {}), **{name: _profile(one) for name, one in found.items()}}
    bench.project.change("fit", id_, profiles=kept)
    bench.changed("fits")
    return id_


def keep_comparison(bench: "Workbench", job: Thing, end: Mapping[str, Any]) -> str:
    """Add a finished comparison to the project."""
    task = job["task"]
    data = {
        "conclusion": end["message"],
        "recordings": task["recordings"],
        "models": task["models"],
        "fit": task.get("fit"),
    }
    bench.changed("comparisons")
    return bench.project.add("comparison", data, job["id"])


def keep_study(bench: "Workbench", job: Thing, end: Mapping[str, Any]) -> str:
    """A study keeps itself."""
    del end
    bench.changed("studies")
    return str(job["about"])


def _profile(one: Mapping[str, Any]) -> dict[str, Any]:
    """What a page draws of a profile."""
    low, high = one["interval"]
    return {
        "values": one["grid"],
        "delta": one["delta_chi2"],
        "threshold": one["threshold"],
        "lower": low,
        "upper": high,
        "status": one["status"],
        "note": one["message"],
        "open": one["open"],
    }


def fit_summary(bench: "Workbench", fit: Thing) -> dict[str, Any]:
    """A fit in lists."""
    first = bench.database.get("recording", fit["recordings"][0], deleted=True)
    keys = ("name", "model", "status", "vaf", "ipde", "seconds", "recordings", "names", "starts",
            "agreeing")  # fmt: skip
    return {
        "id": fit["id"],
        **{key: fit[key] for key in keys},
        "created": when(fit["created"]),
        "subject": None if first is None else first["subject"],
    }


def fit_detail(bench: "Workbench", fit: Thing) -> dict[str, Any]:
    """All that is shown of a fit but its curves."""
    path = bench.project.path("fits", fit["id"], ".json")
    try:
        whole = json.loads(path.read_text(encoding="utf-8"))
    except (OSError, ValueError):
        raise InputError("the file of this fit is missing or damaged; fit again") from None
    comparisons = [
        {"id": one["id"], "created": when(one["created"]), "conclusion": one["conclusion"]}
        for one in bench.database.all("comparison")
        if one.get("fit") == fit["id"]
        or (one.get("fit") is None and set(one["recordings"]) == set(fit["recordings"]))
    ]
    steps = [trace["steps"] for trace in whole.get("traces", [])]
    return {
        "summary": fit_summary(bench, fit),
        **_told(bench.fit(fit["id"])),
        "fit": {key: value for key, value in whole.items() if key not in _LONG},
        "steps": steps,
        "normal": {name: ranges(name) for name in whole["parameters"]},
        "settings": shown(upgraded(fit["settings"])),
        "profiles": fit.get("profiles", {}),
        "comparisons": comparisons,
    }


def _told(fit: "Fit") -> dict[str, Any]:
    """What the report says of the whole fit, of what makes it unsure, and of what was searched."""
    result, assessment = fit.result, fit.assessment
    sections: dict[str, Any] = {
        "adequacy": adequacy_words(fit.adequacy),
        "budget": budget_section(result, assessment),
        "laboratory": laboratory_section(result, assessment),
        "family": family_section(result, assessment),
        "trials": trials_section(result, assessment),
    }
    return {name: None if each is None else asdict(each) for name, each in sections.items()}


def ranges(name: str) -> dict[str, list[float] | None]:
    """Where a parameter lies in health and in patients."""
    return {population: normal(name, population) for population in ("healthy", "patient")}


def fit_traces(
    fitted: "Fit", number: int, start: float | None, end: float | None, points: int
) -> dict[str, Any]:
    """The curves of one recording of a fit, at common instants."""
    parts = fitted.parts(number)  # refuses a wrong number
    one = fitted.result.problem.inputs[number]
    residual = fitted.result.residuals[number]
    first = 0 if start is None else max(int(np.searchsorted(one.time, start)) - 1, 0)
    last = one.n if end is None else int(np.searchsorted(one.time, end, "right")) + 1
    last = min(max(last, first), one.n)
    measured = np.zeros(one.n) if one.torque is None else one.torque
    modelled = measured - residual
    inside = slice(first, last)
    # Every point is a sample: parts add up to the torque, and no swing of a chirp is lost.
    shown = first + extremes([each[inside] for each in (measured, modelled, one.angle)], points)
    return {
        "name": one.name,
        "n": one.n,
        "rate_hz": one.rate_hz,
        "t": plain(one.time[shown]),
        "measured": plain(measured[shown]),
        "modelled": plain(modelled[shown]),
        "residual": plain(residual[shown]),
        "angle": plain(one.angle[shown]),
        "emg": [plain(one.emg[shown, column]) for column in range(one.emg.shape[1])],
        "emg_unit": one.emg_unit,
        "parts": {name: plain(getattr(parts, name)[shown]) for name in _PARTS},
        "excluded": _excluded(one.time, one.weight),
    }


def _excluded(time: Any, weight: Any) -> list[list[float]]:
    """Spans that were left out [s]."""
    if weight is None:
        return []
    from surae.report.excluded import excluded_spans

    return [[float(time[a]), float(time[b])] for a, b in excluded_spans(weight)]
