"""All legs in one table."""

from typing import Annotated, Any, Literal

from fastapi import APIRouter, Query, Request, Response

from surae import api
from surae.base.files import csv_row
from surae_workbench.web.fits import main_fit, model_title
from surae_workbench.web.language import language_of
from surae_workbench.web.project import when
from surae_workbench.web.routes.common import CSV, ERRORS, Bench, attachment
from surae_workbench.web.rows import MEASURES, Entry
from surae_workbench.web.workbench import Workbench

router = APIRouter(prefix="/api", responses=ERRORS, tags=["cohort"])

#: Columns of the file before the estimates; `model` is what the command line calls it.
_LABELS = (
    "subject",
    "group",
    "side",
    "visit",
    "trial",
    "condition",
    "model_title",
    "model",
    "status",
    "vaf",
    "ipde",
    "grade",
    "r2",
    "name",
    "created",
)

Which = Annotated[Literal["legs", "all"], Query()]


@router.get("/cohort")
def get_cohort(request: Request, bench: Bench, which: Which = "legs") -> dict[str, Any]:
    """Measures and parameters of every leg, a row for each visit; or of every fit."""
    rows = _rows(bench, which)
    words = api.words_in(language_of(request))
    return {
        "measures": [
            {"name": name, "title": words.measure(name), "unit": unit}
            for name, unit in MEASURES.items()
            if any(name in row["measures"] for row in rows)
        ],
        "columns": [{"name": p.name, "unit": p.unit, "meaning": p.meaning} for p in _columns(rows)],
        "rows": rows,
    }


@router.get("/cohort.csv", response_class=Response, responses=CSV)
def get_cohort_csv(bench: Bench, which: Which = "legs") -> Response:
    """The cohort's table as a file."""
    rows = _rows(bench, which)
    names = [*MEASURES, *(p.name for p in _columns(rows))]
    cells = {"": "value", "_sem": "sem", "_low": "low", "_high": "high", "_verdict": "verdict"}
    lines = [csv_row([*_LABELS, *(name + end for name in names for end in cells)])]
    for row in rows:
        known = row["measures"] | row["parameters"]
        estimates = [known.get(name, {}) for name in names]
        numbers = (estimate.get(key) for estimate in estimates for key in cells.values())
        lines.append(csv_row([*(row[key] for key in _LABELS), *numbers]))
    return Response("".join(lines), media_type="text/csv", headers=attachment("cohort", ".csv"))


def _columns(rows: list[dict[str, Any]]) -> list[api.Parameter]:
    """The parameters that some row has, in the order of the models."""
    names = {name for row in rows for name in row["parameters"]}
    known = [p for spec in api.MODELS.values() for p in spec.parameters]
    by_name = {p.name: p for p in (*known, *api.OPTIONAL_PARAMETERS)}
    return [p for name, p in by_name.items() if name in names]


def _rows(bench: Workbench, which: str) -> list[dict[str, Any]]:
    recordings = {recording["id"]: recording for recording in bench.database.all("recording")}
    subjects = {subject["id"]: subject for subject in bench.database.all("subject")}
    pages: dict[str | None, str] = {}
    fits = {fit["id"]: (fit, fit["name"]) for fit in bench.database.all("fit")}
    if which == "legs":  # each visit by the fit that stands for it, else the latest of the trials
        visits = bench.database.all("session")
        of_visits = {id_ for visit in visits for id_ in visit["fits"].values()}
        alone = {
            tuple(f["recordings"]): id_ for id_, (f, _) in fits.items() if id_ not in of_visits
        }
        mains = {main_fit(bench, visit): visit["name"] for visit in visits}
        pages = {main_fit(bench, visit): visit["id"] for visit in visits}
        fits = {id_: (fits[id_][0], name) for id_, name in mains.items() if id_ is not None} | {
            id_: fits[id_] for id_ in alone.values()
        }
    rows = [
        _row(fit, name, first, subjects.get(first["subject"] or ""))
        | {"page": f"/sessions/{pages[fit['id']]}" if fit["id"] in pages else f"/fits/{fit['id']}"}
        for fit, name in fits.values()
        if (first := recordings.get(fit["recordings"][0])) is not None
    ]
    return sorted(rows, key=lambda r: (r["subject"], r["side"] or "", r["visit"], r["name"]))


def _row(fit: Entry, name: str, recording: Entry, subject: Entry | None) -> dict[str, Any]:
    trial = recording if len(fit["recordings"]) == 1 else {"trial": "", "condition": ""}
    return {
        "fit": fit["id"],
        "subject": "" if subject is None else subject["code"],
        "group": "" if subject is None else subject["group"],
        "side": recording["side"],
        **{key: trial[key] for key in ("trial", "condition")},
        "visit": recording.get("visit") or str(when(fit["created"]))[:10],
        "name": name,
        "model_title": model_title(fit["model"]),
        **{key: fit.get(key) for key in ("model", "status", "grade", "r2", "vaf", "ipde")},
        "measures": fit.get("measures", {}),
        "parameters": fit["parameters"],
        "created": when(fit["created"]),
    }
