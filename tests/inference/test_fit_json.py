"""FIT.json: nothing lost on the way, and nothing but InputError from a file that is wrong."""

import base64
import copy
import json
import math
import tracemalloc
import zlib
from collections.abc import Mapping
from dataclasses import fields, is_dataclass, replace

import numpy as np
import pytest

import surae
from surae.base.errors import InputError
from surae.base.frozen import read_only
from surae.base.packed import decode, encode
from surae.base.records import FORMAT
from surae.base.words import Message
from surae.inference import AssessedFit, assess, fit_problem, make_problem
from surae.inference.judging.adequacy import doubted
from surae.inference.judging.reasons import OF_OTHER_TRIALS, against
from surae.inference.saved.fit_json import as_dict, load_saved, save_fit
from surae.inference.saved.parameters_json import read_parameters
from surae.protocol import Protocol, generate
from surae.recording import SourceFile
from surae.studies import virtual_subject, virtual_trial


@pytest.fixture(scope="module")
def result():
    """A fit with something in every field: two recordings, a fixed parameter, one at a bound."""
    slow = generate(
        Protocol(profile="multiple-holds", chirp_amplitude=0.2, chirp_rate=0.5, rate_hz=40.0)
    )
    first, second = (
        virtual_trial(virtual_subject(1), slow, noise=noise, seed=seed)
        for seed, noise in enumerate((0.05, 0.02))
    )
    named = replace(
        second,
        name="zweite Messung, 2 µV",
        files=(SourceFile("b.csv", "1" * 64), SourceFile("c.csv", "2" * 64)),
        fixed={"beta": 1.0},
        weight=read_only(np.where(second.time < 30.0, 1.0, 0.5)),
    )
    problem = make_problem(
        [first, named],
        bounds={"m": (2.9, 3.0)},
        start={"f0": 2.0, "tau_rel": 1.1},
        priors={"k_rel": (0.3, 0.5)},
    )
    return fit_problem(problem, starts=3, seed=5)


@pytest.fixture(scope="module")
def text(result, tmp_path_factory):
    path = tmp_path_factory.mktemp("fit") / "fit.json"
    save_fit(path, AssessedFit(result, assess(result, alternatives=True)))
    return path.read_text("utf-8")


def load_text(text, tmp_path):
    path = tmp_path / "fit.json"
    path.write_bytes(text if isinstance(text, bytes) else text.encode("utf-8"))
    return surae.load(path)


def assert_same(one, other, where="fit"):
    """Equal in every field, to the last bit."""
    if isinstance(one, Mapping):
        assert list(one) == list(other), where
        for key in one:
            assert_same(one[key], other[key], f"{where}[{key!r}]")
        return
    if type(one) is Message:  # whose sentence is what a file has
        one = str(one)
    if type(other) is Message:
        other = str(other)
    assert type(one) is type(other), where
    if isinstance(one, np.ndarray):
        assert one.dtype == other.dtype, where
        assert one.flags.writeable == other.flags.writeable, where
        np.testing.assert_array_equal(one, other, err_msg=where)
    elif is_dataclass(one):
        for field in fields(one):
            assert_same(
                getattr(one, field.name), getattr(other, field.name), f"{where}.{field.name}"
            )
    elif isinstance(one, tuple):
        assert len(one) == len(other), where
        for i, (a, b) in enumerate(zip(one, other, strict=True)):
            assert_same(a, b, f"{where}[{i}]")
    else:
        assert one == other, where


def test_loaded_equals_saved_in_every_field(result, text, tmp_path):
    loaded = load_text(text, tmp_path)
    # Bounds and start have to be given read-only or not alike: only their numbers count.
    assert_same(loaded.result.values, result.values)
    for name in ("status", "message", "sse", "residuals", "solution", "seed", "seconds"):
        assert_same(getattr(loaded.result, name), getattr(result, name), name)
    assert_same(loaded.result.R, result.R)
    assert_same(dict(loaded.result.versions), dict(result.versions))
    assert_same(loaded.result.problem.inputs, result.problem.inputs)
    for name in ("spec", "options", "free", "priors"):
        assert_same(getattr(loaded.result.problem, name), getattr(result.problem, name), name)
    for name in ("lower", "upper", "base"):
        np.testing.assert_array_equal(
            getattr(loaded.result.problem, name), getattr(result.problem, name)
        )


def test_what_it_is_worth_is_the_same_too(result, text, tmp_path):
    assert_same(load_text(text, tmp_path).assessment, assess(result, alternatives=True))


def test_verdicts_are_those_of_the_file_and_it_is_said_where_they_would_be_others(text, tmp_path):
    data = json.loads(text)
    name, wide, *_ = (n for n, p in data["parameters"].items() if p["ci95"])
    was, grade = data["parameters"][name]["verdict"], data["adequacy"]["grade"]
    data["parameters"][name] |= {"verdict": "undetermined", "note": "as it was"}
    data["parameters"][wide]["ci95"][0] -= 1e9
    other = "doubtful" if grade != "doubtful" else "adequate"
    later = [{"code": "of tomorrow", "values": {"x": 1.0}, "is_grave": True}]
    data["adequacy"] = {"grade": other, "reasons": ["so it was"], "r2": None, "codes": later}
    with pytest.warns(UserWarning, match="By this version"):
        fit = load_text(json.dumps(data), tmp_path)
    assert (fit.parameters[name].verdict, fit.adequacy.grade) == ("undetermined", other)
    assert fit.parameters[name].meaning
    assert fit.assessment.differs == (
        f"the fit is {grade}, not {other}",
        f"{name} is {was}, not undetermined",
        f"the intervals of {wide} are others",
    )
    assert f"the fit is {grade}, not {other}" in str(fit.summary())
    assert_same(fit.reassess().assessment, load_text(text, tmp_path).assessment)


def test_saved_again_it_is_the_same_file(text, tmp_path):
    loaded = load_text(text, tmp_path)
    loaded.save(tmp_path / "again.json")
    assert (tmp_path / "again.json").read_text("utf-8") == text


def test_the_human_part(result, text):
    data = json.loads(text)
    contract = {
        "surae",
        "model",
        "options",
        "status",
        "message",
        "vaf",
        "parameters",
        "correlation",
        "ipde",
        "recordings",
        "seed",
        "starts",
        "seconds",
        "versions",
    }
    assert contract <= set(data)
    found = assess(result, alternatives=True)
    assert data["surae"] == surae.__version__
    assert data["model"] == "muscle"
    assert data["options"]["geometry"] == "thesis"
    assert data["status"] == "at-bounds"
    assert data["vaf"] == found.vaf
    assert list(data["parameters"]) == list(result.problem.spec.names)
    for name, p in found.parameters.items():
        entry = data["parameters"][name]
        assert {
            "value",
            "unit",
            "sem",
            "ci95",
            "lower",
            "upper",
            "free",
            "at_bound",
            "verdict",
        } <= set(entry)
        assert entry["value"] == p.value
        assert entry["sem"] == p.sem
        assert entry["ci95"] == (None if p.ci95 is None else list(p.ci95))
        assert entry["verdict"] in ("identified", "weak", "undetermined", "at-bound", "fixed")
    assert data["parameters"]["m"]["verdict"] == "at-bound"
    assert data["parameters"]["beta"]["verdict"] == "fixed"
    assert data["parameters"]["g2"]["unit"] == "N/V"
    names, matrix = data["correlation"]["names"], data["correlation"]["matrix"]
    assert len(matrix) == len(names) == len(found.covariance.names)
    assert "m" not in names
    assert data["ipde"] == found.ipde
    one, two = data["recordings"]
    assert {"path", "sha256", "n", "rate_hz", "vaf"} <= set(one)
    assert (one["path"], one["sha256"]) == (None, None)
    assert (two["path"], two["sha256"], two["n"]) == ("b.csv", "1" * 64, len(result.residuals[1]))
    assert data["starts"]["n"] == 3
    assert data["starts"]["agreeing"] == result.solution.agreeing
    assert (data["seed"], data["seconds"]) == (5, result.seconds)
    assert data["format"] == FORMAT


def test_no_number_that_json_does_not_know(text, result):
    def refuse(constant):
        raise AssertionError(constant)

    json.loads(text, parse_constant=refuse)
    # A start that overflowed has no sum; it comes back as infinite.
    starts = (replace(result.solution.starts[0], sse=math.inf), *result.solution.starts[1:])
    overflowed = replace(result, solution=replace(result.solution, starts=starts))
    data = as_dict(AssessedFit(overflowed, assess(result)))
    assert data["starts"]["all"][0]["sse"] is None
    json.dumps(data, allow_nan=False)


def test_arrays_keep_odd_numbers():
    array = np.array([0.0, -0.0, np.inf, -np.inf, np.nan, 5e-324, np.finfo(float).max])
    found = decode(encode(array))
    assert found.tobytes() == array.tobytes()


def test_arrays_in_any_memory_order():
    array = np.arange(12.0).reshape(3, 4)
    for other in (np.asfortranarray(array), array[::-1], array[:, ::2]):
        np.testing.assert_array_equal(decode(encode(other)), other)


def bomb(n):
    """`n` zero bytes, packed a thousand times smaller."""
    packer = zlib.compressobj(9)
    packed = b"".join(packer.compress(b"\0" * 2**20) for _ in range(n >> 20))
    return base64.b64encode(packed + packer.flush()).decode()


@pytest.mark.parametrize(
    "change",
    [
        {"encoding": "pickle"},
        {"shape": [5]},
        {"shape": [4.5]},
        {"shape": "4"},
        {"shape": None},
        {"data": "no base64!"},
        {"data": "ÄÖ=="},
        {"data": base64.b64encode(b"no zlib").decode()},
        {"data": base64.b64encode(zlib.compress(b"\0" * 24)).decode()},
        {"data": base64.b64encode(zlib.compress(b"\0" * 40)).decode()},
        {"data": base64.b64encode(zlib.compress(b"\0" * 32)[:-6]).decode()},
        {"data": 7},
        {"data": ""},
    ],
)
def test_a_damaged_array_is_refused(change):
    packed = encode(np.zeros(4)) | change
    with pytest.raises((ValueError, TypeError)):
        decode(packed)


def test_a_bomb_takes_no_more_memory_than_the_array_that_was_asked_for():
    packed = encode(np.zeros(1000)) | {"data": bomb(200 * 2**20)}
    tracemalloc.start()
    try:
        with pytest.raises(ValueError, match="holds"):
            decode(packed)
        assert tracemalloc.get_traced_memory()[1] < 4 * 2**20
    finally:
        tracemalloc.stop()


WRONG = [
    None,
    True,
    False,
    0,
    -1,
    3,
    1.5,
    1e308,
    -1e308,
    10**30,
    10**400,
    "",
    "x",
    "nan",
    "1e5",
    [],
    [[]],
    [1.0] * 20,
    {},
    {"value": 1},
    {"a": {"b": []}},
    "\0",
    "A" * 1000,
]


def places(node, path=()):
    """Every place in a JSON document."""
    yield path
    if isinstance(node, dict):
        for key, value in node.items():
            yield from places(value, (*path, key))
    elif isinstance(node, list):
        for key, value in enumerate(node[:4]):
            yield from places(value, (*path, key))


def mutate(data, rng, everywhere):
    """One change at a random place: another type, another size, or gone."""
    mutant = copy.deepcopy(data)
    path = everywhere[rng.integers(1, len(everywhere))]
    node = mutant
    for key in path[:-1]:
        node = node[key]
    kind = rng.integers(5)
    if kind == 0:
        del node[path[-1]]
    elif kind == 1 and isinstance(node[path[-1]], str):
        old = node[path[-1]]
        node[path[-1]] = old[: rng.integers(len(old) + 1)]
    else:
        node[path[-1]] = WRONG[rng.integers(len(WRONG))]
    return mutant, path


def survives(text, tmp_path):
    """Load or InputError in one line; everything else is a bug. What was loaded can be saved."""
    try:
        loaded = load_text(text, tmp_path)
    except InputError as error:
        if "\n" in str(error):
            raise AssertionError("more than one line") from error
        return False
    loaded.save(tmp_path / "again.json")
    return True


@pytest.mark.parametrize(
    "seed", [0, *(pytest.param(k, marks=pytest.mark.slow) for k in range(1, 6))]
)
def test_mutated_files(seed, text, tmp_path):
    rng = np.random.default_rng(seed)
    data = json.loads(text)
    for name in ("time", "angle", "velocity", "acceleration", "emg"):  # alike and long
        data["traces"][1][name] = data["traces"][0][name]
    everywhere = list(places(data))
    refused = 0
    for _ in range(30):
        mutant, path = mutate(data, rng, everywhere)
        try:
            refused += not survives(json.dumps(mutant), tmp_path)
        except Exception as error:
            raise AssertionError(f"{path}: {error!r}") from error
    assert refused > 2


def test_truncated_files(text, tmp_path):
    rng = np.random.default_rng(1)
    for end in [0, 1, 2, *rng.integers(3, len(text) - 3, 60)]:
        with pytest.raises(InputError, match=r"fit\.json: "):
            load_text(text[:end], tmp_path)


@pytest.mark.parametrize(
    "content",
    [
        b"",
        b"null",
        b"[]",
        b"1",
        b'"fit"',
        b"{}",
        b"\xff\xfe",
        b"{" * 100000,
        b"[" * 100000,
        b'{"surae": {}}',
        b'{"surae": "0.1.0"}',
        b'{"model": 3}',
        b'{"parameters": {}}',
        b'{"a": ' + b"9" * 5000 + b"}",
        b"\xef\xbb\xbf{}",
        b'{"surae": [1]}',
        b'{"format": "x"}',
    ],
)
def test_files_that_are_no_fit(content, tmp_path):
    with pytest.raises(InputError) as caught:
        load_text(content, tmp_path)
    assert "\n" not in str(caught.value)


def test_a_newer_format_is_refused_with_advice(text, tmp_path):
    with pytest.raises(InputError, match=r"newer than this one .*upgrade surae"):
        load_text(json.dumps(json.loads(text) | {"format": FORMAT + 1}), tmp_path)


def test_what_later_versions_add_is_ignored(text, tmp_path):
    assert load_text(json.dumps(json.loads(text) | {"colour": "blue"}), tmp_path).vaf > 0


@pytest.fixture(scope="module", params=[{"k_tri": 1e6, "x0_tri": 1e-3}, {"m": 1e200}])
def overflown(request, result):
    """A fit of a model that has no finite torque anywhere, or none whose square is finite."""
    bounds = {name: (0.5 * value, 2 * value) for name, value in request.param.items()}
    problem = make_problem(result.problem.inputs, fixed=request.param, bounds=bounds)
    return fit_problem(problem, starts=2)


def test_a_model_that_overflows_is_a_status_with_advice(overflown):
    assert overflown.status == "failed"
    assert "overflows" in overflown.message
    assert "give another start or bounds" in overflown.message
    found = assess(overflown)
    assert math.isnan(found.vaf)
    assert found.ipde is None
    for p in found.parameters.values():
        assert (p.sem, p.ci95) == (None, None)
        if p.free and not p.at_bound:
            assert p.note == "no interval: the model gives no finite torque here"


def test_a_model_that_overflows_can_be_saved_and_read(overflown, tmp_path):
    path = tmp_path / "fit.json"
    save_fit(path, AssessedFit(overflown, assess(overflown)))
    data = json.loads(path.read_text("utf-8"))
    assert (data["vaf"], data["rmse_Nm"], data["ipde"], data["sse"]) == (None, None, None, None)
    assert surae.load(path).status == "failed"


@pytest.mark.parametrize("bad", [math.nan, math.inf])
def test_a_factor_that_is_not_finite_gives_no_intervals(bad, text, tmp_path):
    data = json.loads(text)
    shape = data["R"]["shape"]
    data["R"] = encode(np.full(shape, bad))
    del data["sha256"]  # as files of before have none
    assert load_text(json.dumps(data), tmp_path).ipde is None


def values_of(found):
    return dict(getattr(found, "values", found))


def test_parameters_of_a_fit_and_of_a_plain_table(result, text, tmp_path):
    path = tmp_path / "p.json"
    path.write_text(text, "utf-8")
    assert values_of(read_parameters(path)) == dict(result.values)
    path.write_text('{"parameters": {"m": 2, "g1": 1.5e6}}')
    assert values_of(read_parameters(path)) == {"m": 2.0, "g1": 1.5e6}


@pytest.mark.parametrize(
    "content",
    [
        "{}",
        '{"parameters": {}}',
        '{"parameters": [1]}',
        '{"parameters": {"m": null}}',
        '{"parameters": {"m": true}}',
        '{"parameters": {"m": "2"}}',
        '{"parameters": {"m": {}}}',
        '{"m": 2}',
        "[2]",
        "2",
        "x",
    ],
)
def test_tables_that_are_no_parameters(content, tmp_path):
    path = tmp_path / "p.json"
    path.write_text(content)
    with pytest.raises(InputError, match=r"p\.json: "):
        read_parameters(path)


@pytest.mark.parametrize(
    ("place", "wrong", "says"),
    [
        (("parameters", "m", "value"), "heavy", r"parameters\.m\.value: 'heavy' is not a finite"),
        (("parameters", "m", "free"), 1, r"parameters\.m\.free: 1 is not true or false"),
        (("traces", 1, "emg"), encode(np.zeros((3, 4))), r"traces\[1\]\.emg: an array is \[3, 4\]"),
        (("traces", 1, "residual", "data"), "AAAA", r"traces\[1\]\.residual: "),
        (("traces", 0, "files"), [{"path": "a"}], r"traces\[0\]\.files\[0\]\.sha256: it is"),
        (("traces", 0, "lowpass"), [6.0], r"traces\[0\]\.lowpass: \[6\.0\] are 1 values, not 2"),
        (("starts", "all", 2, "sse"), "much", r"starts\.all\[2\]\.sse: 'much'"),
        (("priors", "k_rel"), {"median": 1.0}, r"priors\.k_rel\.spread: it is missing"),
        (("settings", "starts"), 1.5, r"settings\.starts: 1\.5 is not a whole number"),
        (("settings", "seed"), -1, r"settings: seed is -1; give at least 0"),
        (("seed",), None, r"seed: None is not a whole number"),
        (("R",), encode(np.zeros((2, 2))), r"R: an array is \[2, 2\]"),
    ],
)
def test_what_is_damaged_is_named(place, wrong, says, text, tmp_path):
    data = json.loads(text)
    node = data
    for key in place[:-1]:
        node = node[key]
    node[place[-1]] = wrong
    with pytest.raises(InputError, match=r"fit\.json: " + says) as caught:
        load_text(json.dumps(data), tmp_path)
    assert "\n" not in str(caught.value)


def test_a_fit_names_no_file_to_be_read(text, tmp_path):
    """A geometry is kept as a table: a fit from somebody else opens nothing here."""
    (tmp_path / "arms.csv").write_text("angle_deg,length_tri_mm\n")
    data = json.loads(text)
    data["options"]["geometry"] = str(tmp_path / "arms.csv")
    (tmp_path / "fit.json").write_text(json.dumps(data))
    with pytest.raises(InputError, match="geometry is"):
        load_saved(tmp_path / "fit.json")


@pytest.mark.parametrize("name", ["k_tri", "m"])
def test_a_file_whose_numbers_somebody_changed_says_so(name, text, tmp_path):
    data = json.loads(text)
    data["recordings"][0]["name"] = data["traces"][0]["name"] = "code 17"
    assert load_text(json.dumps(data), tmp_path)[name].value  # labels may be changed
    data["parameters"][name]["value"] *= 0.999
    with pytest.raises(InputError, match="not those that were fitted"):
        load_text(json.dumps(data), tmp_path)


@pytest.mark.parametrize("key", ["torque", "angle", "time"])
def test_traces_that_are_no_numbers_are_refused(key, text, tmp_path):
    data = json.loads(text)
    del data["sha256"]
    data["traces"][0][key] = encode(np.full(data["traces"][0][key]["shape"], np.nan))
    with pytest.raises(InputError, match="traces"):
        load_text(json.dumps(data), tmp_path)


def test_arrays_that_claim_too_much_are_refused_before_they_are_unpacked(text, tmp_path):
    data = json.loads(text)
    for trace in data["traces"]:
        for key in ("time", "angle", "torque", "residual"):
            trace[key] = encode(np.zeros(10**6))
    tracemalloc.start()
    with pytest.raises(InputError, match="arrays claim"):
        load_text(json.dumps(data), tmp_path)
    assert tracemalloc.get_traced_memory()[1] < 20 * 2**20
    tracemalloc.stop()
    data["R"]["shape"] = [10**9, 10**9]
    with pytest.raises(InputError, match="arrays claim"):
        load_text(json.dumps(data), tmp_path)


#: What of a file may be changed by hand: labels; and verdicts, of which it is said.
SAID = ("verdict", "ci95", "grade")


def leaves(node, path=()):
    """Every value in a JSON document that is no table or list, and every list that is empty."""
    pairs = node.items() if isinstance(node, dict) else enumerate(node[:3])
    for key, value in pairs:
        if isinstance(value, dict | list) and value and "encoding" not in value:
            yield from leaves(value, (*path, key))
        else:
            yield (*path, key), value


def other(value):
    """Values of the same kind that are others: what a type alone does not refuse."""
    match value:
        case bool():
            return [not value]
        case int() | float():
            return [value + 1, -value - 1, 1e300, 1e-300]
        case str():
            return [value + "!", "", "<b>x</b>", "A" * 2**20]
        case None:
            return [1.0, "x"]
    return [[], ["x"], {}]


def edits(data):
    """Every change of one value, and every value taken away."""
    for path, value in leaves(data):
        for wrong in (*other(value), "gone"):
            yield path, wrong


def edited(data, path, wrong):
    mutant = copy.deepcopy(data)
    node = mutant
    for key in path[:-1]:
        node = node[key]
    if wrong == "gone":
        del node[path[-1]]
    else:
        node[path[-1]] = wrong
    return mutant


def believed(data, path, wrong, tmp_path):
    """What an edit changes of what is shown, unless it is refused; not what it is said of."""
    try:
        fit = load_text(json.dumps(edited(data, path, wrong)), tmp_path)
    except InputError as error:
        said = str(error)
        if "\n" in said or len(said) > 600:
            raise AssertionError(path) from error
        return False
    if fit.assessment.differs:
        assert path[-1] in SAID or path[-2] in SAID, path
        return False
    again = as_dict(AssessedFit(fit.result, fit.assessment, fit.quality))
    again = {key: value for key, value in again.items() if "sha256" not in key}
    whole = {key: value for key, value in data.items() if "sha256" not in key}
    if again == whole:
        return False
    return not (path[0] in ("recordings", "traces") and path[-1] in ("name", "path", "sha256"))


@pytest.mark.filterwarnings("ignore:.*By this version")
@pytest.mark.parametrize("part", [0, *(pytest.param(k, marks=pytest.mark.slow) for k in (7, 16))])
def test_no_edited_word_is_believed(part, result, text, tmp_path, monkeypatch):
    """815 edits of 52 fields were believed once: units, notes, reasons, r2, status, findings."""
    fresh = assess(result, alternatives=True)
    # What is judged rests on what the checksums hold: it need not be computed each time.
    monkeypatch.setattr("surae.inference.saved.fit_json.assess", lambda *_, **__: fresh)
    data = json.loads(text)
    every = list(edits(data))
    assert len(every) > 2000
    wrong = [(path, to) for path, to in every[part::30] if believed(data, path, to, tmp_path)]
    assert not wrong, [(path, str(to)[:20]) for path, to in wrong]


@pytest.mark.parametrize(
    ("place", "to"),
    [
        (("adequacy", "reasons"), []),
        (("adequacy", "r2"), 100.0),
        (("parameters", "m", "unit"), "g"),
        (("parameters", "k_tri", "note"), "as sure as can be"),
        (("parameters", "k_tri", "repeatable"), True),
        (("interval_note",), "<meta http-equiv=refresh>"),
    ],
)
def test_words_of_a_file_are_made_anew(place, to, text, tmp_path):
    data = json.loads(text)
    fit = load_text(json.dumps(edited(data, place, to)), tmp_path)
    assert_same(fit.assessment, load_text(text, tmp_path).assessment)


@pytest.mark.parametrize("place", ["status", "message", "starts", "search", "findings", "seconds"])
def test_how_it_was_found_is_vouched_for(place, text, tmp_path):
    data = json.loads(text)
    clean = [{"recording": "x", "findings": [], "skipped": []}]
    for to in (edited(data, (place,), "gone"), data | {place: clean if place == "findings" else 7}):
        if place == "findings" and place not in to:
            continue  # there were none
        with pytest.raises(InputError, match=r"fit\.json: "):
            load_text(json.dumps(to), tmp_path)


def test_what_other_trials_say_against_a_fit_is_kept_in_our_words(result, text, tmp_path):
    fresh = assess(result, alternatives=True)
    reason = against("error-stands", trial="b", what="an electrode is off")
    judged = doubted(fresh.adequacy, [reason], OF_OTHER_TRIALS)
    path = tmp_path / "joint.json"
    save_fit(path, AssessedFit(result, replace(fresh, adequacy=judged)))
    assert load_saved(path).assessment.adequacy == judged
    assert load_saved(path).assessment.differs == ()
    data = json.loads(path.read_text("utf-8"))
    place = next(i for i, c in enumerate(data["adequacy"]["codes"]) if c["code"] == "error-stands")
    data["adequacy"]["codes"][place]["values"]["what"] = "nothing"
    with pytest.raises(InputError, match="somebody changed"):
        load_text(json.dumps(data), tmp_path)
