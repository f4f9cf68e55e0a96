"""One protocol asks one torque of a device, whichever door it is asked through."""

import re

import pytest

import surae
from surae import api
from surae.planning.torque import load_of
from surae_workbench.web.routes.protocols import limits


@pytest.mark.parametrize("name", ["everything-35", "compliant-35"])  # of rigid and yielding tendons
def test_torque_is_one_number_through_every_door(name, tmp_path) -> None:
    device = api.as_device("achilles")
    trajectory = api.ready_trajectory(name, device, api.allowed_range(device), 64.0)
    load = load_of(trajectory)
    most = max(map(abs, load.torque))
    asked = {limit.message.split()[0]: limit.value for limit in api.requested_limits(trajectory)}
    assert asked["torque"] == most
    (plan,) = (each["text"] for each in limits(trajectory) if "torque" in each["text"])
    assert plan.startswith(f"torque of virtual legs {most:.3g} Nm")
    api.write_protocol(trajectory, tmp_path / "p.csv")
    kept = load_of(api.read_protocol(tmp_path / "p.csv"))
    assert kept.torque == pytest.approx(load.torque, rel=1e-4)
    told = surae.expect(tmp_path / "p.csv", "muscle", legs=1)
    assert told.load is not None
    assert told.load.torque == kept.torque
    assert re.search(r"torque of virtual legs \S+ to (\S+) Nm", str(told)).group(1) == f"{most:.3g}"
    assert told.to_json()["load"]["torque"] == list(kept.torque)
