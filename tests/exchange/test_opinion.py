"""A second opinion: every planted value is seen, in every program's layout, and no other is."""

import json

import numpy as np
import pytest
from results_made import calibration_text, osimx_text, redundancy_mat, sto_text, subject_text

import surae
from made_osim import HEADS, osim_text
from surae.base.errors import InputError

MUSCLES = [
    "soleus_r",
    "med_gas_r",
    "lat_gas_r",
    "tib_ant_r",
    "tib_post_r",
    "per_long_r",
    "vas_lat_r",
]
#: Fibres that adults have [m].
FIBRES = [0.0471, 0.0533, 0.0611, 0.0724, 0.0391, 0.0517, 0.1013]


def said(opinion) -> set[tuple[str, str, str]]:
    """Muscle, parameter and kind of everything that is said."""
    return {
        (value.of.muscle, value.of.parameter, kind)
        for result in opinion.results
        for value in result.values
        for kind in value.kinds
    }


def nmsm(rng) -> dict[str, dict[str, float]]:
    """Honest values of NMSM: none at a limit or a start."""
    return {
        name: {
            "electromechanical_delay": float(rng.uniform(0.2, 1.1)),
            "activation_time_constant": float(rng.uniform(0.9, 3.3)),
            "activation_nonlinearity_constant": float(rng.uniform(0.06, 0.33)),
            "emg_scale_factor": float(rng.uniform(0.1, 0.48)),
            "optimal_fiber_length": float(rng.uniform(0.83, 1.23)),
            "tendon_slack_length": float(rng.uniform(0.83, 1.23)),
        }
        for name in MUSCLES
    }


@pytest.mark.parametrize("seed", range(4))
def test_every_limit_that_nmsm_met_is_seen_and_no_other(tmp_path, seed) -> None:
    values = nmsm(np.random.default_rng(seed))
    path = tmp_path / "muscleModelParameters.sto"
    path.write_text(sto_text(values), encoding="utf-8")
    assert said(surae.judge(path)) == set()
    values["soleus_r"]["electromechanical_delay"] = 0.0
    values["med_gas_r"]["activation_time_constant"] = 3.5
    values["lat_gas_r"]["activation_nonlinearity_constant"] = 0.35 - 1e-7
    values["tib_ant_r"]["emg_scale_factor"] = 0.05
    values["tib_post_r"]["optimal_fiber_length"] = 1.4
    values["per_long_r"]["tendon_slack_length"] = 0.6 + 1e-8
    values["vas_lat_r"]["electromechanical_delay"] = 0.5
    values["vas_lat_r"]["optimal_fiber_length"] = 1.0
    path.write_text(sto_text(values), encoding="utf-8")
    assert {(m, p, k) for m, p, k in said(surae.judge(path)) if k != "plain-part"} == {
        ("soleus_r", "electromechanical_delay", "at-limit"),
        ("med_gas_r", "activation_time", "at-limit"),
        ("lat_gas_r", "activation_nonlinearity", "at-limit"),
        ("tib_ant_r", "emg_scale", "at-limit"),
        ("tib_post_r", "optimal_fiber_length", "at-limit"),
        ("per_long_r", "tendon_slack_length", "at-limit"),
        ("vas_lat_r", "electromechanical_delay", "at-start"),
        ("vas_lat_r", "optimal_fiber_length", "generic"),
    }


def test_nmsm_names_a_model_whose_lengths_are_generic(tmp_path) -> None:
    (tmp_path / "model.osim").write_text(osim_text("gait"), encoding="utf-8")
    own = {f"{name}_r": numbers for name, (_, numbers) in HEADS["gait"].items()}
    values = {
        name: {"optimal_fiber_length": 1.0713 * fibre, "tendon_slack_length": 0.9641 * tendon}
        for name, (fibre, tendon, *_) in own.items()
    }
    values["soleus_r"]["optimal_fiber_length"] = own["soleus_r"][0]
    values["med_gas_r"]["tendon_slack_length"] = 1.4 * own["med_gas_r"][1]
    values["tib_ant_r"]["tendon_slack_length"] = 0.85 * own["tib_ant_r"][1]
    values["lat_gas_r"]["optimal_fiber_length"] *= 2.2  # none that a human has, and past the limit
    path = tmp_path / "made_mtp.osimx"
    path.write_text(osimx_text(values, "model.osim"), encoding="utf-8")
    assert said(surae.judge(path)) == {
        ("soleus_r", "optimal_fiber_length", "generic"),
        ("med_gas_r", "tendon_slack_length", "at-limit"),
        ("med_gas_r", "tendon_slack_length", "plain-part"),
        ("tib_ant_r", "tendon_slack_length", "plain-part"),
        ("lat_gas_r", "optimal_fiber_length", "at-limit"),
        ("lat_gas_r", "optimal_fiber_length", "outside-human"),
    }
    assert surae.judge(tmp_path).as_dict() == surae.judge(path).as_dict()  # the folder of results
    (tmp_path / "model.osim").unlink()
    alone = surae.judge(path)
    assert said(alone) == {("lat_gas_r", "optimal_fiber_length", "outside-human")}
    assert "model.osim, is not beside it" in alone.results[0].result.notes[0]


def ceinms(rng) -> dict[str, dict[str, float]]:
    return {
        name: {
            "c1": float(rng.uniform(-0.9, -0.1)),
            "c2": float(rng.uniform(-0.9, -0.1)),
            "shapeFactor": float(rng.uniform(-2.8, -0.2)),
            "optimalFibreLength": fibre,
            "pennationAngle": 0.2,
            "tendonSlackLength": 0.31 * float(rng.uniform(0.88, 1.12)),
            "maxIsometricForce": 1000.0,
            "strengthCoefficient": float(rng.uniform(0.6, 2.4)),
        }
        for name, fibre in zip(MUSCLES, FIBRES, strict=True)
    }


RANGES = {
    "c1": (False, -0.95, -0.05),
    "shapeFactor": (False, -2.999, -0.001),
    "tendonSlackLength": (True, 0.85, 1.15),
    "strengthCoefficient": (False, 0.5, 2.5),
}


@pytest.mark.parametrize("old", [False, True])
@pytest.mark.parametrize("seed", range(3))
def test_limits_of_ceinms_are_those_of_its_set_up(tmp_path, seed, old) -> None:
    values = ceinms(np.random.default_rng(seed))
    began = {name: {**of, "tendonSlackLength": 0.31} for name, of in values.items()}
    files = {n: tmp_path / f"{n}.xml" for n in ("start", "subject", "calibration")}
    files["start"].write_text(subject_text(began, old=old), encoding="utf-8")
    files["calibration"].write_text(calibration_text(RANGES), encoding="utf-8")

    def judged():
        files["subject"].write_text(subject_text(values, "start.xml", old=old), encoding="utf-8")
        opinion = surae.judge(files["subject"], calibration=files["calibration"])
        searched = ("c1", "c2", "shape_factor", "tendon_slack_length", "strength_coefficient")
        return {each for each in said(opinion) if each[1] in searched and each[2] != "at-start"}

    assert judged() == set()
    values["soleus_r"]["c1"] = -0.95
    values["med_gas_r"]["shapeFactor"] = -2.9985  # ends a little inside
    values["tib_ant_r"]["tendonSlackLength"] = 0.31 * 1.15
    values["per_long_r"]["strengthCoefficient"] = 2.5
    assert judged() == {
        ("soleus_r", "c1", "at-limit"),
        ("med_gas_r", "shape_factor", "at-limit"),
        ("tib_ant_r", "tendon_slack_length", "at-limit"),
        ("tib_ant_r", "tendon_slack_length", "plain-part"),
        ("per_long_r", "strength_coefficient", "at-limit"),
    }


def test_limits_that_no_file_states_show_where_several_muscles_stand(tmp_path) -> None:
    values = ceinms(np.random.default_rng(5))
    path = tmp_path / "subject.xml"

    def judged():
        path.write_text(subject_text(values), encoding="utf-8")
        return said(surae.judge(path))

    assert judged() == set()
    for name, at in zip(MUSCLES[:3], (-2.9990, -2.9987, -2.9989), strict=True):
        values[name]["shapeFactor"] = at
    assert judged() == {(name, "shape_factor", "at-shared-end") for name in MUSCLES[:3]}
    # muscles that share their values in groups by design are at no limit
    groups = [0.7, 0.7, 0.7, 1.3, 1.3, 2.1, 2.1]
    for name, at in zip(MUSCLES, groups, strict=True):
        values[name]["strengthCoefficient"] = at
    assert not any(p == "strength_coefficient" for _, p, _ in judged())


def test_limits_of_muscleredundancysolver_are_in_its_results(tmp_path) -> None:
    began = {
        "FMo": [3549.0, 1558.0, 905.0],
        "lMo": [0.0471, 0.0533, 0.0724],
        "lTs": [0.25, 0.39, 0.22],
        "alphao": [0.4, 0.3, 0.1],
        "kT": [35.0, 35.0, 35.0],
    }
    bounds = {"lMo": (0.7, 1.5), "lTs": (0.7, 1.5), "kT": (0.2, 1.2)}
    scales = {"lMo": [0.9132, 1.0871, 1.0], "lTs": [0.9443, 1.0312, 1.0], "kT": [0.513, 0.871, 1.0]}
    path = tmp_path / "made_Results.mat"

    def judged():
        redundancy_mat(path, [*MUSCLES[:2], "tib_ant_r"], began, scales, bounds)
        return {e for e in said(surae.judge(path)) if e[0] != "tib_ant_r" and e[2] != "generic"}

    assert judged() == set()
    kept = {p for m, p, k in said(surae.judge(path)) if m == "tib_ant_r" and k == "generic"}
    assert {"optimal_fiber_length", "tendon_slack_length", "tendon_stiffness"} <= kept
    scales["lMo"][0] = 0.7
    scales["lTs"][1] = 1.5 - 1e-7
    scales["kT"][0] = 0.2
    found = {e for e in judged() if e[2] not in ("plain-part", "outside-human")}
    assert found == {
        ("soleus_r", "optimal_fiber_length", "at-limit"),
        ("med_gas_r", "tendon_slack_length", "at-limit"),
        ("soleus_r", "tendon_stiffness", "at-limit"),
    }


def test_halves_of_generic_lengths_are_seen_in_a_matrix(tmp_path) -> None:
    import scipy.io

    rng = np.random.default_rng(3)
    generic = np.vstack(
        [
            rng.uniform(300, 3000, 20),
            rng.uniform(0.04, 0.2, 20),
            rng.uniform(0.03, 0.4, 20),
            rng.uniform(0, 0.4, 20),
        ]
    )
    own = generic.copy()
    own[1] *= rng.uniform(0.61, 0.99, 20)
    own[2] *= rng.uniform(1.01, 1.6, 20)
    own[1, :6] = 0.5 * generic[1, :6] * (1.0 + 1e-7)
    for name, matrix in (("generic", generic), ("own", own)):
        scipy.io.savemat(tmp_path / f"{name}.mat", {"MTParameters": matrix})
    opinion = surae.judge(tmp_path / "own.mat", generic=tmp_path / "generic.mat")
    fibres = {(m, k) for m, p, k in said(opinion) if p == "optimal_fiber_length"}
    assert fibres == {
        (f"muscle {place}", kind)
        for place in range(1, 7)
        for kind in ("plain-part", "at-shared-end")
    }
    assert not any(p == "tendon_slack_length" for _, p, _ in said(opinion))
    forces = {k for _, p, k in said(opinion) if p == "max_isometric_force"}
    assert forces == {"generic"}


def test_a_public_models_muscles_are_known_however_they_were_scaled(tmp_path) -> None:
    path = tmp_path / "scaled.osim"
    text = osim_text("gait")
    path.write_text(text, encoding="utf-8")
    assert said(surae.judge(path)) == set()
    # soleus of a public model, scaled by 0.93
    scaled = text.replace(
        "<optimal_fiber_length>0.047<", f"<optimal_fiber_length>{0.93 * 0.05!r}<"
    ).replace("<tendon_slack_length>0.255<", f"<tendon_slack_length>{0.93 * 0.25!r}<")
    path.write_text(scaled, encoding="utf-8")
    assert said(surae.judge(path)) == {
        (f"soleus_{side}", parameter, "generic-scaled")
        for side in "rl"
        for parameter in ("optimal_fiber_length", "tendon_slack_length")
    }
    path.write_text(text.replace("<optimal_fiber_length>0.047<", "<optimal_fiber_length>0.13<"))
    assert {e[2] for e in said(surae.judge(path))} == {"outside-human"}


def test_what_it_says_is_in_every_language_and_file(tmp_path) -> None:
    values = nmsm(np.random.default_rng(0))
    values["soleus_r"]["electromechanical_delay"] = 0.0
    path = tmp_path / "muscleModelParameters.sto"
    path.write_text(sto_text(values), encoding="utf-8")
    opinion = surae.judge(path)
    assert "1 at-limit" in opinion.summary[0]
    assert opinion.to_dataframe().shape[0] == 6 * len(MUSCLES)
    opinion.save(tmp_path / "j.json")
    plain = json.loads((tmp_path / "j.json").read_text(encoding="utf-8"))
    (result,) = plain["results"]
    assert result["program"] == "NMSM"
    assert result["counts"] == {"at-limit": 1}
    for language, word in {
        "en": "lower limit of its search, 0.",
        "nl": "ondergrens van het zoeken, 0.",
        "de": "unteren Grenze der Suche, 0.",
        "fr": "limite inférieure de la recherche, 0.",
    }.items():
        page = tmp_path / f"{language}.html"
        opinion.report(page, language=language)
        assert word in page.read_text(encoding="utf-8")


@pytest.mark.parametrize(
    ("name", "data", "message"),
    [
        ("empty.xml", b"<a/>", "<a> is no result that is known"),
        ("cut.osimx", b"<NMSMPipelineDocument><OsimxModel", "not XML"),
        ("doctype.xml", b"<!DOCTYPE a [<!ENTITY b 'c'>]><a>&b;</a>", "document type"),
        ("none.osim", b"<OpenSimDocument><Model/></OpenSimDocument>", "has no muscle"),
        ("subject.xml", b"<subject><mtuSet/></subject>", "has no muscle"),
        ("short.sto", b"a\nendheader\ntime\tsol_r\n1\t2\n", "it has 1 rows"),
        ("no.mat", b"MATLAB 5.0 MAT-file" + 200 * b"\0", "MATLAB that cannot be read"),
    ],
)
def test_a_wrong_file_is_refused_in_a_line(tmp_path, name, data, message) -> None:
    path = tmp_path / name
    path.write_bytes(data)
    with pytest.raises(InputError) as refused:
        surae.judge(path)
    assert message in str(refused.value)
    assert "\n" not in str(refused.value)


def test_what_does_not_belong_together_is_refused(tmp_path) -> None:
    one, two = tmp_path / "one.sto", tmp_path / "two.sto"
    values = nmsm(np.random.default_rng(0))
    one.write_text(sto_text(values), encoding="utf-8")
    two.write_text(sto_text({"other_r": values["soleus_r"]}), encoding="utf-8")
    with pytest.raises(InputError, match="none of the muscles"):
        surae.judge(one, generic=two)
    (tmp_path / "empty").mkdir()
    with pytest.raises(InputError, match="no result is in this folder"):
        surae.judge(tmp_path / "empty")
    with pytest.raises(InputError, match="no result is given"):
        surae.judge([])
