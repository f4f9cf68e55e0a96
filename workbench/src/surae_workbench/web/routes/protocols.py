"""The protocol designer: a motion before anybody is measured, its limits, what it will tell."""

import math
import time
from dataclasses import asdict
from typing import Any

from fastapi import APIRouter, Response

from surae import api
from surae.base.errors import InputError
from surae.base.names import FITTED
from surae.base.records import from_plain
from surae.base.words import N_, Message
from surae_workbench.web.answers import Job, Protocol
from surae_workbench.web.curves import plain
from surae_workbench.web.fits import model_title
from surae_workbench.web.form import fields
from surae_workbench.web.project import dated
from surae_workbench.web.routes.common import (
    CSV,
    ERRORS,
    Bench,
    Browser,
    csv_file,
    offer_deletion,
)
from surae_workbench.web.schemas import (
    ProtocolDesign,
    ProtocolFile,
    ProtocolPreview,
    ProtocolRequest,
    ProtocolSettings,
)

router = APIRouter(prefix="/api/protocols", responses=ERRORS, tags=["protocols"])

#: Points of a drawn curve.
_POINTS = 2000
#: Samples of the torque that the prediction is made of; more tell it nothing else.
_PREDICTED = 60_000
#: Legs that a preview is an average over.
_LEGS = 6
#: What the page opens on: within what its device can do.
_START = ProtocolPreview(
    settings=ProtocolSettings(
        profile="everything-35", chirp_amplitude=0.2, rate_hz=125.0, device="achilles"
    ),
    population="healthy",
    noise=0.5,
)


@router.get("/choices")
def get_choices() -> dict[str, Any]:
    """The profiles, tasks and devices."""
    return {
        "profiles": [
            {
                "name": r.name,
                "duration_s": r.seconds,
                "description": r.description,
                "designed": True,
            }
            for r in api.ready_protocols().values()
        ]
        + [
            {"name": choice.name, "duration_s": choice.duration, "description": choice.description}
            for choice in api.PROFILES.values()
        ],
        "tasks": [
            {"name": choice.name, "description": choice.description}
            for choice in api.TASKS.values()
        ],
        "devices": [asdict(choice) for choice in api.DEVICES.values()],
        "populations": ["healthy", "patient"],
        "models": [{"name": name, "title": model_title(name)} for name in FITTED.here()],
        "settings": fields(api.Protocol),
        "start": _START.model_dump(),
    }


@router.post("/preview")
def post_preview(body: ProtocolPreview) -> dict[str, Any]:
    """The motion, the effort, the limits, the coverage, and the standard errors to expect."""
    begin = time.perf_counter()
    settings = body.settings
    trajectory = trajectory_of(settings)
    if len(trajectory.time) > _PREDICTED:
        raise InputError(
            f"{len(trajectory.time)} samples at {settings.rate_hz:g} Hz are too many to predict "
            "from; use a rate of 125 Hz: it tells as much"
        )
    adaptation = trajectory.adaptation
    shown = api.extremes([trajectory.angle, trajectory.velocity], _POINTS)
    movement = {
        "t": plain(trajectory.time[shown]),
        "angle": plain(trajectory.angle[shown]),
        "velocity": plain(trajectory.velocity[shown]),
        "effort": [plain(trajectory.effort[shown, i]) for i in range(4)],
        "seconds": float(trajectory.time[-1]),
        "limits": limits(trajectory),
        "adaptation": [] if adaptation is None else [s.parts() for s in adaptation.steps],
        "prediction": None,
    }
    if not body.predict:
        return movement
    asked = body.model_dump(exclude={"settings", "predict"})
    expectation = api.expect(trajectory, legs=_LEGS, **asked)
    return movement | {
        "prediction": expectation.to_json() | {"identified": expectation.identified},
        "legs": expectation.legs.parts(),
        "caution": expectation.caution and expectation.caution.parts(),
        "notes": {name: p.note.parts() for name, p in expectation.parameters.items()},
        "milliseconds": round(1e3 * (time.perf_counter() - begin), 3),
    }


@router.post("/design", status_code=202)
def post_design(body: ProtocolDesign, bench: Bench, browser: Browser) -> Job:
    """Search a protocol of each duration; the answer is the job, which keeps them."""
    device = None if body.device is None else api.named_device(body.device)
    api.allowed_range(device, body.angle_range)
    lengths = ", ".join(f"{seconds:g}" for seconds in body.durations)
    task = body.model_dump(mode="json")
    return bench.jobs.submit("design", f"design of {lengths} s", browser, task, None)


@router.post("/csv", response_class=Response, responses=CSV)
def post_csv(body: ProtocolFile) -> Response:
    """The protocol as the file for a device, as `surae protocol` writes it.

    It is within the device's limits, or beyond them for a reason.
    """
    trajectory = trajectory_of(body.settings)
    reason = " ".join(body.reason.split())
    exceeded = [limit["text"] for limit in limits(trajectory) if limit["exceeded"]]
    if exceeded and not reason:
        raise InputError(
            f"{'; '.join(exceeded)}; nothing is exported without a reason: type it, or change this"
        )
    note = f"without limits: {reason}" if reason else ""
    name = body.name or body.settings.profile
    return csv_file(name, lambda path: api.write_protocol_csv(trajectory, path, note=note))


@router.get("")
def get_protocols(bench: Bench) -> dict[str, list[Protocol]]:
    """List the protocols that are kept."""
    return {"protocols": [Protocol(**dated(row)) for row in bench.database.all("protocol")]}


@router.post("", status_code=201)
def post_protocol(body: ProtocolRequest, bench: Bench) -> Protocol:
    """Keep a protocol."""
    trajectory_of(body.settings)
    id_ = bench.database.add("protocol", body.model_dump(mode="json"))
    bench.events.changed("protocols")
    return Protocol(**dated(bench.project.need("protocol", id_)))


offer_deletion(router, "/{id}", "protocol")


def trajectory_of(settings: ProtocolSettings) -> api.Trajectory:
    """The trajectory of some settings: a designed protocol, or a profile of the thesis."""
    device = None if settings.device is None else api.named_device(settings.device)
    if settings.plan is not None:
        limits = settings.limits or (*settings.angle_range, 1e6, 1e6)
        api.allowed_range(device, limits[:2])
        plan = settings.plan.model_dump(exclude={"model", "population"})  # whom it is for
        designed = from_plain(api.Plan, plan)
        return designed.trajectory(
            limits, settings.rate_hz, device=device, legs=settings.plan.model
        )
    if settings.profile in api.ready_protocols():
        reached = settings.angle_range
        return api.ready_trajectory(settings.profile, device, reached, settings.rate_hz)
    protocol = api.Protocol(profile=settings.profile, device=device, **settings.motion)
    return api.generate(protocol)


def limits(trajectory: api.Trajectory) -> list[dict[str, Any]]:
    """Every limit of the device, whether it is exceeded by those it is for, and by how much."""
    if trajectory.settings.device is None:
        return [{"text": N_("No device: no limit is kept"), "exceeded": True}]
    asked = [(_in_degrees(e.message), e.exceeded) for e in api.requested_limits(trajectory)]
    return [{"text": said, **said.parts(), "exceeded": exceeded} for said, exceeded in asked]


def _in_degrees(said: Message) -> Message:
    """A limit in the page's unit: devices and files have radians, pages degrees."""
    values = said.values
    if not str(values["unit"]).startswith("rad"):
        return said
    turned = {name: math.degrees(values[name]) for name in ("value", "limit")}
    unit = values["unit"].replace("rad", "°")
    return Message(said.code, said.worded, **{**values, **turned, "unit": unit})
