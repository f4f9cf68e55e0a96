import json

import numpy as np
import pytest

import surae

from .conftest import refused


def test_profiles_are_shown_and_written(run, files) -> None:
    done = run("profile", "fit.json", "m", "beta", "--output", "p.json")
    assert (done.code, done.err) == (0, "")
    fit = surae.load(files / "fit.json")
    expected = surae.profile(fit, ["m", "beta"], workers=1)
    content = json.loads((files / "p.json").read_text(encoding="utf-8"))
    assert list(content["profiles"]) == ["m", "beta"]
    for name, kept in content["profiles"].items():
        assert kept["interval"] == list(expected[name].interval)
        assert kept["delta_chi2"] == expected[name].chi2.tolist()
        low, high = kept["interval"]
        assert low < fit.values[name] < high
    lines = done.out.splitlines()
    assert lines[1].split("  ")[0] == "parameter"
    assert [line.split()[0] for line in lines[3:5]] == ["m", "beta"]
    assert "  closed  " in lines[3]
    noise = f"variance of the noise ×1: {fit.assessment.interval_note}"
    assert noise in lines
    assert content["variance_inflation_reason"] == fit.assessment.interval_note
    assert lines[-1] == "profiles: p.json"


def test_the_noise_is_what_the_residual_is_or_what_is_given(run, files) -> None:
    drifting = files / "drifting.csv"
    header, *rows = (files / "trial.csv").read_text(encoding="utf-8").splitlines()
    column, drift = header.split(",").index("torque_Nm"), 0.0
    noise, lines = np.random.default_rng(2), [header]
    for row in rows:
        cells, drift = row.split(","), 0.95 * drift + 0.1 * noise.standard_normal()
        cells[column] = repr(float(cells[column]) + drift)
        lines.append(",".join(cells))
    drifting.write_text("\n".join(lines) + "\n", encoding="utf-8")
    start = surae.load(files / "fit.json").values
    fit = surae.fit(drifting, "muscle", prepared=True, starts=1, start=start)
    fit.save(files / "drifting.json")
    assert fit.assessment.interval == "robust"

    done = run("profile", "drifting.json", "m", "g1", "--output", "p.json")
    assert "variance of the noise ×" in done.out
    assert ", by parameter: the residual is correlated over time (p" in done.out
    content = json.loads((files / "p.json").read_text(encoding="utf-8"))
    for name, profile in content["profiles"].items():
        p = fit.parameters[name]
        assert profile["variance_inflation"] == pytest.approx((p.sem_robust / p.sem) ** 2)
        assert profile["sem"] == pytest.approx(p.sem_robust, rel=1e-3)

    done = run("profile", "drifting.json", "m", "--variance-inflation", "2", "--output", "p.json")
    assert "variance of the noise ×2: given" in done.out
    content = json.loads((files / "p.json").read_text(encoding="utf-8"))
    assert content["profiles"]["m"]["variance_inflation"] == 2.0


def test_without_names_all_that_were_estimated(run, files) -> None:
    fitted = surae.fit(
        files / "trial.csv",
        "muscle",
        prepared=True,
        starts=1,
        fixed={k: v for k, v in surae.load(files / "fit.json").values.items() if k not in "m g1"},
        bounds={"m": (1.2, 1.3)},
    )
    fitted.save(files / "two.json")
    done = run("profile", "two.json", "--workers", "1")
    assert done.code == 0
    assert [line.split()[0] for line in done.out.splitlines()[3:5]] == ["m", "g1"]
    assert "m: open" in done.out  # it lies at its bound
    assert " open … " in done.out or "… open" in done.out


@pytest.mark.parametrize(
    ("arguments", "message"),
    [
        (["none.json"], "none.json"),
        (["fit.json", "nonsense"], "no parameter 'nonsense'; this fit estimated: m, k_tri"),
        (["fit.json", "m", "m"], "m is given twice"),
        (["fit.json", "--workers", "0"], "workers is 0; give at least 1"),
        (["fit.json", "--variance-inflation", "0"], "variance_inflation is 0.0; give more than 0"),
        (["fit.json", "--output", "fit.json"], "--output"),
        (["trial.csv"], "trial.csv"),
    ],
)
def test_wrong_use_is_one_line(run, files, arguments, message) -> None:
    refused(run("profile", *arguments), message)


def test_ctrl_c_keeps_what_is_complete(run, files, monkeypatch) -> None:
    from surae.api import profiled as home

    def interrupted(fit, names, *, progress, **options):
        def pressed(name: str, done: int, total: int) -> None:
            progress(name, done, total)
            raise KeyboardInterrupt

        return real(fit, names, progress=pressed, **options)

    real = home.profile
    monkeypatch.setattr(home, "profile", interrupted)
    done = run("profile", "fit.json", "m", "g1", "beta", "--workers", "1", "--output", "p.json")
    assert done.code == 130
    assert done.err == (
        "surae: stopped by the user; complete profiles are shown and written; not done: g1, beta\n"
    )
    content = json.loads((files / "p.json").read_text(encoding="utf-8"))
    assert list(content["profiles"]) == ["m"]
    assert content["missing"] == ["g1", "beta"]
    assert done.out.splitlines()[3].startswith("m ")
