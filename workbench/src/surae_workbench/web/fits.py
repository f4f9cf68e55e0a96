"""What becomes of finished jobs, and what is shown of fits."""

from collections.abc import Mapping
from typing import TYPE_CHECKING, Any

from surae import api
from surae.base.names import AUTO
from surae.base.words import N_
from surae_workbench.web.answers import Fit
from surae_workbench.web.draft import settings_of
from surae_workbench.web.project import dated, unique_name
from surae_workbench.web.rows import Entry

if TYPE_CHECKING:
    from surae_workbench.web.workbench import Workbench


def versions_of(bench: "Workbench", draft: Mapping[str, Any]) -> dict[str, int]:
    """Which descriptions of its recordings a draft is about."""
    ids = [*draft["recordings"], *draft["mvc"]]
    rows = [bench.project.need("recording", id_) for id_ in ids]
    for row in rows:  # what is read from memory here, a job reads from its file
        bench.project.recording_path(row)
    return {row["id"]: row.get("version", 0) for row in rows}


def check_draft(bench: "Workbench", draft: dict[str, Any]) -> None:
    """Refuse a draft that no fit can be made of, with the line that the fit would give."""
    settings, inputs = prepared_draft(bench, draft)
    api.make_problem(inputs, settings)


def prepared_draft(
    bench: "Workbench", draft: dict[str, Any]
) -> "tuple[api.FitSettings, tuple[api.ModelInputs, ...]]":
    """What a draft asks, and what a model reads of its recordings."""
    settings = settings_of(draft, draft["recordings"])
    inputs, contractions = (
        [bench.prepared(id_, settings) for id_ in draft[key]] for key in ("recordings", "mvc")
    )
    return settings, settings.inputs(inputs, contractions)


def keep_fit(bench: "Workbench", job: Entry, end: Mapping[str, Any]) -> str:
    """Add a finished fit to the project."""
    task = job["task"]
    summary = end["summary"]
    name = task["name"] or f"{model_title(summary['model'])} · {', '.join(summary['names'])}"
    id_ = add_fit(bench, job["id"], name, summary, task["recordings"], task)
    bench.events.changed("fits")
    return id_


def add_fit(
    bench: "Workbench",
    id_: str,
    name: str,
    summary: Mapping[str, Any],
    recordings: list[str],
    task: Mapping[str, Any],
) -> str:
    """Add a fit whose file is there; `summary` is what lists show of it, `task` what made it."""
    versions = task.get("versions", {})
    used = {*recordings, *task["draft"]["mvc"]}
    data = {
        **summary,
        "name": unique_name(bench.database.all("fit"), name),
        "recordings": recordings,
        "versions": {key: versions[key] for key in versions if key in used},
        "settings": {**task["draft"], "recordings": recordings},
    }
    return bench.project.add("fit", data, id_)


def keep_designs(bench: "Workbench", job: Entry, end: Mapping[str, Any]) -> str | None:
    """Keep the protocols that were designed; the id of the last."""
    id_ = None
    task = job["task"]
    for design in end["designs"]:
        name = unique_name(bench.database.all("protocol"), design["name"], 120)
        settings = {
            "profile": "designed",
            "device": task["device"],
            "rate_hz": task["rate_hz"],
            "angle_range": task["angle_range"] or design["limits"][:2],
            "limits": design["limits"],
            "plan": design["plan"] | {key: task[key] for key in ("model", "population")},
        }
        id_ = bench.database.add("protocol", {"name": name, "settings": settings})
    bench.events.changed("protocols")
    return id_


def keep_profile(bench: "Workbench", job: Entry, end: Mapping[str, Any]) -> str:
    """Add finished profiles to those of their fit."""
    fit = bench.project.need("fit", str(job["about"]))
    profiles = {**fit.get("profiles", {}), **end["profiles"]}
    bench.project.change("fit", fit["id"], profiles=profiles)
    bench.events.changed("fits")
    return str(fit["id"])


def model_title(name: str) -> str:
    """What people call a model."""
    return N_("automatic") if name == AUTO else api.MODELS[name].title


def fit_summary(bench: "Workbench", fit: Entry) -> Fit:
    """A fit in lists."""
    first = bench.database.get("recording", fit["recordings"][0], deleted=True)
    rows = (bench.database.get("recording", id_) for id_ in fit["recordings"])
    made_of = fit.get("versions", {})
    return Fit(
        **dated(fit, r2=fit.get("r2")),
        title=model_title(fit["model"]),
        older=[
            row["name"]
            for row in rows
            if row and row.get("version", 0) != made_of.get(row["id"], 0)
        ],
        subject=None if first is None else first["subject"],
    )


def main_fit(bench: "Workbench", session: Entry) -> str | None:
    """The fit that stands for a leg, if it is still there: of all together, or the only one."""
    fits = session["fits"]
    id_ = fits.get("joint") or (next(iter(fits.values())) if len(fits) == 1 else None)
    return id_ if id_ and bench.database.get("fit", id_) else None
