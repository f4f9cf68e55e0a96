import json

import pytest

import surae


@pytest.mark.usefixtures("undrawn")
def test_the_demo_finds_the_true_values_again(run, tmp_path) -> None:
    done = run("demo", "--output", "some/where")
    assert (done.code, done.err) == (0, "")
    folder = tmp_path / "some" / "where"
    assert {path.name for path in folder.iterdir()} == {"fit.json", "report.html", "true.json"}
    fit = surae.load(folder / "fit.json")
    truth = json.loads((folder / "true.json").read_text(encoding="utf-8"))["parameters"]
    intervals = {p.name: p.ci95 for p in fit.parameters.values() if p.ci95 is not None}
    inside = sum(low <= truth[name] <= high for name, (low, high) in intervals.items())
    assert inside >= len(intervals) - 4  # EMG noise biases what 95 % intervals do not know of
    assert f"{inside} of {len(intervals)} true values" in done.out
