"""STUDY.toml: what it may say, and one clear line for what it may not."""

import math

import pytest

from surae.base.errors import InputError
from surae.studies.study import FACTORS, parse_study, read_study
from surae.studies.tasks import FitTask, _trajectory, task_of

MINIMAL = 'protocol = "sine"\n'


def planned(study) -> list[FitTask]:
    return [task_of(combination) for combination in study.combinations()]


def test_a_scalar_stands_for_a_list_of_one() -> None:
    study, same = parse_study(MINIMAL), parse_study('protocol = ["sine"]')
    assert study.factors == same.factors
    assert study.size == 1
    assert study.name == "study"


def test_lists_are_crossed_the_last_factor_fastest() -> None:
    study = parse_study(
        'protocol = ["sine", "multi-sine"]\nmodel = ["muscle", "muscle-tendon"]\nsubjects = 3\n'
    )
    assert study.size == 12
    rows = [(c["protocol"], c["subject"], c["model"]) for c in study.combinations()]
    assert rows[:3] == [("sine", 1, "muscle"), ("sine", 1, "muscle-tendon"), ("sine", 2, "muscle")]
    assert len(set(rows)) == 12


def test_the_order_of_the_file_does_not_matter() -> None:
    first = parse_study('protocol = "sine"\nnoise = [0.0, 0.05]\nseed = 3\n')
    second = parse_study('seed = 3\nnoise = [0, 0.05]\nprotocol = "sine"\n')
    assert planned(first) == planned(second)


def test_subjects_and_repeats_may_be_named() -> None:
    study = parse_study(MINIMAL + "subjects = [7, 3]\nrepeats = 2\n")
    assert study.factors["subject"] == (7, 3)
    assert study.factors["repeat"] == (1, 2)


def test_model_options_are_factors_where_they_are_given() -> None:
    plain = parse_study(MINIMAL)
    assert "geometry" not in plain.factors
    study = parse_study(MINIMAL + 'geometry = ["thesis", "virtual-work"]\nvmax_factor = 8\n')
    assert study.size == 2
    assert [dict(t.options)["geometry"] for t in planned(study)] == ["thesis", "virtual-work"]


def test_how_long_a_trial_and_its_relaxed_part_are() -> None:
    study = parse_study(MINIMAL + "duration = 28\npassive_seconds = [7, 11]\n")
    tasks = list(planned(study))
    assert [(t.duration, t.passive_seconds) for t in tasks] == [(28.0, 7.0), (28.0, 11.0)]
    muscle = [_trajectory(task).effort.any(axis=1).argmax() / task.rate_hz for task in tasks]
    assert muscle[1] - muscle[0] == pytest.approx(4.0, abs=0.05)
    assert "passive_seconds" not in parse_study(MINIMAL).factors


def test_the_grid_of_the_thesis() -> None:
    rates = [round(0.05 + 0.025 * k, 3) for k in range(23)]
    study = parse_study(
        'model = ["muscle", "muscle-tendon"]\n'
        'protocol = ["sine", "multiple-holds", "multi-sine", "multi-sine-holds", "scaled-chirp"]\n'
        f"chirp_amplitude = [0, 0.1, 0.2, 0.3]\nchirp_factor = {rates}\n"
        'task = ["part-passive", "active"]\n'
    )
    assert study.size == 1840
    assert len({task.key for task in planned(study)}) == 1400
    assert list(study.factors)[:3] == ["protocol", "chirp_amplitude", "chirp_factor"]


def test_a_factor_of_the_thesis_is_its_rate(tmp_path) -> None:
    rates = parse_study(MINIMAL + f"chirp_amplitude = 0.1\nchirp_rate = {0.5 / math.pi}")
    factors = parse_study(MINIMAL + "chirp_amplitude = 0.1\nchirp_factor = 0.5")
    (by_rate,), (by_factor,) = planned(rates), planned(factors)
    assert by_rate == by_factor
    assert next(factors.combinations())["chirp_factor"] == 0.5


@pytest.mark.parametrize(
    ("text", "says"),
    [
        ("protocol = ", "not valid TOML"),
        ("", 'protocol is missing; e.g. protocol = "multiple-holds"'),
        (MINIMAL + "chirp = 1", "unknown setting 'chirp'; known settings: name, protocol, chirp_"),
        ('protocol = "sin"', "protocol is 'sin'; use one of: ramp-and-hold, sine"),
        (MINIMAL + "noise = -0.1", "noise is -0.1; give at least 0"),
        (MINIMAL + "noise = []", "noise is an empty list"),
        (MINIMAL + "noise = [0, 0.0]", "noise has 0.0 twice"),
        (MINIMAL + "subjects = 0", "subjects is 0; give at least 1"),
        (MINIMAL + "rate_hz = 0", "rate_hz is 0; give more than 0"),
        (MINIMAL + 'model = "mussel"', "model is 'mussel'; use one of: muscle,"),
        (MINIMAL + "chirp_amplitude = 2", "protocol sine: chirp amplitude 2 rad: use 0 or more"),
        (MINIMAL + "chirp_amplitude = 0.1\nchirp_rate = 9", "protocol sine: the chirp ends at"),
        (
            MINIMAL + "chirp_factor = 0.5\nchirp_rate = 0.1",
            "chirp_rate and chirp_factor say the same; give one of them",
        ),
        (MINIMAL + "name = 3", "name is 3; give a text of one line"),
        (MINIMAL + 'name = "a\\nb"', "give a text of one line"),
        (MINIMAL + "subjects = 99999\nrepeats = 99999", "fits are too many; at most 1,000,000"),
        (
            MINIMAL + 'task = "active"\npassive_seconds = 7',
            "protocol sine: passive seconds 7: task 'active' does not begin relaxed",
        ),
        ("protocol = {a = 1}", "protocol is {'a': 1}; use one of"),
    ],
)
def test_what_a_study_may_not_say(tmp_path, text, says) -> None:
    path = tmp_path / "study.toml"
    path.write_text(text, encoding="utf-8")
    with pytest.raises(InputError) as error:
        read_study(path)
    message = str(error.value)
    assert message.startswith(f"{path}: ")
    assert says in message
    assert "\n" not in message


def test_a_file_that_is_no_text(tmp_path) -> None:
    (tmp_path / "study.toml").write_bytes(b"\xff\xfe\x00")
    with pytest.raises(InputError, match="not a text file in UTF-8"):
        read_study(tmp_path / "study.toml")
    with pytest.raises(InputError, match="there is no such file"):
        read_study(tmp_path / "none.toml")


def test_every_default_is_one_that_a_file_could_give() -> None:
    for factor, (_, default) in FACTORS.items():
        if default:
            value = f'"{default[0]}"' if isinstance(default[0], str) else default[0]
            text = MINIMAL if factor == "protocol" else f"{MINIMAL}\n{factor} = {value}"
            assert parse_study(text).size == 1


def test_a_model_that_virtual_subjects_have_no_truth_for_is_refused(tmp_path):
    path = tmp_path / "study.toml"
    path.write_text('name = "old"\nmodel = "muscle-2010"\nprotocol = "sine"\n')
    with pytest.raises(InputError, match="muscle-2010"):
        read_study(path)
