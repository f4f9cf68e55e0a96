"""A virtual leg walks as a measured one did, its gastrocnemius filmed: an OpenSim .mot."""

import numpy as np
import pytest

import surae
from ankle_legs.muscle import integrate
from ankle_legs.subject import draw

#: Frames a second, time of the first one on the recording's clock [s], and what a film shows:
#: scale, zero and the tracker's drift [mm].
RATE, FIRST, SCALE, ZERO, DRIFT = 50.0, 2.034, 0.95, 4.0, 1.0
SECONDS, RECORDED, STEP, DELAY = 20.0, 100.0, 5e-4, 0.04


@pytest.fixture(scope="module")
def leg():
    """The leg that walks, and whose parameters are known."""
    return draw(np.random.default_rng(731), "healthy")


def _muscles(leg, time, angle, efforts):
    """Lengths [m] and torque [Nm] of the leg that `ankle-legs` integrates."""
    fine = np.arange(0.0, time[-1], STEP)
    theta = np.interp(fine, time, angle)
    drive = np.stack([np.interp(fine - DELAY, time, effort) for effort in efforts])
    arm, path = leg.geometry.arm(theta), leg.geometry.path(theta)
    none = np.ones_like(fine), np.zeros_like(fine)
    lengths, forces, _ = zip(
        *(
            integrate(STEP, path[i], drive[i], *none, muscle.constants())
            for i, muscle in enumerate(leg.muscles())
        ),
        strict=True,
    )
    torque = arm[0] * forces[0] - arm[1] * forces[1]
    return fine, np.stack(lengths), torque


@pytest.fixture(scope="module")
def walk(leg, shared, tmp_path_factory):
    """Twenty seconds of the treadmill; the film is a .mot whose clock begins with it."""
    folder = tmp_path_factory.mktemp("walk")
    gait = surae.read(shared / "gait" / "walk36.toml").channels
    time = np.arange(0.0, SECONDS, 1.0 / RECORDED)
    angle = np.interp(time, gait["angle"].time, gait["angle"].values)
    emg = {
        role: np.interp(time, gait[role].time, gait[role].values)
        for role in ("emg_ta", "emg_gl", "emg_sol", "emg_gm")
    }
    calf = emg["emg_gl"] + 2.0 * emg["emg_sol"] + emg["emg_gm"]
    shin = emg["emg_ta"]
    efforts = 2500.0 * calf / np.percentile(calf, 99.0), 500.0 * shin / np.percentile(shin, 99.0)
    fine, lengths, torque = _muscles(leg, time, angle, efforts)
    rng = np.random.default_rng(731)
    table = {"time_s": time, "angle_rad": angle, "torque_Nm": np.interp(time, fine, torque)}
    table["torque_Nm"] += rng.normal(0.0, 1.0, time.size)
    table |= {f"{role}_V": values for role, values in emg.items()}
    np.savetxt(
        folder / "walk.csv",
        np.column_stack([*table.values()]),
        delimiter=",",
        header="# emg: envelope\n" + ",".join(table),
        comments="",
    )

    frames = np.arange(0.0, 15.0, 1.0 / RATE)
    length = SCALE * 1e3 * np.interp(frames + FIRST, fine, lengths[0]) + ZERO
    length += DRIFT * np.sin(2 * np.pi * frames / 11.0) + rng.normal(0.0, 0.1, frames.size)
    np.savetxt(
        folder / "fascicles.mot",
        np.column_stack([frames, length]),
        delimiter="\t",
        comments="",
        header=f"fascicles\nversion=1\nnRows={frames.size}\nnColumns=2\ninDegrees=no\nendheader\n"
        "time\tmed_gas_r",
    )

    channels = "".join(
        f'[channels.{name.rsplit("_", 1)[0]}]\nfile = "walk.csv"\ncolumn = "{name}"\n'
        f'unit = "{name.rsplit("_", 1)[1]}"\n'
        for name in list(table)[1:]
    )
    (folder / "walk.toml").write_text(
        f'name = "walk"\nemg = "envelope"\nfixed = {{ m = 0.0 }}\n{channels}'
        '[channels.fascicle_gm]\nfile = "fascicles.mot"\ncolumn = "med_gas_r"\nunit = "mm"\n'
        f"start_s = {FIRST}\n",
        encoding="utf-8",
    )
    return folder / "walk.toml", frames + FIRST, length


def test_a_film_of_walking_is_aligned_by_when_it_began(walk) -> None:
    mapping, time, length = walk
    film = surae.prepare(surae.read(mapping)).films[0]
    assert film.channel == "fascicle_gm"
    np.testing.assert_allclose(film.time, time, atol=1e-9)
    np.testing.assert_allclose(film.length, 1e-3 * length, atol=1e-9)


@pytest.mark.slow
def test_walking_and_its_film_are_fitted_together(walk, leg) -> None:
    recording = surae.read(walk[0])
    assert not [f for f in surae.check(recording).findings if f.channel == "fascicle_gm"]
    fit = surae.fit(recording, quality=())
    (film,) = fit.assessment.recordings[0].fascicles
    assert film.channel == "fascicle_gm"
    assert film.rmse_mm < DRIFT
    for name in ("l0_tri", "x0_tri", "dlt_tri", "f0"):
        low, high = fit.parameters[name].ci95
        assert low < leg.values[name] < high, name
