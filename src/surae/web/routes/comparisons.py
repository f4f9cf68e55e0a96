"""Fits side by side, and models weighed against each other."""

import json
from typing import Annotated, Any

from fastapi import APIRouter, Query

from surae import api
from surae.web.fits import fit_summary, submit_comparison
from surae.web.http_errors import RefusedError
from surae.web.project import when
from surae.web.routes.common import ERRORS, Bench, Browser, PathId, chosen_draft
from surae.web.rows import Thing
from surae.web.schemas import ComparisonRequest

router = APIRouter(prefix="/api", responses=ERRORS, tags=["comparisons"])


@router.get("/compare")
def get_compare(bench: Bench, fits: Annotated[str, Query(max_length=340)]) -> dict[str, Any]:
    """Several fits side by side, parameter by parameter."""
    chosen = [bench.project.need("fit", id_) for id_ in dict.fromkeys(fits.split(","))]
    names: dict[str, None] = {}
    for fit in chosen:
        names |= dict.fromkeys(fit["parameters"])
    return {
        "fits": [fit_summary(bench, fit) for fit in chosen],
        "parameters": [
            {
                "name": name,
                **_described(name),
                "estimates": [_estimate(model, name) for model in chosen],
            }
            for name in names
        ],
    }


def _described(name: str) -> dict[str, str]:

    known = {p.name: p for p in api.OPTIONAL_PARAMETERS}
    known |= {p.name: p for spec in api.MODELS.values() for p in reversed(spec.parameters)}
    p = known.get(name)
    return {"unit": "" if p is None else p.unit, "meaning": "" if p is None else p.meaning}


def _estimate(fit: Thing, name: str) -> dict[str, Any] | None:
    answer = fit["parameters"].get(name)
    if answer is None:
        return None
    ci95 = None if answer["low"] is None else [answer["low"], answer["high"]]
    return {**{key: answer[key] for key in ("value", "sem", "verdict")}, "ci95": ci95}


@router.post("/comparisons", status_code=202)
def post_comparison(body: ComparisonRequest, bench: Bench, browser: Browser) -> dict[str, Any]:
    """Ask whether the recordings need tendons that give way; the answer is the job."""
    models = body.models or ["muscle", "muscle-tendon"]
    tendons = {
        name: any(p.group == "tendon" for p in api.MODELS[name].parameters) for name in models
    }
    if len(set(models)) < len(models):
        raise RefusedError(400, "a model is given twice; give it once")
    if len(set(tendons.values())) < 2:
        raise RefusedError(400, "compare at least one model without tendons and one with")
    draft = chosen_draft(bench, browser, body.draft)
    if body.fit is not None:
        bench.project.need("fit", body.fit)
    job = submit_comparison(bench, browser, draft, list(models), body.fit)
    return bench.jobs.shown(job, browser)


@router.get("/comparisons")
def get_comparisons(bench: Bench) -> dict[str, Any]:
    """Comparisons of models, the newest first."""
    return {
        "comparisons": [
            {
                **{key: comparison[key] for key in ("id", "conclusion", "recordings")},
                "created": when(comparison["created"]),
            }
            for comparison in reversed(bench.database.all("comparison"))
        ]
    }  # fmt: skip


@router.get("/comparisons/{id}")
def get_comparison(id: PathId, bench: Bench) -> dict[str, Any]:
    """One of them, as `surae compare --output` writes it."""
    row = bench.project.need("comparison", id)
    path = bench.project.path("comparisons", id, ".json")
    try:
        content: dict[str, Any] = json.loads(path.read_text(encoding="utf-8"))
    except (OSError, ValueError):
        raise RefusedError(404, "the file of this comparison is missing; compare again") from None
    return {
        "id": id,
        "created": when(row["created"]),
        "recording_ids": row["recordings"],
        **content,
    }
