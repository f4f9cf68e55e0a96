"""Walking that was measured, with a virtual film of the gastrocnemius as an OpenSim .mot."""

from dataclasses import replace

import numpy as np
import pytest

import surae
from surae.frozen import read_only

SCALE, ZERO = 0.95, 4.0
SECONDS = 20.0


@pytest.fixture(scope="module")
def walk(shared, tmp_path_factory):
    """Twenty seconds of the treadmill; the fascicle is made of the measured angle and moment.

    Its tendon is straight, 250 N/mm, which is no curve of any model; the tracker drifts by 1 mm.
    """
    folder = tmp_path_factory.mktemp("walk")
    gait = surae.read(shared / "gait" / "walk36.toml")
    angle, torque = gait.channels["angle"], gait.channels["torque"]
    time = np.arange(2.0, 18.0, 0.02)
    theta, pull = (np.interp(time, c.time, c.values) for c in (angle, torque))
    arm = 0.0480 - 0.0104 * theta
    length = 1e3 * (0.118 - 1.67 * arm) - np.maximum(pull, 0.0) / arm / 250.0
    drift = np.sin(2 * np.pi * time / 11.0)
    rows = "".join(
        f"{t:.4f}\t{x:.5f}\n" for t, x in zip(time, SCALE * length + ZERO + drift, strict=True)
    )
    (folder / "fascicles.mot").write_text(
        f"fascicles\nversion=1\nnRows={len(time)}\nnColumns=2\ninDegrees=no\nendheader\n"
        f"time\tmed_gas_r\n{rows}"
    )
    text = (shared / "gait" / "walk36.toml").read_text(encoding="utf-8")
    text = text.replace('file = "', f'file = "{shared / "gait"}/')
    text += '[channels.fascicle_gm]\nfile = "fascicles.mot"\ncolumn = "med_gas_r"\nunit = "mm"\n'
    (folder / "walk.toml").write_text(text, encoding="utf-8")
    whole = surae.read(folder / "walk.toml")
    cut = {
        role: replace(c, time=read_only(c.time[c.time < SECONDS]),
                      values=read_only(c.values[c.time < SECONDS]))
        for role, c in whole.channels.items()
    }  # fmt: skip
    return replace(whole, channels=cut)


def test_a_film_of_walking_is_read_on_its_own_clock(walk) -> None:
    film = surae.prepare(walk).films[0]
    assert film.channel == "fascicle_gm"
    assert film.time[0] == pytest.approx(2.0)
    assert np.diff(film.time).max() == pytest.approx(0.02)
    assert 0.0 < film.length.min() < film.length.max() < 0.06


@pytest.mark.slow
def test_walking_and_its_film_are_fitted_together(walk) -> None:
    assert not [f for f in surae.check(walk).findings if f.channel == "fascicle_gm"]
    fit = surae.fit(walk, quality=())
    (film,) = fit.assessment.recordings[0].fascicles
    assert film.rmse_mm < 2.0
    stiff = fit.measures()["tendon_secant_tri"]
    assert stiff.ci95[0] < 250.0 < stiff.ci95[1]
