"""A foot that stands, pushes and is turned: no slip of it and no reflex where there is none."""

import numpy as np
import pandas as pd

import surae


def stood_then_turned(
    draw: np.random.Generator, torque: float, stiffness: float, period: float = 14.0
) -> pd.DataFrame:
    """A foot that stands, pushes once, and is then turned; torque [Nm] and Nm/° are of 10°."""
    rate = 100.0
    time = np.arange(0.0, 60.0, 1.0 / rate)
    angle = 3.0 + 17.0 * np.sin(2.0 * np.pi * (time - 12.0) / period) * (time > 12.0)
    effort = np.exp(-(((time - 7.0) / 1.2) ** 2))
    volts = np.abs(draw.normal(0.0, 2e-6, (4, len(time)))) + 1e-6
    volts[1:] += 1e-4 * effort
    elastic = torque * np.exp(stiffness / torque * (angle - 10.0))
    measured = elastic + 25.0 * effort + draw.normal(0.0, 0.05, len(time))
    columns = {"time_s": time, "angle_rad": np.radians(angle), "torque_Nm": measured}
    names = ("emg_ta_V", "emg_gl_V", "emg_sol_V", "emg_gm_V")
    frame = pd.DataFrame(columns | dict(zip(names, volts, strict=True)))
    frame.attrs["emg"] = "envelope"
    return frame


def test_a_foot_that_stood_before_it_moved_did_not_slip() -> None:
    """Its whole curve was once taken for a slip by 17°, and what was left was called flat."""
    draw = np.random.default_rng(2004)
    for torque, stiffness in ((9.5, 0.54), (6.2, 0.35)):
        leg = surae.relaxed(stood_then_turned(draw, torque, stiffness))
        assert not [step for step in leg.curve.steps if step.kind == "slip"]
        m = leg.measures["passive_stiffness@10deg"]
        assert m.ci95_device[0] <= stiffness <= m.ci95_device[1]


def test_tissue_that_does_not_relax_has_no_reflex() -> None:
    """What is expected of relaxation was taken off again by a reflex that lessens the torque."""
    draw = np.random.default_rng(2004)
    leg = surae.relaxed(stood_then_turned(draw, 9.5, 0.54, period=24.0))
    assert "relaxed/reflex" not in [finding.code for finding in leg.curve.findings]
    assert leg.measures["passive_stiffness@10deg"].ci95_device[0] <= 0.54
