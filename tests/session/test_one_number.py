"""One leg's stiffness, asked for through every door: one value."""

import json
import re
from datetime import date
from pathlib import Path
from types import SimpleNamespace

import pytest

import surae
from surae.api.visits import visits_blocks
from surae.base.formatting import of_interval
from surae.report import part_of
from surae_workbench.live import judge
from surae_workbench.web.tasks import summary
from undrawn import blank_figures

pytestmark = pytest.mark.usefixtures("few")
STIFFNESS = "end_stiffness"


@pytest.mark.slow  # measures of two fits, drawn and compared
def test_one_legs_stiffness_is_one_value_through_every_door(done, run, monkeypatch) -> None:
    folder, result = done
    joint = result.joint
    lead = joint.measures()[STIFFNESS]
    shown = of_interval(lead.value, lead.ci95).value
    other = result.fits["walk 1"]

    measured = run("measures", folder, "--output", "m.json")
    written = json.loads(Path("m.json").read_text(encoding="utf-8"))["measures"][STIFFNESS]
    assert measured.code == 0
    with blank_figures():
        visits = [
            ("one", date(2026, 1, 1), "left", other),
            ("two", date(2026, 2, 1), "left", joint),
        ]
        compared = visits_blocks(visits, 0, 1)
    change = surae.change(other, joint).measures[STIFFNESS]
    Path("legs.csv").write_text(
        f"fit,subject\n{folder / 'joint.json'},S1\n{folder / 'joint.json'},S2\n"
    )
    member = surae.cohort("legs.csv").members[0]
    fitted = SimpleNamespace(fit=lambda: joint)
    monkeypatch.setattr(judge, "_session", lambda *_: fitted)
    monkeypatch.setattr(judge, "_next", lambda *_: {"next": [], "proposed": None})
    told = judge.together([], "live.json", "next.csv")
    doors = {
        "surae live": {row["name"]: row["value"] for row in told["measures"]}[STIFFNESS],
        "surae cohort": member.quantities.by_name[STIFFNESS].value,
        "Python": lead.value,
        "M.json": written["value"],
        "FIT.json": surae.load(folder / "joint.json").measures()[STIFFNESS].value,
        "surae change": change.after,
        "workbench, cohort": summary(joint)["measures"][STIFFNESS]["value"],
    }
    assert doors == pytest.approx(dict.fromkeys(doors, lead.value), rel=1e-9)
    assert (change.from_deg, change.to_deg) == pytest.approx((lead.from_deg, lead.to_deg))
    assert (written["from_deg"], written["to_deg"]) == (lead.from_deg, lead.to_deg)
    assert shown in measured.out
    assert re.search(rf": (roughly )?{re.escape(shown)} Nm/° \(", told["leg"][0])
    assert shown in joint.summary()
    assert f"{float(shown):.3g}" in part_of(**compared)
    headline = dict(result.answers())["How stiff is it?"]
    # what leads the page is this number, or the measured slope, which is called so
    page = part_of(**result.blocks())
    by_rest = of_interval(*slow) if (slow := leading_by_rest(joint)) else None
    led = shown if by_rest is None else by_rest.value
    assert headline.startswith(f"{led} Nm/°") or (by_rest is None and "measured slope" in page)


def leading_by_rest(fit):
    """Stiffness in a slow stretch at the angle nearest to 10° where rest tells it, its 95 %."""
    told = {
        float(m.name[15:-3]): m for m in fit.measures().values() if m.name[:15] == "slow_stiffness@"
    }
    known = [
        a for a, m in told.items() if m.basis == "rest" and m.verdict in ("identified", "weak")
    ]
    if not known:
        return None
    m = told[min(known, key=lambda angle: abs(angle - 10.0))]
    return m.value, m.ci95
