"""A notebook feels at home: one screen, tables, plots, DataFrames in and out."""

import subprocess
import sys

import numpy as np
import pytest

import surae
from surae.base.errors import InputError
from surae.recording.dataframe import of_frame

pytestmark = pytest.mark.usefixtures("few")
pandas = pytest.importorskip("pandas")
xarray = pytest.importorskip("xarray")
matplotlib = pytest.importorskip("matplotlib")


@pytest.fixture(autouse=True)
def no_display():
    matplotlib.use("Agg")
    from matplotlib import pyplot

    yield
    pyplot.close("all")


@pytest.fixture(scope="module")
def trial(leg):
    return surae.read(leg / "walk 1.csv")


@pytest.fixture(scope="module")
def fit(trial):
    return surae.fit(trial, "muscle", prepared=True, starts=2)


def test_a_fit_is_one_screen(fit):
    lines = repr(fit).splitlines()
    assert repr(fit) == fit.summary() == str(fit)
    assert 15 < len(lines) < 40
    assert max(map(len, lines)) < 200
    assert any(line.startswith("l0_tri") and "optimal length" in line for line in lines)


def test_an_inadequate_fit_says_so_first(trial):
    """Its numbers mean nothing, and no line calls one identified."""
    time, angle = trial.channels["angle"].time, trial.channels["angle"].values
    other = np.random.default_rng(0).standard_normal(len(time))
    emg = np.stack([trial.channels[f"emg_{m}"].values for m in ("ta", "gl", "sol", "gm")], 1)
    noise = surae.Recording.from_arrays(time, angle, other, emg, emg_kind="envelope")
    fit = surae.fit(noise, "muscle", prepared=True, starts=1)
    assert "Inadequate" in fit.summary().splitlines()[1]
    assert "  identified" not in fit.summary()  # in the table of verdicts
    assert ">identified<" not in fit._repr_html_()


def test_the_html_asks_nothing_of_the_outside_and_escapes(fit, trial):
    html = fit._repr_html_()
    assert html.count("<tr>") == 1 + len(fit.parameters)
    assert "http" not in html
    assert "<script" not in html
    named = surae.fit(
        surae.Recording(name="<b>", channels=trial.channels, emg="envelope"),
        "muscle",
        prepared=True,
        starts=1,
    )
    assert "<b>:" not in named._repr_html_()


def test_the_parameters_as_a_table(fit):
    frame = fit.to_dataframe()
    p = fit.parameters["k_tri"]
    row = frame.loc["k_tri"]
    assert (row.value, row.low, row.high) == (p.value, *p.ci95)
    assert (row.unit, row.verdict, row.free) == ("1/m", str(p.verdict), True)
    assert list(frame.index) == list(fit.parameters)


def test_every_plot_gives_axes_and_takes_them(fit, monkeypatch):
    from matplotlib import pyplot
    from matplotlib.axes import Axes

    from surae.report import traces

    asked = []
    monkeypatch.setattr(
        traces, "traces_of", lambda r, of=traces.traces_of: asked.append(1) or of(r)
    )
    panels = fit.plot()
    assert asked == [1]  # the model is simulated once
    assert len(panels) == 4  # EMG, angle, torque and its parts
    assert len({panel.figure for panel in panels}) == 1
    assert isinstance(fit.plot.correlation(), Axes)
    for name in ("torque", "parts", "residuals"):
        made = getattr(fit.plot, name)()
        assert isinstance(made, Axes), name
        _, own = pyplot.subplots()
        assert getattr(fit.plot, name)(ax=own) is own
    measured = fit.plot.torque().lines[0]
    assert measured.get_label() == "measured"
    torque = fit.result.problem.inputs[0].torque
    assert measured.get_ydata().max() == pytest.approx(torque.max())
    residual = fit.plot.residuals().lines[0].get_ydata()
    assert residual.min() == pytest.approx(fit.result.residuals[0].min())
    with pytest.raises(InputError, match="the fit has no recording 3; they are numbered only 0"):
        fit.plot.torque(3)
    assert ".torque()" in repr(fit.plot)


def test_a_recording_to_a_table_and_back(trial):
    frame = trial.to_dataframe()
    assert list(frame.columns[:3]) == ["time_s", "angle_rad", "torque_Nm"]
    assert frame.attrs["units"]["emg_ta_V"] == "V"
    fitted = surae.fit(frame, "muscle", prepared=True, starts=1)
    assert fitted.values == surae.fit(trial, "muscle", prepared=True, starts=1).values
    assert surae.check(frame).findings == surae.check(trial).findings


def test_units_of_columns_from_their_names_or_beside(trial):
    frame = trial.to_dataframe()
    degrees = frame.assign(angle=np.rad2deg(frame.angle_rad), ms=1e3 * frame.time_s)
    degrees = degrees.drop(columns=["angle_rad", "time_s"]).rename(columns={"ms": "time_ms"})
    degrees.attrs = {"units": {"angle": "deg"}, "emg": "envelope"}
    by_index = degrees.set_index("time_ms")
    expected = surae.fit(trial, "muscle", prepared=True, starts=1).values["k_tri"]
    for table in (degrees, by_index):
        values = surae.fit(table, "muscle", prepared=True, starts=1).values
        assert values["k_tri"] == pytest.approx(expected, rel=1e-4)


@pytest.mark.parametrize(
    ("change", "says"),
    [
        (lambda f: f.drop(columns="time_s"), "no column is the time"),
        (lambda f: f.drop(columns="angle_rad"), "angle"),
        (lambda f: f.assign(torque_Nm="x"), "column 'torque_Nm' holds no numbers"),
        (lambda f: f.assign(torque_Nm=f.torque_Nm.where(f.index != 7)), "row 7"),
        (lambda f: f.assign(time_ms=f.time_s), "more than one column is the time"),
        (lambda f: f.assign(torque_mNm=f.torque_Nm), "is the torque too"),
    ],
)
def test_a_table_that_is_no_recording(trial, change, says):
    with pytest.raises(InputError, match=says):
        surae.fit(change(trial.to_dataframe()), "muscle")


def test_channels_of_several_rates_are_one_table():
    time = np.arange(100) / 100
    slow = surae.recording.Channel("angle", time[::2], np.sin(time[::2]), "rad", "x")
    fast = surae.recording.Channel("torque", time, np.cos(time), "Nm", "y")
    recording = surae.Recording("two", {"angle": slow, "torque": fast}, side="left")
    frame = recording.to_dataframe()
    assert frame.attrs["times"] == "own"
    assert (len(frame), frame.angle_rad.count(), frame.torque_Nm.count()) == (100, 50, 100)
    again = of_frame(frame)  # nothing is made up between the samples
    for role, channel in recording.channels.items():
        np.testing.assert_array_equal(again.channels[role].time, channel.time)
        np.testing.assert_array_equal(again.channels[role].values, channel.values)
    frame.attrs.pop("times")
    with pytest.raises(InputError, match="row 1"):
        of_frame(frame)


@pytest.mark.parametrize(
    "timed",
    [
        lambda f: f.assign(time_s=pandas.to_timedelta(f.time_s, unit="s")),
        lambda f: f.set_index(pandas.to_timedelta(f.time_s, unit="s")).drop(columns="time_s"),
        lambda f: f.set_index(pandas.TimedeltaIndex(f.time_s * 1e9)).drop(columns="time_s"),
        lambda f: f.set_index(
            pandas.Timestamp("2024-05-01") + pandas.to_timedelta(f.time_s.to_numpy(), unit="s")
        ).drop(columns="time_s"),
        lambda f: f.set_index("time_s"),
    ],
)
def test_time_stamps_are_time(trial, timed):
    made = of_frame(timed(trial.to_dataframe()))
    for role, channel in trial.channels.items():
        np.testing.assert_allclose(made.channels[role].time, channel.time, atol=2e-9)
        np.testing.assert_array_equal(made.channels[role].values, channel.values)


@pytest.mark.parametrize(
    ("change", "units", "says"),
    [
        (lambda f: f, {"angle_rad": "deg"}, r"in rad by its name, in deg by attrs"),
        (
            lambda f: f.rename(columns={"torque_Nm": "torque"}),
            None,
            r"'torque': its unit is missing",
        ),
        (lambda f: f.rename(columns={"torque_Nm": "torque"}), {"torque": "deg"}, "not known for"),
        (lambda f: f.rename(columns={"torque_Nm": "torque"}), {"torque": "lbf"}, "not known for"),
        (lambda f: f.assign(torque=f.torque_Nm), {"torque": "Nm"}, "are the same signal"),
        (lambda f: pandas.concat([f, f[["torque_Nm"]]], axis=1), None, "is there twice"),
        (lambda f: f.assign(torque_Nm=pandas.to_timedelta(f.torque_Nm)), None, "holds no numbers"),
        (lambda f: f, "Nm", "no table of units"),
    ],
)
def test_units_are_never_guessed_or_ignored(trial, change, units, says):
    frame = trial.to_dataframe()
    frame.attrs = {}
    frame = change(frame)
    frame.attrs = {"units": units}
    with pytest.raises(InputError, match=says):
        of_frame(frame)


def test_no_units_beside_are_none(trial):
    frame = trial.to_dataframe()
    frame.attrs = {"units": None, "emg": None}
    assert of_frame(frame).channels.keys() == trial.channels.keys()


def test_a_recording_is_one_screen(trial):
    lines = repr(trial).splitlines()
    assert len(lines) == 7
    assert "EMG envelopes" in lines[0]
    assert "torque" in lines[2]
    assert "Nm" in lines[2]


def test_the_example_as_object_and_file(tmp_path):
    recording = surae.example(tmp_path / "trial.csv")
    again = surae.read(tmp_path / "trial.csv")
    assert again.emg == recording.emg == "raw"
    for role, channel in recording.channels.items():
        np.testing.assert_array_equal(again.channels[role].values, channel.values)
        assert again.channels[role].unit == channel.unit


def test_nothing_of_it_is_loaded_before_it_is_used(leg):
    code = (
        f"import sys, surae; surae.read({str(leg / 'walk 1.csv')!r}); "
        "print(sorted({'pandas', 'xarray', 'matplotlib'} & set(sys.modules)))"
    )
    done = subprocess.run([sys.executable, "-c", code], capture_output=True, text=True, check=True)
    assert done.stdout.strip() == "[]"


def test_everything_that_is_given_back_says_in_a_few_lines_what_it_is(fit, trial, leg):
    answers = [
        trial,
        surae.check(trial),
        surae.inspect(leg / "walk 1.csv"),
        fit,
        fit.measures(),
        surae.prepare(trial, prepared=True),
        fit.predict(trial),
        surae.export(fit, to="osim"),
        surae.profile(fit, ["m"], workers=1),
        surae.posterior(fit, draws=20, evaluations=600),
        surae.expect("sine", "muscle", legs=3),
        surae.change(fit, leg_again(fit)),
        surae.design(20.0, model="muscle", evaluations=5),
        surae.measure_next(fit, angle_range=(-0.9, 0.6)),
    ]
    for answer in answers:
        text = repr(answer)
        assert len(text) < 10_000, type(answer)
        assert len(text.splitlines()) < 100, type(answer)
        assert "array(" not in text, type(answer)
        assert f"{type(answer).__name__}(" not in text


def leg_again(fit):
    """The same fit, another object."""
    return surae.Fit(fit.result, fit.assessment)


def test_names_lead_to_parameters_and_channels_and_slips_to_the_nearest(fit, trial):
    assert fit["l0_tri"] is fit.parameters["l0_tri"]
    assert trial["angle"] is trial.channels["angle"]
    for get, says in (
        (lambda: fit["l0_try"], "did you mean 'l0_tri'"),
        (lambda: trial["anlge"], "did you mean 'angle'"),
        (lambda: surae.fit(trial, "musle"), "did you mean 'muscle'"),
        (lambda: surae.fit(trial, "muscle", fixed={"l0_try": 0.1}), "did you mean 'l0_tri'"),
    ):
        with pytest.raises(InputError, match=says):
            get()
    with pytest.raises(InputError, match="'qqq'; it has"):
        fit["qqq"]


def test_correlations_have_labels(fit):
    names = fit.covariance.names
    assert list(fit.correlation.columns) == list(fit.correlation.index) == list(names)
    assert np.array_equal(fit.correlation.to_numpy(), fit.covariance.correlation)
    assert fit.correlation.loc["k_tri", "x0_tri"] == fit.correlation.loc["x0_tri", "k_tri"]


def test_a_part_of_a_recording_has_its_clock_and_predicts_alone(fit, trial):
    part = trial.crop(3.0, 9.0)
    inside = (trial["torque"].time >= 3.0) & (trial["torque"].time <= 9.0)
    assert np.array_equal(part["torque"].values, trial["torque"].values[inside])
    assert part["torque"].time[0] >= 3.0
    assert part.emg == trial.emg
    (predicted,) = surae.validate(fit, trial)
    assert predicted.vaf == surae.validate(fit, [trial])[0].vaf
    with pytest.raises(InputError, match=r"no two samples between 900 and 901 s; it lasts from"):
        trial.crop(900.0, 901.0)
