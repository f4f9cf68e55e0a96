"""Another joint by a file: its numbers reach the model, and its words whatever is read."""

import ast
import re
from dataclasses import replace
from datetime import datetime
from functools import cache
from html import unescape
from pathlib import Path

import numpy as np
import pytest
from babel.messages.pofile import read_po
from matplotlib.text import Text

import surae
import surae.cli
from surae.base.errors import InputError
from surae.cli.screen import show_fit
from surae.inference import AssessedFit, assess
from surae.inference.least_squares.contradiction import contradiction
from surae.model import ModelOptions, adapted, get_model, read_geometry
from surae.model.joint import ANKLE, STATED, read_joint
from surae.model.laboratory import laboratory
from surae.model.movement import gravity_torque
from surae.report.figures.torque import torque_figure
from surae.report.fit import fit_report
from surae.report.language import catalogue, words_in
from surae.report.traces import traces_of

NOW = datetime(2026, 1, 5, 14, 3)
pytestmark = pytest.mark.usefixtures("few")
FILES = Path(__file__).parents[2] / "examples" / "wrist"
WRIST = {"joint": str(FILES / "joint.toml"), "geometry": str(FILES / "geometry.csv")}
TRUTH = {
    "m": 0.5,
    "k_tri": 160.0,
    "k_tib": 140.0,
    "x0_tri": 0.043,
    "x0_tib": 0.046,
    "tau_rel": 2.0,
    "k_rel": 0.3,
    "g1": 5e5,
    "g2": 3e5,
    "g3": 6e5,
    "g4": 0.0,
    "l0_tri": 0.062,
    "l0_tib": 0.064,
    "f0": 2.2,
    "beta": 1.0,
}
#: What nobody may read of a wrist.
OF_THE_ANKLE = re.compile(
    r"\b(ankles?|foot|feet|footplate|legs?|calf|calves|shank|heel|sole|triceps|tibialis|soleus"
    r"|gastrocnemi\w*|Achilles|dorsiflex\w+|plantar|dorsal)\b",
    re.IGNORECASE,
)
TRANSLATED = re.compile(
    r"\b(enkels?|kuit\w*|dorsa\w*|planta\w*|benen|been|voet\w*|soleus|gastrocnem\w*|Sprunggelenk\w*"
    r"|Wade\w*|Beine?|Beins|Fuß\w*|chevilles?|mollet|tibial|soléaire|jambes?|pieds?)\b",
    re.IGNORECASE,
)
#: Whom norms are of, which another joint has not.
NORMS = {
    "nl": ["spastische enkels na een beroerte"],
    "de": ["spastische Sprunggelenke nach Schlaganfall"],
    "fr": ["chevilles spastiques après AVC"],
}


@pytest.fixture(scope="module")
def trial():
    pandas = pytest.importorskip("pandas")
    t = np.arange(0.0, 24.0, 0.01)
    angle = 0.38 * np.sin(0.6 * t) + 0.2 * np.sin(2.3 * t + 1.0) + 0.1 * np.sin(5.1 * t)
    columns = {"time_s": t, "angle_rad": angle, "torque_Nm": 0.0, "emg_gm_V": 0.0}
    for muscle, period, begin in (("ta", 5.0, 0.0), ("gl", 7.0, 2.0), ("sol", 6.0, 3.5)):
        columns[f"emg_{muscle}_V"] = 2e-4 * np.clip(np.sin(6.28 * (t - begin) / period), 0, 1) ** 2
    table = pandas.DataFrame(columns)
    torque = surae.simulate("muscle", TRUTH, table, **WRIST)
    noise = 0.02 * np.random.default_rng(1).standard_normal(len(t))
    return table.assign(torque_Nm=torque + noise).drop(columns="emg_gm_V")


def read_of(path) -> str:
    """What a page says: no styles, no scripts, no images, and not the title of the thesis."""
    page = path.read_text(encoding="utf-8")
    page = re.sub(r"<script.*?</script>|<style.*?</style>|data:[^\"]*", "", page, flags=re.DOTALL)
    return unescape(re.sub(r"<[^>]+>", " ", page)).replace("Estimating ankle muscle", "")


@pytest.fixture(scope="module")
def fit(trial):
    return surae.fit(trial, "muscle", prepared=True, starts=1, **WRIST)


def test_its_muscles_are_found(fit) -> None:
    for name in ("k_tri", "x0_tri", "x0_tib", "l0_tri", "l0_tib", "g1", "g2", "g3"):
        assert fit.values[name] == pytest.approx(TRUTH[name], rel=0.05)
    assert fit.parameters["g4"].verdict == "fixed"
    assert not [f for q in fit.quality for f in q.findings if f.channel == "emg_gm"]


def test_a_model_with_tendons_is_not_said_to_lack_tendons(trial) -> None:
    """The joint's own priors of tendons do not make another model of it."""
    off = trial.assign(torque_Nm=trial["torque_Nm"] + 1.5)
    lacking = {}
    for model in ("muscle", "muscle-tendon-strain"):
        found = contradiction(surae.fit(off, model, prepared=True, starts=1, **WRIST).result)
        assert found is not None
        lacking[model] = found.missing
    assert lacking["muscle"] == ("zero", "delay", "crosstalk", "tendons")
    assert lacking["muscle-tendon-strain"] == ("zero", "delay", "crosstalk")


def test_its_file_keeps_the_joint(fit, tmp_path) -> None:
    fit.save(tmp_path / "fit.json")
    again = surae.load(tmp_path / "fit.json")
    assert again.result.problem.options.anatomy == read_joint(WRIST["joint"])
    assert again.values == fit.values
    assert "joint" not in ModelOptions().as_dict()


@pytest.mark.usefixtures("undrawn")
def test_nothing_that_is_read_speaks_of_an_ankle(fit, tmp_path, capsys) -> None:
    fit.report(tmp_path / "fit.html")
    text = read_of(tmp_path / "fit.html")
    told = [*text.split("."), *str(fit.summary()).splitlines()]
    told += [
        f"{p.meaning} {p.advice}"
        for p in adapted(get_model("muscle-tendon").parameters, fit.result.problem.options).values()
    ]
    fit.save(tmp_path / "fit.json")
    surae.cli.group.main(["measures", str(tmp_path / "fit.json")], standalone_mode=False)
    measured = capsys.readouterr().out
    assert "healthy adults" not in measured
    told += measured.splitlines()
    show_fit(fit)
    told += capsys.readouterr().out.splitlines()
    assert [line for line in told if OF_THE_ANKLE.search(line)] == []
    assert "wrist flexors" in text
    labels = {text.get_text() for text in torque_figure(*traces_of(fit.result)).findobj(Text)}
    assert "Wrist angle, extension positive" in labels
    assert not list(filter(OF_THE_ANKLE.search, labels))


#: Literals that nobody reads: keys, and what names in files are recognised by; and the source of a
#: prior that is about heels.
UNREAD = {
    ("quality/torque.py", "achilles"),
    ("model/source_table.py", "heel"),
}


@cache
def literals_of(package):
    """File, line and text of every string of a package that documents nothing."""
    return [*_literals_of(package)]


def _literals_of(package):
    for path in sorted((Path(surae.__file__).parent / package).rglob("*.py")):
        if path.name == "joint.py" and package == "model":
            continue  # the ankle's own record
        tree = ast.parse(path.read_text(encoding="utf-8"))
        spoken = {id(n.value) for n in ast.walk(tree) if isinstance(n, ast.Expr)}
        for node in ast.walk(tree):
            text = getattr(node, "value", None)
            if isinstance(node, ast.Constant) and isinstance(text, str) and id(node) not in spoken:
                yield f"{package}/{path.name}", node.lineno, text


@pytest.mark.parametrize(
    "package", ["model", "inference", "measures", "exchange", "quality", "report"]
)
def test_every_word_of_the_ankle_has_another_joints_in_its_place(package) -> None:
    wrist = read_joint(WRIST["joint"])
    left = [
        (file, line, word.casefold())
        for file, line, text in literals_of(package)
        for word in OF_THE_ANKLE.findall(wrist.worded(text))
    ]
    assert [each for each in left if (each[0], each[2]) not in UNREAD] == []


def test_its_model_file_has_its_names_and_the_point_of_its_mass(fit) -> None:
    text = surae.export(fit, to="osim").text
    assert 'name="wrist_flexors"' in text
    assert "/jointset/wrist/wrist_angle" in text
    assert not OF_THE_ANKLE.search(text)
    assert "<mass_center>0.07 " in text


def test_its_constants_reach_the_model(fit) -> None:
    wrist, options = read_joint(WRIST["joint"]), fit.result.problem.options
    table = adapted(get_model("muscle-tendon").parameters, options)
    for name in STATED:
        assert (table[name].start, table[name].upper) == (
            wrist.parameters[name].start,
            wrist.parameters[name].upper,
        )
    assert adapted(
        get_model("muscle-tendon").parameters, replace(options, tendon_strain="slack-length")
    )["dlt_tib"].start == pytest.approx(0.05)
    assert laboratory(joint=wrist)["torque_zero"].sd == 0.5
    assert laboratory({"zero": (0.0, 3.0)}, joint=wrist)["torque_zero"].sd == 3.0
    inputs = fit.result.problem.inputs[0]
    parts = get_model("muscle").simulator(inputs, options).parts(np.array([*TRUTH.values()]))
    expected = gravity_torque(angle=inputs.angle, theta_foot=0.0, distance=0.07)[0]
    np.testing.assert_allclose(parts.gravitational, TRUTH["m"] * expected)


def test_words_keep_their_capitals() -> None:
    wrist = read_joint(WRIST["joint"])
    assert wrist.worded("Ankle angle of the foot plate") == "Wrist angle of the hand plate"
    assert wrist.worded("more dorsiflexion of the triceps") == "more extension of the flexors"
    assert ANKLE.worded("Ankle") == "Ankle"


@pytest.mark.usefixtures("undrawn")
def test_what_users_gave_stays_as_it_is(fit) -> None:
    _, name = words_in("en", read_joint(WRIST["joint"])), "Ms. Foot, left leg"
    assert _("The ankle of {leg}", leg=name) == f"The wrist of {name}"
    assert _.many("{n} leg: {what}", "{n} legs: {what}", 2, what=name) == f"2 arms: {name}"
    problem = fit.result.problem
    inputs = [replace(own, name=f"{name}, ankle clinic leg 7.csv") for own in problem.inputs]
    result = replace(fit.result, problem=replace(problem, inputs=tuple(inputs)))
    heading = fit_report(
        AssessedFit(result, assess(result)), versions={}, created=NOW
    ).document.heading
    assert heading == f"{name}, ankle clinic leg 7.csv"


@pytest.mark.parametrize(
    ("line", "by", "message"),
    [
        ("distance = 0.07 ", "distance = 0.0 ", "distance and slack must be positive"),
        ("m = {", "mm = {", "parameters: m missing"),
        ("start = 0.6,", "start = 9.0,", "m must be above zero and within its bounds"),
        ('limb = "hand"', "", "limb: it is missing|missing"),
        ('limb = "hand"', "limb = ", "not valid TOML"),
    ],
)
def test_what_is_no_joint_is_refused(tmp_path, line, by, message) -> None:
    text = (FILES / "joint.toml").read_text(encoding="utf-8")
    assert line in text
    (tmp_path / "joint.toml").write_text(text.replace(line, by, 1), encoding="utf-8")
    with pytest.raises(InputError, match=message):
        read_joint(tmp_path / "joint.toml")


def test_another_joint_needs_its_geometry() -> None:
    with pytest.raises(InputError, match="joint 'wrist' needs its geometry"):
        ModelOptions.of(joint=WRIST["joint"])
    with pytest.raises(InputError, match="populations are known of the ankle alone"):
        surae.expect("multi-sine", model="muscle", **WRIST)


@pytest.mark.usefixtures("undrawn")
def test_a_session_and_its_page_are_of_the_joint(trial, tmp_path) -> None:
    half = len(trial) // 2
    for name, part in (("first", trial[:half]), ("second", trial[half:])):
        shifted = part.assign(time_s=part.time_s - part.time_s.iloc[0])
        shifted.to_csv(tmp_path / f"{name}.csv", index=False)
    session = surae.session([tmp_path / "first.csv", tmp_path / "second.csv"], side="left")
    result = session.run(tmp_path / "out", model="muscle", prepared=True, starts=1, **WRIST)
    assert set(result.fits) == {"first", "second"}
    table = read_geometry(WRIST["geometry"])
    for fit in (*result.fits.values(), result.joint):
        assert fit.result.problem.options.geometry == table
        assert fit.result.problem.options.anatomy.name == "wrist"
    assert result.joint.values["l0_tri"] == pytest.approx(TRUTH["l0_tri"], rel=0.05)
    said = read_of(tmp_path / "out" / "report.html")
    assert [line for line in said.split(".") if OF_THE_ANKLE.search(line)] == []


@pytest.mark.parametrize("language", ["nl", "de", "fr"])
def test_every_translated_word_of_the_ankle_has_another_joints_in_its_place(language) -> None:
    wrist = read_joint(WRIST["joint"])
    rooms = ("base", "inference", "measures", "report")  # the workbench's messages are of any leg
    of_legs = {"Limb", "Legs"}  # the parameters' heading, and the cohort's, which is of legs
    own = {text for room in rooms for *_, text in literals_of(room)} - of_legs
    with catalogue(language).open("rb") as file:
        said = [m for m in read_po(file) if m.id and np.atleast_1d(m.id)[0] in own]
    # what rest tells is told of the ankle alone
    said = [m for m in said if not np.atleast_1d(m.id)[0].startswith(("relaxed/", "rest/"))]
    # what other programs' muscles are held against: dissected legs
    said = [m for m in said if "dissected legs" not in np.atleast_1d(m.id)[0]]
    texts = [text for m in said for text in np.atleast_1d(m.string)]
    worded = {text: wrist.worded(str(text), language) for text in texts}
    assert [text for text in texts if TRANSLATED.search(worded[text])] == NORMS[language]
    with pytest.raises(InputError, match=r"no words in 'nl'; give \[words.nl\]"):
        replace(wrist, words={}).worded("de enkel", "nl")
