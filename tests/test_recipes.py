"""The recipes of CONTRIBUTING, followed in a copy of the tree with the files that each names."""

import json
import os
import re
import shutil
import subprocess
import sys
from pathlib import Path

import pytest

import surae
from surae.protocol import Protocol, generate
from surae.recording import MUSCLES
from surae.studies import virtual_subject, virtual_trial

PACKAGE = Path(surae.__file__).parent
ROOT = PACKAGE.parents[1]
RECIPES = (ROOT / "CONTRIBUTING.md").read_text(encoding="utf-8")
ENGLISH = "report/locale/en/LC_MESSAGES/surae.po"
FRICTION = """    UncertaintySource(
        "friction", "friction", "what the bearings of the device take",
        N_("run the device without a foot, and take its friction away"),
        Fill("ink", "\\\\"),
        Nuisance(
            "friction", OPTIONAL["friction"], Gaussian(0.0, 1.0), "Nm", "up to 1 Nm; assumed",
        ),
    ),
"""
SCALE = """    UncertaintySource(
        "scale", "scale of the torque", "what the calibration of the sensor leaves",
        N_("calibrate the torque sensor with weights"), Fill("ink", "x"),
    ),
"""
SPRING = '''"""Springs and motors: forces that the muscles' lengths hardly change."""

import numpy as np

from surae.model.parameters import SPRING_PARAMETERS
from surae.model.recorded_model import Simulator

_NAMES = tuple(p.name for p in SPRING_PARAMETERS)


class SpringSimulator(Simulator):
    """Linear springs on one recording."""

    def __init__(self, inputs, options, optional=()):
        weights = ("g1", "g2", "g3", "g4")
        super().__init__(inputs, options, names=_NAMES, optional=optional, weights=weights)

    def _forces(self, p, group, muscle, active):
        return np.stack([p[1 + group] * muscle.length, active.alpha[0]])

    def _contract(self, p, group, muscle, active, into):
        force = p[1 + group] * muscle.length + active.alpha[0]
        torque, jacobian = into.torque, into.jacobian
        torque += muscle.arm * force
        jacobian[into.slots[1 + group]] += muscle.arm * muscle.length
        for slot, slope in zip(into.slots[active.columns], active.slopes[:, 0], strict=True):
            jacobian[slot] += muscle.arm * slope
'''
#: By recipe: file, the line before which the text stands, and the text; without a line, a new file.
ADDED: dict[str, list[tuple[str, str, str]]] = {
    "a model": [
        ("model/spring.py", "", SPRING),
        (
            "model/parameters.py",
            "#: Crosstalk: part",
            """\
SPRING_PARAMETERS: tuple[Parameter, ...] = (
    MUSCLE_PARAMETERS[0],
    _P("s_tri", "N/m", "spring of the triceps", "passive", 1e3, 0.0, 1e5, False, advice=_HOLD),
    _P("s_tib", "N/m", "spring of the tibialis", "passive", 1e3, 0.0, 1e5, False, advice=_HOLD),
    *(p for p in MUSCLE_PARAMETERS if p.name in ("g1", "g2", "g3", "g4", "f0", "beta")),
)
""",
        ),
        ("model/registry.py", "    OPTIONAL_PARAMETERS,", "    SPRING_PARAMETERS,\n"),
        (
            "model/registry.py",
            "        ModelSpec(",
            """        ModelSpec(
            "spring", "springs", SPRING_PARAMETERS, tuple(p.name for p in SPRING_PARAMETERS),
            "surae.model.spring:SpringSimulator", linear=("m", "s_tri", "s_tib", *_WEIGHTS),
        ),
""",
        ),
        ("base/names.py", '"muscle-tendon-toe"', '"spring", '),
    ],
    "a parameter": [
        (
            "model/parameters.py",
            '    "crosstalk": tuple(',
            """    "viscosity": (
        _P("viscosity", "Nm·s/rad", "viscosity of the joint", "passive", 0.0, 0.0, 20.0, False,
           straight=True, wide=Prior(0.5, 1.0, "assumed; no measurement known"),
           torque=Added("inertial", attrgetter("velocity")),
           advice="move the relaxed leg at several speeds"),
    ),
""",
        ),
        ("base/names.py", "LOSSES = (", 'DRIVES |= {"viscosity": "viscosity of the joint"}\n'),
    ],
    "something that the laboratory cannot rule out": [
        (
            "model/parameters.py",
            '_GEOMETRY = N_("give',
            """\
def _direction(inputs: "ModelInputs") -> FloatArray:
    return np.sign(inputs.velocity)


""",
        ),
        (
            "model/parameters.py",
            '    "plate_give": (',
            """    "friction": (
        _M("friction", "Nm", "friction of the device", 0.0, 5.0,
           "run the device without a foot, and take its friction away",
           Added("zero", _direction)),
    ),
""",
        ),
        ("model/source_table.py", "    UncertaintySource(", FRICTION),
    ],
    "a source of uncertainty that nothing is estimated for": [
        ("model/source_table.py", "    UncertaintySource(", SCALE),
        (
            "inference/uncertainty/combined.py",
            "    made = Uncertainty(",
            '    rows["scale"] = 0.005 * values[None, :]\n',
        ),
    ],
    "a finding": [
        ("quality/finding.toml", "torque-sign = ", 'torque-still = ["error", "Nm"]\n'),
        (
            ENGLISH,
            'msgid "found/torque-unit"',
            """\
msgid "kind/torque-still"
msgstr "torque that never changes"

msgid "found/torque-still"
msgstr "The torque never changes."

msgid "advice/torque-still"
msgstr "Connect the torque sensor, and record again."

""",
        ),
        (
            "quality/torque.py",
            "def limit(",
            '''\
def still(trial: CheckedTrial) -> Iterator[Finding]:
    """A torque that never changes."""
    if trial.torque is None:
        raise Unjudged("There is no torque.")
    if np.ptp(trial.torque) == 0.0:
        value = float(trial.torque[0])
        span = trial.time[0], trial.time[-1]
        yield make_finding("torque-still", "torque", span, value)


''',
        ),
        (
            "quality/registry.py",
            '    Check(("torque-sign",)',
            '    Check(("torque-still",), torque.still),\n',
        ),
    ],
    "a measure": [
        (
            "measures/passive.py",
            "def relaxed_share(",
            '''\
def slack_span(leg: Leg, _: float) -> float:
    """Angle over which neither muscle pulls.

    slack_angle_tri − slack_angle_tib.
    """
    return slack_angle(leg, 0.0, "tri") - slack_angle(leg, 0.0, "tib")


''',
        ),
        (
            "measures/table.py",
            '    _D("relaxed_share"',
            '    _D("slack_span", "deg", passive.slack_span, is_angle=True),\n',
        ),
    ],
    "a reason against a fit": [
        (
            ENGLISH,
            'msgid "against/unchanging"',
            """\
msgid "against/brief"
msgstr "the trial lasts {seconds:.0f} s"

msgid "plainly/brief"
msgstr "the trial is brief"

""",
        ),
        (
            "inference/judging/of_fit.py",
            "def _unlike(",
            '''\
def _brief(result: FitResult) -> Iterator[Reason]:
    """What lasts a few seconds shows no relaxation."""
    seconds = sum(own.n / own.rate_hz for own in result.problem.inputs)
    if seconds < 15.0:
        yield against("brief", seconds=seconds)


''',
        ),
        (
            "inference/judging/of_fit.py",
            "    yield from _unlike(result, odd)",
            "    yield from _brief(result)\n",
        ),
    ],
    "a verdict": [
        ("inference/judging/verdict.py", '    FIXED = "fixed"', '    HEARSAY = "hearsay"\n'),
        (
            "inference/judging/parameter.py",
            "    relative = half / abs(value) if value else np.inf",
            """\
    if name == "tau_rel":
        return Verdict.HEARSAY, "as somebody said"
""",
        ),
        (
            "base/words.py",
            '    "fixed": Judgement(',
            '    "hearsay": Judgement("quiet", N_("hearsay")),\n',
        ),
    ],
    "a reader": [
        (
            "recording/bars.py",
            "",
            '''\
"""Columns between bars, the first line ``|bars``; the first column is the time."""

import numpy as np

from surae.base.errors import InputError
from surae.recording.table import Column, Table


def recognises(source):
    """Whether it begins as these files do."""
    return source.head()[:1] == ["|bars"]


def open_table(source):
    """Read the names."""
    _, names, *rows = source.head()
    time, *names = names.split("|")
    try:
        values = np.array([row.split("|") for row in rows], dtype=float)
    except ValueError:
        raise InputError(f"{source.shown}: a row has no number in every column") from None

    def load(wanted):
        at = {name: values[:, 1 + names.index(name)] for name in wanted}
        return {
            name: Column(name, values[:, 0], column, time, lambda i: f"row {i + 3}")
            for name, column in at.items()
        }

    return Table(source.shown, "bars", tuple(names), time, load)
''',
        ),
        ("recording/formats.py", "delimited, hdf5", "bars, "),
        ("recording/formats.py", "hdf5, opensim)", "bars, "),
        ("recording/formats.py", '".h5"', '".bars", '),
    ],
    "a protocol": [
        (
            "protocol/profiles.py",
            "#: Slow, with long holds",
            '''\
def bow(t: FloatArray) -> FloatArray:
    """Up and down once in 20 s."""
    return smooth_step(t / 8.0) - smooth_step((t - 12.0) / 8.0)


''',
        ),
        (
            "protocol/profiles.py",
            '        Profile("sine"',
            '        Profile("bow", 20.0, bow, "Up and down once."),\n',
        ),
        ("base/names.py", '    "sine",', '    "bow",\n'),
    ],
    "a setting of a fit": [],  # its field is written in the recipe
}


def section(recipe: str) -> str:
    """The text of a recipe."""
    return RECIPES.split(f"\n## Add {recipe}\n")[1].split("\n## ")[0]


@pytest.fixture(scope="module")
def run(tmp_path_factory):
    """Run Python in a copy of the package in which all recipes were followed."""
    copy = tmp_path_factory.mktemp("copy")
    shutil.copytree(PACKAGE, copy / "surae")  # with what Python has compiled
    file, field = re.search(
        r"`src/(surae/\w+\.py)`.*?```python\n(.*?)```", section("a setting of a fit"), re.DOTALL
    ).groups()
    added = [(f"surae/{name}", *rest) for each in ADDED.values() for name, *rest in each]
    for name, before, text in [*added, (file, "    def __post_init__", f"{field}\n")]:
        path = copy / name
        if not before:
            path.write_text(text, encoding="utf-8")
            continue
        there = path.read_text(encoding="utf-8")
        assert before in there, (name, before)
        path.write_text(there.replace(before, text + before, 1), encoding="utf-8")
    # Nothing is compiled anew for the copy.
    env = {**os.environ, "PYTHONPATH": str(copy), "NUMBA_DISABLE_JIT": "1", "COLUMNS": "100"}

    def run(*arguments: str) -> str:
        done = subprocess.run(
            [sys.executable, *arguments],
            env=env,
            cwd=copy,
            capture_output=True,
            text=True,
            timeout=300,
            check=False,
        )
        assert done.returncode == 0, done.stderr
        return done.stdout

    motion = generate(Protocol(profile="multiple-holds", rate_hz=16.0, duration=12.0))
    made = virtual_trial(virtual_subject(3), motion)
    columns = {"time_s": made.time, "angle_rad": made.angle, "torque_Nm": made.torque}
    columns |= {f"emg_{m}_V": made.emg[:, i] for i, m in enumerate(MUSCLES)}
    surae.write_csv(copy / "trial.csv", columns, ["emg: envelope"])
    columns["torque_Nm"] = 0.0 * columns["torque_Nm"] + 3.0
    surae.write_csv(copy / "still.csv", columns, ["emg: envelope"])
    return run


#: What is asked of the copy: how each part of the product sees what was added.
SEEN = """
import inspect, json, sys
from pathlib import Path
import numpy as np
import surae
from surae import api
from surae.inference.population_priors import wide_priors
from surae.model.laboratory import laboratory
from surae.base.records import from_plain
from surae.model import get_model, ModelOptions
from surae.report.language import words_in
from surae_workbench.web.form import form
from surae_workbench.web.schemas import DraftChange

sys.path[:0] = sys.argv[1:]
import quality_table, tables
from undrawn import blank_figures, few_legs

def refused(value):
    try:
        DraftChange(patience=value)
    except ValueError:
        return True
    return False

older = surae.FitSettings().as_dict()
del older["patience"]
trial = surae.read("trial.csv")
plain = dict(prepared=True, starts=1)
fit = surae.fit(trial, model="muscle", free=("friction", "viscosity"), patience=7, **plain)
spring = surae.fit(trial, model="spring", **plain)
for name, each in (("fit", fit), ("spring", spring)):
    each.save(f"{name}.json")
with blank_figures(), few_legs():
    fit.report("report.html")
    measures = list(surae.measures(fit))
problem = spring.result.problem
tied = problem.spec.simulator(problem.inputs[0], problem.options)
at = np.array([p.start for p in problem.spec.parameters])
torque, slopes = tied.torque_jacobian(at, range(len(at)))
off = 0.0
for j in range(len(at)):
    step = 1e-5 * at[j] * np.eye(len(at))[j]
    slope = (tied.torque(at + step) - tied.torque(at - step)) / (2 * step[j])
    off = max(off, float(np.abs(slope - slopes[j]).max() / np.abs(slope).max()))
known = fit.assessment.uncertainty
motion = api.generate(api.Protocol(profile="bow", rate_hz=16.0))
json.dump({
    "home": surae.__file__,
    "doc": inspect.getdoc(surae.fit),
    "keywords": list(inspect.signature(surae.fit).parameters),
    "form": [row for row in form() if row["path"] == ["patience"]],
    "models": [row["choices"] for row in form() if row["path"] == ["model"]],
    "request": DraftChange(patience=5).plain(),
    "refused": [refused(0), refused("often"), refused(1)],
    "fit": json.loads(Path("fit.json").read_text(encoding="utf-8")),
    "spring": json.loads(Path("spring.json").read_text(encoding="utf-8")),
    "older": from_plain(surae.FitSettings, older).patience,
    "prior": laboratory()["friction"].sd,
    "sources": {n: dict(known.budget(known.along(n)).shares) for n in ("m", "k_tri")},
    "wide": wide_priors()["viscosity"],
    "tables": {"source": tables.sources(), "measure": tables.measures(),
               "code": quality_table.table(), "measurement":
               tables.of_parameters(tables.PARAMETERS["measurement"]),
               "drives": tables.of_parameters(tables.PARAMETERS["drives"])},
    "found": [f.code for f in surae.check("still.csv").findings],
    "fine": [f.code for f in surae.check("trial.csv").findings],
    "measures": measures,
    "report": Path("report.html").read_text(encoding="utf-8"),
    "against": [reason.code for reason in fit.adequacy.against],
    "plain": [words_in("en")(reason.plain) for reason in fit.adequacy.against],
    "slopes": off,
    "angles": [float(motion.angle.min()), float(motion.angle.max())],
}, sys.stdout)
"""


@pytest.fixture(scope="module")
def seen(run):
    """What the copy says of itself."""
    return json.loads(run("-c", SEEN, str(ROOT / "docs" / "_ext"), str(Path(__file__).parent)))


@pytest.mark.parametrize("recipe", ADDED)
def test_a_recipe_names_every_file_that_it_changes(recipe) -> None:
    said = section(recipe)
    for file, before, _ in ADDED[recipe]:
        name = file if before else re.sub(r"/\w+\.py", "/<", file)
        assert name in said, file


@pytest.mark.slow
def test_a_setting_is_an_option_a_keyword_a_request_and_a_field_of_the_form(seen) -> None:
    assert Path(seen["home"]).parent != PACKAGE
    assert "patience : int, default 3\n    How many searches may fail" in seen["doc"]
    assert "patience" in seen["keywords"]
    (row,) = seen["form"]
    assert (row["label"], row["kind"], row["least"], row["default"]) == ("Patience", "whole", 1, 3)
    assert seen["request"] == {"patience": 5}
    assert seen["refused"] == [True, True, False]
    assert seen["older"] == 3
    assert seen["fit"]["settings"]["patience"] == 7


@pytest.mark.slow
def test_what_the_laboratory_cannot_rule_out_has_a_prior_and_words(seen) -> None:
    assert seen["prior"] == 1.0
    assert (
        "| friction | what the bearings of the device take | `friction`: 0 ± 1 Nm |"
        in (seen["tables"]["source"])
    )
    assert (
        "| `friction` | Nm | friction of the device | 0 | 0 … 5 |"
        in (seen["tables"]["measurement"])
    )
    assert seen["fit"]["parameters"]["friction"]["verdict"] != "fixed"


@pytest.mark.slow
def test_a_source_of_uncertainty_is_in_every_budget_and_in_the_table(seen) -> None:
    assert all(0.0 < shares["scale"] < 1.0 for shares in seen["sources"].values())
    assert (
        "| scale of the torque | what the calibration of the sensor leaves |"
        in (seen["tables"]["source"])
    )


@pytest.mark.slow
def test_a_parameter_is_estimated_explained_and_in_the_report(seen) -> None:
    estimate = seen["fit"]["parameters"]["viscosity"]
    assert estimate["verdict"] != "fixed"
    assert estimate["value"] < 0.5  # Nm·s/rad; the virtual leg has none
    assert seen["wide"] == [0.5, 1.0]
    assert (
        "| `viscosity` | Nm·s/rad | viscosity of the joint | 0 | 0 … 20 |"
        in (seen["tables"]["drives"])
    )
    assert "viscosity" in seen["report"]
    assert "move the relaxed leg at several speeds" in seen["report"].lower()


@pytest.mark.slow
def test_a_finding_is_found_where_it_is_and_in_the_table(seen) -> None:
    assert "torque-still" in seen["found"]
    assert "torque-still" not in seen["fine"]
    assert (
        "| `torque-still` | torque that never changes | Connect the torque sensor"
        in (seen["tables"]["code"])
    )


@pytest.mark.slow
def test_a_reason_and_a_verdict_are_told_saved_and_on_the_page(seen) -> None:
    assert "brief" in seen["against"]
    assert "the trial is brief" in seen["plain"]
    assert "the trial lasts 12 s" in seen["fit"]["adequacy"]["reasons"]
    assert "the trial lasts 12 s" in seen["report"]
    said = seen["fit"]["parameters"]["tau_rel"]
    assert (said["verdict"], said["note"]) == ("hearsay", "as somebody said")
    assert "hearsay" in seen["report"]


@pytest.mark.slow
def test_a_measure_is_computed_and_in_the_table(seen) -> None:
    assert "slack_span" in seen["measures"]
    assert (
        "| `slack_span` | deg | Angle over which neither muscle pulls. |"
        in (seen["tables"]["measure"])
    )


@pytest.mark.slow
def test_a_model_is_offered_fitted_and_its_sensitivities_are_right(seen) -> None:
    assert "spring" in dict(seen["models"][0])
    assert seen["spring"]["model"] == "spring"
    assert set(seen["spring"]["parameters"]) > {"s_tri", "s_tib", "g4"}
    assert seen["slopes"] < 1e-4


@pytest.mark.slow
def test_a_protocol_spans_the_range(seen) -> None:
    low, high = seen["angles"]
    assert high - low > 0.5


def test_help_shows_what_was_added(run) -> None:
    said = " ".join(run("-m", "surae", "fit", "--help").split())
    assert "--patience N How many searches may fail before a fit gives up. [default: 3]" in said
    assert "viscosity: viscosity of the joint" in said
    assert "spring" in said
    assert " bow" in run("-m", "surae", "protocol", "--help")


def test_a_reader_recognises_its_files(run, tmp_path) -> None:
    rows = "\n".join(f"{i / 100}|{i / 1000}" for i in range(50))
    (tmp_path / "leg.bars").write_text(f"|bars\nt|ankle angle\n{rows}\n", encoding="utf-8")
    said = run("-m", "surae", "inspect", str(tmp_path / "leg.bars"))
    assert "bars" in said
    assert "ankle angle" in said
