"""The public functions: every form of recording, the same numbers whichever way they are called."""

import ast
from dataclasses import replace
from pathlib import Path

import numpy as np
import pytest

import surae
from surae.base.errors import InputError
from surae.base.setting import settings_of
from surae.model.parameters import MUSCLE_PARAMETERS
from surae.protocol import Protocol, generate
from surae.settings import FIT_RECORDS
from surae.studies import virtual_subject, virtual_trial

FIFTEEN = [p.name for p in MUSCLE_PARAMETERS]


def test_keywords_for_type_checkers_are_the_settings() -> None:
    told = {f.name for kind in FIT_RECORDS for f, _ in settings_of(kind)} - {"model"}
    stub = Path(surae.api.__file__).with_name("keywords.pyi").read_text(encoding="utf-8")
    (keywords,) = (part for part in ast.parse(stub).body if isinstance(part, ast.ClassDef))
    named = {each.target.id for each in keywords.body if isinstance(each, ast.AnnAssign)}
    assert named == told


def trial(seed=1, noise=0.02):
    protocol = Protocol(profile="multiple-holds", chirp_amplitude=0.2, chirp_rate=0.5, rate_hz=64.0)
    return virtual_trial(virtual_subject(seed), generate(protocol), noise=noise)


@pytest.fixture(scope="module")
def inputs():
    return trial()


@pytest.fixture(scope="module")
def path(inputs, tmp_path_factory):
    """The trial as a CSV file, EMG as envelopes."""
    where = tmp_path_factory.mktemp("api") / "trial.csv"
    columns = [
        inputs.time,
        inputs.angle,
        inputs.torque,
        *inputs.emg.T,
        inputs.velocity,
        inputs.acceleration,
    ]
    header = (
        "# emg: envelope\n"
        "time_s,angle_rad,torque_Nm,emg_ta_V,emg_gl_V,emg_sol_V,emg_gm_V,"
        "angular_velocity_rad_s,angular_acceleration_rad_s2"
    )
    np.savetxt(where, np.stack(columns, axis=1), "%.17g", ",", header=header, comments="")
    return where


@pytest.fixture(scope="module")
def fit(inputs):
    return surae.fit(inputs, "muscle", starts=1)


def same(first, other):
    assert first.values == other.values
    assert first.result.sse == other.result.sse


def test_fit_of_any_form_of_recording(fit, inputs, path):
    recording = surae.read(path)
    for given in ((inputs,), str(path), [path], recording, surae.prepare(recording, prepared=True)):
        same(surae.fit(given, "muscle", prepared=True, starts=1), fit)


def test_one_start_claims_neither_parameters_nor_measures_and_two_do(fit, inputs):
    def claimed(of):
        measures = of.measures(angles=[0.0]).values()
        found = [m.name for m in measures if m.verdict == "identified" and m.basis == "model"]
        return [p.name for p in of.parameters.values() if p.verdict == "identified"], found

    assert claimed(fit) == ([], [])
    parameters, measures = claimed(surae.fit(inputs, "muscle", starts=2))
    assert parameters
    assert measures


def test_the_contract_s_example(fit):
    p = fit.parameters["l0_tri"]
    assert p.value == fit.values["l0_tri"] == fit.result.values["l0_tri"]
    assert p.ci95[0] < p.value < p.ci95[1]
    assert p.sem > 0
    assert p.verdict == "undetermined"  # a length is known only as well as its path
    assert p.repeatable
    assert fit["f0"].verdict == "weak"  # one start may have ended in a higher minimum
    assert fit.vaf > 99.9
    k = len(fit.covariance.names)
    assert fit.correlation.shape == (k, k)
    assert (
        fit.correlation.loc["k_tri", "x0_tri"]
        == fit.covariance.correlation[
            fit.covariance.names.index("k_tri"), fit.covariance.names.index("x0_tri")
        ]
    )
    assert fit["l0_tri"] is p
    assert fit.covariance.matrix.shape == (k, k)
    assert fit.ipde > 0
    assert fit.status in ("converged", "at-bounds")
    assert "starts" in fit.message
    assert list(fit.parameters) == list(fit.values) == FIFTEEN


def test_an_unknown_option_lists_the_known_ones(inputs, fit):
    message = (
        r"option 'geometri' is not known \(did you mean 'geometry'\?\); use one of: geometry, "
    )
    with pytest.raises(InputError, match=message):
        surae.fit(inputs, "muscle", geometri="thesis")
    with pytest.raises(InputError, match=message):
        surae.simulate("muscle", fit.values, inputs, geometri="thesis")


def test_simulate_gives_the_torque_of_the_fit(fit, inputs):
    torque = surae.simulate("muscle", fit.values, inputs)
    assert torque.shape == (inputs.n,)
    np.testing.assert_allclose(torque, inputs.torque - fit.result.residuals[0], atol=1e-9)


def test_simulate_from_a_file_uses_the_signals_as_they_are(fit, inputs, path):
    np.testing.assert_array_equal(
        surae.simulate("muscle", dict(fit.values), path),
        surae.simulate("muscle", dict(fit.values), inputs),
    )


def test_the_columns_of_the_jacobian(fit, inputs):
    model, extra = "muscle-tendon-strain", ["dlt_tri", "dlt_tib"]
    values = {name: fit.values[name] for name in FIFTEEN} | dict.fromkeys(extra, 0.04)
    torque, jacobian = surae.simulate(model, values, inputs, jacobian=True)
    assert torque.shape == (inputs.n,)
    assert jacobian.shape == (inputs.n, 15 + len(extra))
    np.testing.assert_allclose(torque, surae.simulate(model, values, inputs), atol=1e-12)
    for j, name in enumerate(FIFTEEN + extra):
        step = 3e-5 * values[name]
        up, down = (
            surae.simulate(model, values | {name: values[name] + s}, inputs) for s in (step, -step)
        )
        slope = (up - down) / (2 * step)
        # Single samples may cross the kink of (11) within the step.
        error = np.abs(jacobian[:, j] - slope)
        assert np.quantile(error, 0.99) < 1e-4 * np.abs(slope).max() + 1e-12, name


def test_predict_and_validate(fit, inputs):
    other = trial(seed=1, noise=0.05)
    predicted = fit.predict(other)
    (again,) = surae.validate(fit, [other])
    residual = other.torque - surae.simulate("muscle", fit.values, other)
    for prediction in (predicted, again):
        assert prediction.vaf == pytest.approx(
            100 * (1 - residual @ residual / (other.torque @ other.torque)), rel=1e-13
        )
        assert prediction.rmse == pytest.approx(np.sqrt(np.mean(residual**2)), rel=1e-13)
        assert prediction.bias == pytest.approx(residual.mean(), abs=1e-12)
        assert prediction.name == other.name
    assert fit.predict(inputs).vaf == pytest.approx(fit.vaf, rel=1e-12)


def test_predict_prepares_as_the_fit_did(fit, path):
    # This fit used the signals as they are, so a file is used as it is too.
    as_it_is = fit.predict(path)
    assert as_it_is.vaf == pytest.approx(fit.vaf, rel=1e-9)
    assert fit.predict(path, prepared=True).vaf == as_it_is.vaf
    filtered = fit.predict(path, prepared=False)
    assert filtered.vaf != as_it_is.vaf
    (validated,) = surae.validate(fit, [path], prepared=False)
    assert validated.vaf == filtered.vaf


def test_predict_filters_where_the_fit_did(path):
    filtered = surae.fit(path, "muscle", starts=1)
    assert not filtered.result.problem.inputs[0].prepared
    assert filtered.predict(path).vaf == pytest.approx(filtered.vaf, rel=1e-9)


def test_predict_remembers_the_options(inputs):
    other = surae.fit(inputs, "muscle", starts=1, geometry="virtual-work")
    assert other.predict(inputs).vaf == pytest.approx(other.vaf, rel=1e-12)


def test_weights_in_volts_say_nothing_of_normalised_emg(fit, inputs):
    with pytest.raises(InputError, match="the weights do not carry over"):
        fit.predict(replace(inputs, emg_unit="1"))


def test_a_muscle_whose_weight_was_estimated_must_be_there(fit, inputs):
    with pytest.raises(InputError, match=r"no EMG of muscle 'gl'.*emg_gl"):
        fit.predict(replace(inputs, missing_emg=("gl",)))


def test_predict_without_a_torque(fit, inputs):
    with pytest.raises(InputError, match="no torque"):
        fit.predict(replace(inputs, torque=None))
