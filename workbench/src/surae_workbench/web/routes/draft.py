"""The session: its draft, undo and redo, its models, and the torque under the sliders."""

from typing import Any, Literal

from fastapi import APIRouter, Request

from surae import api
from surae.base.errors import InputError
from surae.base.names import DRIVES
from surae.processes import one_line
from surae_workbench.web.draft import parameter_table, settings_of
from surae_workbench.web.fits import check_draft, prepared_draft
from surae_workbench.web.form import form
from surae_workbench.web.http_errors import RefusedError
from surae_workbench.web.routes.common import ERRORS, Bench, Browser
from surae_workbench.web.schemas import DraftPatch, LiveRequest
from surae_workbench.web.sliders import live

router = APIRouter(prefix="/api", responses=ERRORS, tags=["session"])


@router.get("/session")
def get_session(request: Request, bench: Bench, browser: Browser) -> dict[str, Any]:
    """Who this browser is to the server, and the token that its requests must carry."""
    from surae._version import __version__
    from surae_workbench.web.routes.uploads import MOST_UPLOADS

    return {
        "csrf": browser.csrf,
        "version": __version__,
        "project": {"name": bench.project.name},
        "limits": {"upload_bytes": request.app.state.policy.upload_bytes, "uploads": MOST_UPLOADS},
    }


@router.get("/draft")
def get_draft(bench: Bench, browser: Browser) -> dict[str, Any]:
    """What this browser is working on."""
    return bench.sessions.state(browser)


@router.patch("/draft")
def patch_draft(body: DraftPatch, bench: Bench, browser: Browser) -> dict[str, Any]:
    """Change some of it, as one step that can be undone."""
    change = body.change.plain()
    for id_ in (*change.get("recordings", ()), *change.get("exclusions", ())):
        if change.get("exclusions", {}).get(id_, True) is not None:
            bench.project.need("recording", id_)
    for spans in (change.get("exclusions") or {}).values():
        for start, end in spans or []:
            if not start <= end:
                raise RefusedError(
                    400, f"window {start:g} … {end:g} s: its end must follow its start"
                )
    bench.sessions.change(browser, change, body.label, merge=body.merge)
    return bench.sessions.state(browser)


@router.post("/draft/{step}")
def move(step: Literal["undo", "redo"], bench: Bench, browser: Browser) -> dict[str, Any]:
    """Take the last step back, or do it again."""
    bench.sessions.move(browser, back=step == "undo")
    return bench.sessions.state(browser)


@router.get("/draft/parameters")
def get_parameters(bench: Bench, browser: Browser) -> dict[str, Any]:
    """The parameters of the draft's model, and why it cannot be fitted, where it cannot."""
    draft = bench.sessions.draft(browser)
    problem = None
    unit = "V"
    prescribed = dict[str, float]()
    try:
        bench.draft_recordings(draft)
        _, inputs = prepared_draft(bench, draft)
        unit = inputs[0].emg_unit
        prescribed = {
            name: value for recording in inputs for name, value in recording.fixed.items()
        }
        check_draft(bench, draft)
    except InputError as error:
        problem = one_line(error)
    return {
        "model": draft["model"],
        "problem": problem,
        "parameters": parameter_table(draft, unit, prescribed),
    }


@router.get("/models")
def get_models() -> dict[str, Any]:
    """What may drive the muscles, and the settings of a fit."""
    return {
        "drives": [
            {"name": name, "label": f"Estimate {words}", "parameters": list(api.OPTIONAL[name])}
            for name, words in DRIVES.items()
        ],
        "settings": form(),
    }


@router.post("/live")
def post_live(body: LiveRequest, bench: Bench, browser: Browser) -> dict[str, Any]:
    """The torque that the draft's model gives with these values."""
    draft = bench.sessions.draft(browser)
    id_ = body.recording or next(iter(draft["recordings"]), None)
    if id_ is None:
        raise RefusedError(400, "no recording is chosen; choose one")
    settings = settings_of(draft, ())
    inputs = bench.prepared(id_, settings)
    if settings.normalise is not None:  # the reference is that of all recordings
        _, every = prepared_draft(bench, draft)
        inputs = api.normalised(inputs, every[0].emg_reference)
    shown = live(
        inputs,
        draft,
        body.values,
        model=body.model,
        points=body.points,
        key=(id_, settings.prepared, settings.preparation, inputs.emg_reference),
    )
    return {"recording": id_, **shown}
