"""Benchmarks whose counts are published: what they write and count, on little."""

import json
from pathlib import Path
from types import SimpleNamespace

import numpy as np
import pytest

import surae
from ankle_legs.make import truth_of
from benchmark_files import load
from surae.protocol import Protocol, generate
from surae.recording import MUSCLES
from surae.studies import virtual_subject, virtual_trial

FOLDER = Path(__file__).parents[1] / "benchmarks"


@pytest.fixture
def bench(monkeypatch):
    """A benchmark as a module; it finds those beside it."""
    monkeypatch.syspath_prepend(FOLDER)
    return load


@pytest.fixture(scope="module")
def trial(tmp_path_factory):
    """Twenty seconds of a leg with rigid tendons, at 64 Hz."""
    motion = generate(
        Protocol(profile="multi-sine-holds", chirp_amplitude=0.2, duration=20.0, rate_hz=64.0)
    )
    made = virtual_trial(virtual_subject(3), motion)
    columns = {"time_s": made.time, "angle_rad": made.angle, "torque_Nm": made.torque}
    columns |= {f"emg_{m}_V": made.emg[:, i] for i, m in enumerate(MUSCLES)}
    path = tmp_path_factory.mktemp("trial") / "trial.csv"
    surae.write_csv(path, columns, ["emg: envelope"])
    return path


def test_both_plain_fits_find_what_muscle_finds(bench, trial) -> None:
    problem = surae.fit(trial, model="muscle", starts=1, quality=()).result.problem
    minimum, covariance = bench("baseline").fit(problem)
    lean = bench("lean").fit(problem)
    assert lean.cost == pytest.approx(minimum.cost, rel=1e-4)
    assert lean.x * problem.start == pytest.approx(minimum.x, rel=1e-2)
    assert (covariance.diagonal() > 0).all()


def test_the_plain_entrant_calls_identified_what_it_knows_to_ten_percent(
    bench, trial, monkeypatch, tmp_path, capsys
) -> None:
    challenge = bench("challenge")
    sd = np.full(15, 0.2)
    sd[0] = 0.01
    fitted = SimpleNamespace(x=np.ones(15)), np.diag(sd**2)
    monkeypatch.setattr(challenge, "plain_fit", lambda _: fitted)
    monkeypatch.setattr(challenge, "make", lambda *_: [trial])
    options = f"--families a --seeds 2001 --only plain --output {tmp_path}"
    monkeypatch.setattr("sys.argv", ["challenge.py", *options.split()])
    challenge.main()
    head, *rows = (tmp_path / "plain.csv").read_text().splitlines()
    assert head.startswith("family,seed,trial,parameter,value,low,high,verdict")
    assert [row.split(",")[7] for row in rows] == ["identified", *["weak"] * 14]
    assert rows[0].split(",")[:4] == ["a", "2001", "1", "m"]
    assert "measures" not in capsys.readouterr().out

    def singular(_):
        raise np.linalg.LinAlgError

    monkeypatch.setattr(challenge, "plain_fit", singular)
    assert challenge.plain(trial) == []


def test_raw_emg_is_thinned_and_counted_by_its_rate(bench, tmp_path, monkeypatch, capsys):
    raw = bench("raw_rates")
    path = tmp_path / "leg.csv"
    path.write_text("".join(f"{line}\n" for line in ("# emg: raw", "time_s", *range(7))))
    assert raw.thinned(path, 3).read_text().split("\n") == [
        "# emg: raw",
        "time_s",
        "0",
        "3",
        "6",
        "",
    ]
    told = {
        "k_tri": SimpleNamespace(name="k_tri", verdict="identified", ci95=(1.0, 2.0)),
        "k_tib": SimpleNamespace(name="k_tib", verdict="identified", ci95=(2.0, 3.0)),
        "m": SimpleNamespace(name="m", verdict="weak", ci95=(0.0, 9.0)),
    }

    def fit(_, model: str, **more: object) -> SimpleNamespace:
        grade = SimpleNamespace(r2=99.0 if model == "muscle" else 98.0)
        return SimpleNamespace(parameters=told, adequacy=grade, status="converged")

    monkeypatch.setattr(raw, "EVERY", (0, 2))
    monkeypatch.setattr(raw, "make", lambda *_, **__: [path])
    monkeypatch.setattr(raw, "truth_of", lambda *_: {"parameters": dict.fromkeys(told, 1.5)})
    monkeypatch.setattr("surae.fit", fit)
    monkeypatch.setattr("sys.argv", ["raw_rates.py", "--families", "a", "--seeds", "1"])
    raw.main()
    said = capsys.readouterr().out
    counted = "1 legs, identified 2, true 1; more than 0.5 points below muscle 1 (at most 1.00)"
    assert f"envelope: {counted}" in said
    assert f"512 Hz: {counted}" in said


def test_readme_shows_the_counts_that_were_made(bench) -> None:
    counts = bench("readme_counts")
    kept = json.loads(counts.KEPT.read_text(encoding="utf-8"))
    text = counts.README.read_text(encoding="utf-8")
    assert counts.MARKS[0] + counts.table(kept) + counts.MARKS[1] in text
    assert counts.written(text, kept) == text
    assert kept["surae"].rpartition(".")[0] == surae.__version__.rpartition(".")[0]


def test_counts_are_of_all_answers_and_invariants_apart(bench, tmp_path) -> None:
    counts = bench("readme_counts")
    truth = truth_of("p", 5, 1)
    m, gain = truth["parameters"]["m"], truth["measures"]["torque_gain_ta"]
    rows = [
        ("m", m, 0.9 * m, 1.1 * m, "identified"),
        ("f0", 99.0, 98.0, 100.0, "identified"),
        ("torque_gain_ta", gain, 0.8 * gain, 1.2 * gain, "weak"),
    ]
    lines = [",".join(map(str, ("p", 5, 1, *row))) for row in rows]
    head = "family,seed,trial,parameter,value,low,high,verdict"
    for entrant in ("plain", "muscle", "auto"):
        (tmp_path / f"{entrant}.csv").write_text("\n".join([head, *lines]), encoding="utf-8")
    made = counts.counted(tmp_path)
    of = {"legs": 1, "identified": 2, "true": 1, "hold": 1, "intervals": 2}
    assert made["auto parameters"] == of
    assert made["auto invariants"]["hold"] == made["auto invariants"]["intervals"] == 1
    assert made["auto parameters by family"] == {"p": [2, 1, 1, 2]}
    assert "| 100 % (2 of 2) | 50 % (1) | 50 % |" in counts.table(made)


@pytest.mark.slow
def test_the_counts_are_the_products(bench, tmp_path, monkeypatch) -> None:
    """One family counted again; numbers of another machine may differ by one."""
    counts = bench("readme_counts")
    kept = json.loads(counts.KEPT.read_text(encoding="utf-8"))
    family = kept["family"][0]
    options = f"--families {family} --seeds {','.join(kept['seed'])} --only auto"
    monkeypatch.setattr("sys.argv", ["challenge.py", *options.split(), "--output", str(tmp_path)])
    bench("challenge").main()
    for group, of in counts.groups(tmp_path / "auto.csv"):
        if f"auto {group} by family" in kept:
            total = counts.summed(counts.score(tmp_path / "auto.csv", of)[-1])
            own = [total.identified, total.true, total.hold, total.intervals]
            assert np.abs(np.subtract(own, kept[f"auto {group} by family"][family])).max() <= 1
