"""Geometry as data: splines, their derivatives, what is refused, and what a fit makes of it."""

import math
from dataclasses import replace

import numpy as np
import pandas as pd
import pytest

import surae
from surae.base.errors import InputError
from surae.base.records import from_plain
from surae.model import (
    GeometryTable,
    ModelOptions,
    adapted,
    get_model,
    read_geometry,
    with_optional,
)
from surae.model.geometry import paths
from surae.model.geometry_file import geometry_of_text
from surae.model.laboratory import laboratory
from surae.settings import FitSettings
from surae.signals.prepare import smoothed
from surae.signals.resample import thinned

pytestmark = pytest.mark.usefixtures("few")
DEGREES = np.arange(-60.0, 45.0, 5.0)
#: Arm of a triceps whose soleus and gastrocnemius heads have 5, 4 and 3 cm, by their areas.
GROUP = (51.8 * 0.05 + 21.1 * 0.04 + 9.7 * 0.03) / (51.8 + 21.1 + 9.7)


def table_of(options: ModelOptions, *, tolerance: float = 0.05, slack: bool = True):
    """The table that a geometry of the thesis is."""
    angle = np.radians(DEGREES)
    both = paths(angle=angle, velocity=np.zeros_like(angle), options=options)
    return GeometryTable(
        "thesis.csv",
        tuple(angle.tolist()),
        tuple(tuple(p.length.tolist()) for p in both),
        tuple(tuple(p.arm.tolist()) for p in both),
        tolerance,
        slack,
    )


def csv_of(table: GeometryTable, path, *notes: str):
    rows = ["angle_deg,length_tri_mm,arm_tri_mm,length_tib_mm,arm_tib_mm"]
    for i, angle in enumerate(table.angle):
        cells = [math.degrees(angle)]
        for group in (0, 1):
            cells += [1e3 * table.length[group][i], abs(1e3 * table.arm[group][i])]
        rows.append(",".join(f"{cell!r}" for cell in cells))
    path.write_text("\n".join([*notes, *rows]) + "\n", encoding="utf-8")
    return path


BENT = GeometryTable(
    "bent.csv",
    tuple(np.radians(DEGREES).tolist()),
    tuple(
        tuple((sign * (0.045 * a + 0.004 * np.sin(2 * a))).tolist())
        for a, sign in ((np.radians(DEGREES), 1.0), (np.radians(DEGREES), -1.0))
    ),
    tuple(
        tuple((sign * (0.045 + 0.008 * np.cos(2 * a))).tolist())
        for a, sign in ((np.radians(DEGREES), 1.0), (np.radians(DEGREES), -1.0))
    ),
)


def over_a_knee(folder, *notes):
    """A CSV over both angles, of which the knee shortens the gastrocnemius."""
    rows = ["angle_deg,second_angle_deg,length_tri_mm,length_tib_mm"]
    for degrees in DEGREES:
        for knee in (0.0, 20.0, 50.0, 90.0, 120.0):
            a, k = math.radians(degrees), math.radians(knee)
            triceps = 420 + 48 * a + 4 * math.sin(2 * a) - 9 * k - 3 * math.sin(k) + 1.5 * a * k
            rows.append(f"{degrees},{knee},{triceps!r},{260 - 40 * a + 3 * a * a!r}")
    (folder / "knee.csv").write_text("\n".join([*notes, *rows]), encoding="utf-8")
    return folder / "knee.csv"


@pytest.mark.parametrize("knee", [False, True])
@pytest.mark.parametrize("low", [-1.0, -2.0])  # within the table, and beyond its ends
def test_derivatives_are_those_of_small_steps(low, knee, tmp_path):
    angle, step = np.linspace(low, -0.6 * low, 41), 1e-6
    options = ModelOptions(geometry=read_geometry(over_a_knee(tmp_path)) if knee else BENT)
    bent = np.linspace(2.0, 0.1, 41)

    def at(by, knee_by):
        """Paths a step further, at an ankle's 2 and a knee's 3 rad/s."""
        second = (bent + knee_by, np.full_like(bent, 3.0)) if knee else ()
        velocity = np.full_like(angle, 2.0)
        return paths(angle=angle + by, velocity=velocity, options=options, second=second)

    steps = ((0.0, 0.0), (-step, 0.0), (step, 0.0), (0.0, -step), (0.0, step))
    for here, *near in zip(*(at(*by) for by in steps), strict=True):

        def small(of, first=0, near=near):
            return (getattr(near[first + 1], of) - getattr(near[first], of)) / (2 * step)

        for value, slope in (("length", "slope"), ("slope", "bend"), ("arm", "arm_slope")):
            np.testing.assert_allclose(getattr(here, slope), small(value), atol=2e-8)
        np.testing.assert_allclose(
            here.speed, 2.0 * here.slope + 3.0 * small("length", 2), atol=2e-8
        )
        np.testing.assert_allclose(small("speed"), 2.0 * here.bend + here.swept, atol=1e-7)


@pytest.mark.slow
def test_the_knee_is_read_fitted_and_kept(tmp_path):
    """A leg whose knee turns is got back with the knee, and not without."""
    path = over_a_knee(tmp_path)
    t = np.arange(0.0, 15.0, 0.01)
    columns = {"time_s": t, "angle_rad": 0.3 * np.sin(2.1 * t) + 0.1 * np.sin(5.0 * t)}
    columns["second_angle_deg"] = 50.0 + 30.0 * np.sin(1.3 * t + 1.0)
    for k, muscle in enumerate(("ta", "gl", "sol", "gm")):
        columns[f"emg_{muscle}_V"] = 1e-4 * np.clip(np.sin(0.9 * (k + 1) * t + k), 0, None)

    def recorded(torque, *without):
        table = pd.DataFrame(columns).assign(torque_Nm=torque).drop(columns=[*without])
        text = f"# emg: envelope\n{table.to_csv(index=False)}"
        (tmp_path / "trial.csv").write_text(text, encoding="utf-8")
        return surae.read(tmp_path / "trial.csv")

    options = ModelOptions(geometry=read_geometry(path))
    start = adapted(get_model("muscle").parameters, options)
    truth = {name: p.start for name, p in start.items()}
    torque = surae.simulate("muscle", truth, recorded(0.0), geometry=path)
    with pytest.raises(InputError, match="add its channel second_angle, or state"):
        surae.fit(recorded(torque, "second_angle_deg"), "muscle", geometry=path)
    raw = recorded(torque)
    fit = surae.fit(raw, "muscle", starts=1, geometry=path)
    assert fit.vaf > 99.99
    held = over_a_knee(tmp_path, "# second_angle_deg = 50")
    assert not read_geometry(held).second
    assert surae.fit(raw, "muscle", starts=1, geometry=held).vaf < fit.vaf - 0.1
    fit.save(tmp_path / "fit.json")
    loaded = surae.load(tmp_path / "fit.json")
    assert loaded.result.problem.inputs == fit.result.problem.inputs
    assert loaded.predict(raw).vaf == fit.predict(raw).vaf
    assert np.isfinite(loaded.measures(angles=[0.0])["passive_torque@0deg"].value)
    prepared = surae.prepare(raw)
    assert len(thinned(prepared, 2).second[0]) == prepared.n // 2
    assert np.ptp(smoothed(prepared).second[0]) < np.ptp(prepared.second[0])


def test_a_knee_needs_lengths_and_every_pair(tmp_path):
    path = over_a_knee(tmp_path)
    lines = path.read_text().splitlines()
    path.write_text("\n".join(lines[:-1]))
    with pytest.raises(InputError, match="104 rows of 21 angles and 5 second angles"):
        read_geometry(path)
    path.write_text("\n".join(lines).replace("length_tri", "arm_tri"))
    with pytest.raises(InputError, match=r"no length of tri .* a second angle needs"):
        read_geometry(path)


@pytest.mark.parametrize("of", ["arm_scale_tri", "length_zero_tib", "angle_zero", "l0_tri"])
@pytest.mark.parametrize("model", ["muscle", "muscle-tendon"])
def test_the_torque_over_a_table_has_exact_sensitivities(of, model, trial):
    spec = with_optional(get_model(model), [of])
    options = ModelOptions(geometry=BENT)
    start = {n: p.start for n, p in adapted(spec.parameters, options).items()}
    tied, column = spec.simulator(trial, options), spec.names.index(of)
    vector = spec.vector(start, options)
    _, (row,) = tied.torque_jacobian(vector, [column])
    step = 1e-6
    low, high = (tied.torque(vector + step * s * np.eye(len(vector))[column]) for s in (-1, 1))
    slope = (high - low) / (2 * step)
    np.testing.assert_allclose(row, slope, atol=2e-4 * np.abs(slope).max() + 1e-9)


@pytest.fixture(scope="module")
def trial():
    return thinned(surae.prepare(surae.example()), 4)


@pytest.mark.parametrize("geometry", ["thesis", "virtual-work"])
def test_a_table_of_the_thesis_gives_its_torque(geometry, trial):
    plain = ModelOptions(geometry=geometry)
    table = ModelOptions(geometry=table_of(plain))
    spec = get_model("muscle")
    starts = [adapted(spec.parameters, options) for options in (plain, table)]
    assert starts[0] == starts[1]
    vector = spec.vector({n: p.start for n, p in starts[0].items()}, plain)
    one, two = (spec.simulator(trial, options).torque(vector) for options in (plain, table))
    np.testing.assert_allclose(two, one, atol=1e-8)


@pytest.mark.usefixtures("undrawn", "few")
def test_a_file_is_read_and_kept_by_the_fit(tmp_path, trial):
    table = table_of(ModelOptions())
    notes = (
        "# source: van de Poll 2015",
        "# tolerance_mm = 50",
        "# slack_tri_mm=0",
        "# slack_tib_mm=0",
    )
    path = csv_of(table, tmp_path / "thesis.csv", *notes)
    read = read_geometry(path)
    assert read.source == "van de Poll 2015"
    np.testing.assert_allclose(read.length, table.length, atol=1e-15)
    np.testing.assert_allclose(read.arm, table.arm, atol=1e-15)
    plain = surae.fit(trial, model="muscle", starts=1)
    fit = surae.fit(trial, model="muscle", starts=1, geometry=path)
    for name, p in plain.parameters.items():
        assert fit.parameters[name].value == pytest.approx(p.value, rel=1e-5), name
    fit.save(tmp_path / "fit.json")
    loaded = surae.load(tmp_path / "fit.json")
    assert loaded.result.problem.options.geometry == read
    assert loaded.predict(trial).vaf == fit.predict(trial).vaf
    fit.report(tmp_path / "report.html")
    page = (tmp_path / "report.html").read_text(encoding="utf-8")
    assert "thesis.csv (van de Poll 2015), a generic one." in page
    assert page.count('alt="Moment arm and length of both muscle groups over the angle"') == 1
    measured = fit.measures(angles=[0.0])
    for name, measure in plain.measures(angles=[0.0]).items():
        if measure.value is not None:
            assert measured[name].value == pytest.approx(measure.value, rel=1e-3, abs=1e-6), name


def test_muscles_make_a_group_by_their_cross_section(tmp_path):
    path = tmp_path / "muscles.csv"
    head = "angle_rad,arm_sol_m,arm_gm_cm,arm_gl_mm,length_ta_m"
    rows = [f"{a},0.05,4,30,{0.3 - 0.04 * a}" for a in np.linspace(-1, 1, 9)]
    path.write_text("\n".join([head, *rows]))
    table = read_geometry(path)
    np.testing.assert_allclose(table.arm[0], GROUP)
    np.testing.assert_allclose(table.arm[1], -0.04, atol=1e-12)
    travel = table.length[0][-1] - table.length[0][0]
    assert travel == pytest.approx(2 * table.arm[0][0])
    assert not table.slack


def test_opensims_tables_are_one_geometry(tmp_path):
    """Lengths, moment arms and angles stand in three files, and muscles have names of its own."""
    angle = np.linspace(-30.0, 30.0, 13)
    rad, head = np.radians(angle), "{}\nversion=1\ninDegrees={}\nendheader\ntime\t{}\n"
    names = "soleus_r\tgasmed_r\tgaslat_r\ttibant_r\tother_r".replace("tibant", "tib_ant")
    slopes = np.array([0.05, 0.04, 0.03, -0.035, 0.01])

    def write(called, degrees, columns, rows):
        body = "\n".join("\t".join(map(str, (0.1 * i, *row))) for i, row in enumerate(rows))
        (tmp_path / called).write_text(head.format(called, degrees, columns) + body + "\n")

    write("leg_MuscleAnalysis_Length.sto", "no", names, 0.3 + rad[:, None] * slopes)
    lengths = tmp_path / "leg_MuscleAnalysis_Length.sto"
    with pytest.raises(InputError, match="run MuscleAnalysis and Kinematics together"):
        read_geometry(lengths)
    arms = np.tile(-slopes, (len(angle), 1))
    write("leg_MuscleAnalysis_MomentArm_ankle_angle_r.sto", "no", names, arms)
    coordinates = "knee_angle_r\tankle_angle_r"
    write("leg_Kinematics_q.sto", "yes", coordinates, np.stack([angle, angle], 1))
    with pytest.raises(InputError, match="13 rows of 13 angles and 13 second angles"):
        read_geometry(lengths)
    write("leg_Kinematics_q.sto", "yes", coordinates, np.stack([0 * angle, angle], 1))
    table = read_geometry(lengths)
    np.testing.assert_allclose(table.angle, rad, atol=1e-9)
    np.testing.assert_allclose(table.arm[0], GROUP)
    np.testing.assert_allclose(table.arm[1], -0.035)


@pytest.mark.parametrize(
    ("change", "said"),
    [
        ({"angle": BENT.angle[::-1]}, "must rise"),
        ({"length": BENT.length[::-1]}, "everywhere: turn the sign of the angle"),
        ({"tolerance": 1e-6}, "off the slope of length_tri"),
        ({"angle": BENT.angle[:3]}, "at least 4"),
        ({"second": (0.0, 1.0)}, "21 angles and 2 second ones"),
        (
            {"arm": (tuple(-a for a in BENT.arm[0]), BENT.arm[1])},
            "arm_tri has the wrong direction everywh",
        ),
        ({"length": ((math.nan, *BENT.length[0][1:]), BENT.length[1])}, "not finite"),
    ],
)
def test_what_is_no_geometry_is_refused(change, said):
    with pytest.raises(InputError, match=said) as refusal:
        replace(BENT, **change)
    assert "\n" not in str(refusal.value)


def test_a_movement_beyond_the_table_is_refused(trial):
    keep = slice(8, -4)  # −20° to 20°
    narrow = GeometryTable(
        "narrow.csv",
        BENT.angle[keep],
        tuple(r[keep] for r in BENT.length),
        tuple(r[keep] for r in BENT.arm),
    )
    with pytest.raises(InputError, match=r"known from -20° to 20°; give a table"):
        surae.fit(trial, model="muscle", geometry=narrow)


def turning(path, low):
    """A CSV whose triceps is shortest at an angle [deg], as `read_geometry` has it."""
    rows = ["angle_rad,length_tri_m,arm_tri_m,length_tib_m"]
    for a in np.radians(DEGREES):
        x = a - math.radians(low)
        rows.append(f"{a},{0.5 + 0.03 * x**2},{-0.06 * x},{0.3 - 0.04 * a}")  # OpenSim's sign
    path.write_text("\n".join(rows), encoding="utf-8")
    return read_geometry(path)


def test_a_path_may_turn_where_the_movement_does_not_go(tmp_path, trial):
    moved = np.degrees(trial.angle)
    beyond, within = (turning(tmp_path / "turning.csv", moved.min() + by) for by in (-4.0, 4.0))
    assert beyond.arm[0][0] < 0.0 < beyond.arm[0][-1]
    spec, options = get_model("muscle"), ModelOptions(geometry=beyond)
    vector = np.array([p.start for p in adapted(spec.parameters, options).values()])
    assert np.isfinite(spec.simulator(trial, options).torque(vector)).all()
    with pytest.raises(InputError, match=r"arm_tri turns round .* within the movement; leave"):
        surae.fit(trial, model="muscle", geometry=within)
    kept = trial.angle > np.radians(moved.min() + 8.0)
    part = replace(trial, weight=kept.astype(float))
    spec.simulator(part, ModelOptions(geometry=within))


def test_a_persons_own_geometry_narrows_what_is_believed():
    generic, own = laboratory(), laboratory(measured=True)
    narrower = {name for name in generic if own[name].sd < generic[name].sd}
    assert {"arm_slope_tri", "path_scale_tib"} <= narrower
    # one image tells a scale no better than methods agree, and no length
    others = {name for name in generic.keys() - narrower if own[name] != generic[name]}
    assert others == {"arm_scale_tri", "arm_scale_tib"}
    with pytest.raises(InputError, match="no effect without a geometry's file"):
        FitSettings.of(geometry_of="person")
    settings = FitSettings.of(geometry=BENT, geometry_of="person")
    assert from_plain(FitSettings, settings.as_dict()) == settings
    older = FitSettings().as_dict()
    del older["geometry_of"]
    assert from_plain(FitSettings, older) == FitSettings()


def _text(*, arm: float = 50.0, gear: float = 0.95, zero: float = 450.0, notes: str = "") -> str:
    """A geometry of constant arms [mm], whose muscles travel a part of them."""
    lines = [notes, "angle_deg,length_tri_mm,arm_tri_mm,length_tib_mm,arm_tib_mm"]
    for degrees in np.linspace(-50.0, 30.0, 17):
        turned = np.radians(degrees)
        tri, tib = zero + gear * 50.0 * turned, 300.0 - 0.95 * 40.0 * turned
        lines.append(f"{degrees},{tri},{arm},{tib},40")
    return "\n".join(filter(None, lines)) + "\n"


def test_lengths_that_contradict_their_arms_are_named_with_the_ratio() -> None:
    told = "# tolerance_mm = 60"  # what pennation leaves is for the file to state
    assert geometry_of_text("good.csv", _text()).arms_mm == pytest.approx((50.0, 40.0))
    with pytest.raises(InputError, match=r"\(lengths change by 0\.6 times the arm\)"):
        geometry_of_text("bad.csv", _text(gear=0.6))
    for gear in (0.25, 0.6, 1.2):
        geometry_of_text("good.csv", _text(gear=gear, notes=told))
    with pytest.raises(InputError, match=r"length of tri changes by 1\.67 times its moment arm"):
        geometry_of_text("bad.csv", _text(gear=1.67, notes=told))
    with pytest.raises(InputError, match=r"changes by -0\.6 times its moment arm.*signs"):
        geometry_of_text("bad.csv", _text(gear=-0.6, notes=told))


def test_an_arm_in_another_unit_and_a_length_of_another_zero_are_one_line() -> None:
    with pytest.raises(InputError, match=r"arm of tri is 5 mm; give it in the unit") as cm:
        geometry_of_text("bad.csv", _text(arm=5.0))
    with pytest.raises(InputError, match=r"moment arm of tri is 5e\+04 mm"):
        geometry_of_text("bad.csv", _text(arm=5e4))
    notes = "# slack_tri_mm = 395\n# slack_tib_mm = 216"
    geometry_of_text("good.csv", _text(notes=notes))
    with pytest.raises(InputError, match=r"less its slack length, tri is -4\d\d\.?\d* to") as zero:
        geometry_of_text("bad.csv", _text(zero=5.0, notes=notes))
    for refused in (cm, zero):
        assert "\n" not in str(refused.value)


def test_a_model_of_opensim_with_one_gastrocnemius_is_read(tmp_path) -> None:
    angle = np.linspace(-30.0, 30.0, 13)
    rad, head = np.radians(angle), "{}\nversion=1\ninDegrees={}\nendheader\ntime\t{}\n"
    names = "gas_r\tsol_r\ttib_ant_r"
    slopes = np.array([0.04, 0.05, -0.035])

    def write(called, degrees, columns, rows):
        body = "\n".join("\t".join(map(str, (0.1 * i, *row))) for i, row in enumerate(rows))
        (tmp_path / called).write_text(head.format(called, degrees, columns) + body + "\n")

    write("leg_MuscleAnalysis_Length.sto", "no", names, 0.3 + rad[:, None] * slopes)
    arms = np.tile(-slopes, (len(angle), 1))
    write("leg_MuscleAnalysis_MomentArm_ankle_angle_r.sto", "no", names, arms)
    write("leg_Kinematics_q.sto", "yes", "ankle_angle_r", angle[:, None])
    table = read_geometry(tmp_path / "leg_MuscleAnalysis_Length.sto")
    np.testing.assert_allclose(table.arm[0], (51.8 * 0.05 + 30.8 * 0.04) / 82.6)
