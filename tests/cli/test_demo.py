import json
from functools import partial

import pytest

import surae
from surae import api


@pytest.mark.usefixtures("undrawn")
@pytest.mark.parametrize("rate_hz", [32.0, pytest.param(256.0, marks=pytest.mark.slow)])
def test_the_demo_finds_the_true_values_again(run, tmp_path, monkeypatch, rate_hz) -> None:
    """All of it, and in the fast suite of an eighth of the samples."""
    monkeypatch.setattr(api, "Protocol", partial(api.Protocol, rate_hz=rate_hz))
    done = run("demo", "--output", "some/where")
    assert (done.code, done.err) == (0, "")
    folder = tmp_path / "some" / "where"
    assert {path.name for path in folder.iterdir()} == {"fit.json", "report.html", "true.json"}
    fit = surae.load(folder / "fit.json")
    truth = json.loads((folder / "true.json").read_text(encoding="utf-8"))["parameters"]
    intervals = {p.name: p.ci95 for p in fit.parameters.values() if p.ci95 and p.name in truth}
    inside = sum(low <= truth[name] <= high for name, (low, high) in intervals.items())
    assert inside >= len(intervals) - 4  # EMG noise biases what 95 % intervals do not know of
    assert f"{inside} of {len(intervals)} true values" in done.out
