"""All subjects in one table."""

from typing import Annotated, Any, Literal

from fastapi import APIRouter, Query, Response

from surae import api
from surae.files import csv_row
from surae_workbench.web.fits import model_title
from surae_workbench.web.project import when
from surae_workbench.web.routes.common import ERRORS, Bench, Responses, attachment
from surae_workbench.web.rows import Thing
from surae_workbench.web.schemas import Model
from surae_workbench.web.workbench import Workbench

router = APIRouter(prefix="/api", responses=ERRORS, tags=["cohort"])

#: Columns of the file before the estimates; `model` is what the command line calls it.
_LABELS = ("subject", "group", "side", "trial", "condition", "model_title", "model", "status",
           "vaf", "ipde", "created")  # fmt: skip
_CSV: Responses = {200: {"content": {"text/csv": {}}}}

Which = Annotated[Literal["latest", "all"], Query()]


@router.get("/cohort")
def get_cohort(bench: Bench, model: Model = "muscle", which: Which = "latest") -> dict[str, Any]:
    """Parameters over subjects, sides and trials: the latest fit of each, or all."""
    rows = _rows(bench, model, which)
    spec = _with_found(model, rows)
    return {
        "columns": [
            {"name": p.name, "unit": p.unit, "meaning": p.meaning} for p in spec.parameters
        ],
        "rows": rows,
    }


@router.get("/cohort.csv", response_class=Response, responses=_CSV)
def get_cohort_csv(bench: Bench, model: Model = "muscle", which: Which = "latest") -> Response:
    """The cohort's table as a file."""
    rows = _rows(bench, model, which)
    names = [p.name for p in _with_found(model, rows).parameters]
    cells = {"": "value", "_sem": "sem", "_low": "low", "_high": "high", "_verdict": "verdict"}
    lines = [csv_row([*_LABELS, *(name + end for name in names for end in cells)])]
    for row in rows:
        estimates = [row["parameters"].get(name, {}) for name in names]
        numbers = (estimate.get(key) for estimate in estimates for key in cells.values())
        lines.append(csv_row([*(row[key] for key in _LABELS), *numbers]))
    headers = attachment(f"cohort-{model}", ".csv")
    return Response("".join(lines), media_type="text/csv", headers=headers)


def _with_found(model: str, rows: list[dict[str, Any]]) -> api.ModelSpec:
    """The model, with the drives that some fit has estimated."""
    return api.with_optional(
        api.get_model(model), {name for row in rows for name in row["parameters"]}
    )


def _rows(bench: Workbench, model: str, which: str) -> list[dict[str, Any]]:
    recordings = {recording["id"]: recording for recording in bench.database.all("recording")}
    subjects = {subject["id"]: subject for subject in bench.database.all("subject")}
    rows: dict[object, dict[str, Any]] = {}
    for fit in bench.database.all("fit"):
        first = recordings.get(fit["recordings"][0])
        if fit["model"] != model or first is None:
            continue
        key = fit["id"] if which == "all" else tuple(fit["recordings"])
        rows.pop(key, None)
        rows[key] = _row(fit, first, subjects.get(first["subject"] or ""))
    return sorted(
        rows.values(), key=lambda r: (r["subject"], r["side"] or "", r["trial"], r["created"])
    )


def _row(fit: Thing, recording: Thing, subject: Thing | None) -> dict[str, Any]:
    return {
        "fit": fit["id"],
        "subject": "" if subject is None else subject["code"],
        "subject_id": None if subject is None else subject["id"],
        "group": "" if subject is None else subject["group"],
        **{key: recording[key] for key in ("side", "trial", "condition")},
        "name": fit["name"],
        "model_title": model_title(fit["model"]),
        "recordings": fit["recordings"],
        "names": fit["names"],
        **{key: fit[key] for key in ("model", "status", "vaf", "ipde", "parameters")},
        "created": when(fit["created"]),
    }
