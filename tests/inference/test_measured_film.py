"""A leg that was measured and filmed: what a film must show, and what must not be said of it."""

import numpy as np
import pytest

import surae
from surae.inference.judging.fascicles import fascicles_of
from surae.planning.information import covariance_if_filmed
from surae.report.budget import what_would_help

TRIALS = {"PL_50_01": "dynamometer", "PL_0_01": "repeats"}
#: Trackers drift by a millimetre or two within seconds.
DRIFT_MM = 2.0
#: Optimum of the filmed fascicle by an independent analysis with a plainer model [mm].
ANALYSED = (63.5, 63.8)
MAPPED = {"angle": ("Angle", "deg"), "torque": ("Torque", "Nm"), "emg_ta": ("EMG_TA", "V")}


@pytest.fixture(scope="module")
def measured(shared, tmp_path_factory):
    """Makes a recording of a measured trial, with its film or without."""
    if not (shared / "ultrasound").is_dir():
        pytest.skip("the shared measured films are not here")

    def make(trial: str, *, film: bool = True) -> surae.Recording:
        file = shared / TRIALS[trial] / f"{trial}.mat"
        text = f'name = "{trial}"\nemg = "raw"\nfixed = {{ g2 = 0.0, g3 = 0.0, g4 = 0.0 }}\n'
        for role, (column, unit) in MAPPED.items():
            text += f'[channels.{role}]\nfile = "{file}"\ncolumn = "{column}"\nunit = "{unit}"\n'
            text += "" if role == "emg_ta" else "sign = -1\n"
        if film:
            seen = shared / "ultrasound" / f"{trial}_fascicles.csv"
            text += f'[channels.fascicle_tib]\nfile = "{seen}"\n'
            text += 'column = "fascicle_superficial_mm"\nunit = "mm"\n'
        mapping = tmp_path_factory.mktemp("map") / "map.toml"
        mapping.write_text(text, encoding="utf-8")
        return surae.read(mapping)

    return make


@pytest.fixture(scope="module")
def compliant(measured):
    return surae.fit(measured("PL_0_01"), quality=())


def _said_of_films(fit: surae.Fit) -> list[str]:
    return [reason for reason in fit.adequacy.reasons if "film" in reason]


@pytest.mark.slow
def test_a_rigid_tendon_does_not_follow_the_film(measured) -> None:
    fit = surae.fit(measured("PL_0_01"), "muscle", starts=1, quality=())
    (said,) = _said_of_films(fit)
    assert "its tendon is rigid" in said
    assert fit.adequacy.grade != "adequate"
    assert fit.measures()["optimal_fascicle_tib"].value is None


@pytest.mark.slow
def test_nothing_is_said_of_a_film_that_is_not_there(measured) -> None:
    fit = surae.fit(measured("PL_0_01", film=False), "muscle", starts=1, quality=())
    assert not _said_of_films(fit)
    assert "not filmed" in fit.measures()["optimal_fascicle_tib"].note
    assert not len(fit.fascicles)


@pytest.mark.slow
def test_a_compliant_tendon_follows_the_film_and_predicts_another(compliant, measured) -> None:
    (film,) = compliant.assessment.recordings[0].fascicles
    assert film.rmse_mm < 1.0
    assert not _said_of_films(compliant)
    (other,) = compliant.predict(measured("PL_50_01")).fascicles
    assert other.quality.rmse_mm < DRIFT_MM
    # Of true lengths the film would be as far: it is the truth and its tracker's drift.
    alike = np.sqrt(1.0 - (DRIFT_MM / (1e3 * np.std(other.measured))) ** 2)
    assert other.quality.correlation > alike


@pytest.mark.slow
def test_the_filmed_optimum_is_known_and_the_whole_muscles_holds_it(compliant) -> None:
    optimum = compliant.measures()["optimal_fascicle_tib"]
    low, high = optimum.ci95
    assert low < ANALYSED[0] < ANALYSED[1] < high
    assert 0.5 * (high - low) < 0.2 * optimum.value
    # a doubtful fit claims no measure, however narrow
    assert (optimum.verdict == "weak") == (compliant.adequacy.grade == "doubtful")
    whole = compliant.parameters["l0_tib"]
    assert np.ptp(whole.ci95) > 1e-3 * np.ptp(optimum.ci95)
    assert whole.budget["film"] + whole.budget["lengths"] > 0.3


@pytest.mark.slow
def test_without_its_film_a_fit_does_not_contradict_it(compliant, measured) -> None:
    blind = surae.fit(measured("PL_0_01", film=False), quality=())
    for name, known in compliant.parameters.items():
        of_blind = blind.parameters[name]
        if of_blind.verdict == "identified" and known.ci95:
            assert of_blind.ci95[0] <= known.ci95[1], name
            assert of_blind.ci95[1] >= known.ci95[0], name
    assert fascicles_of(blind.result) == ()


@pytest.mark.slow
def test_a_film_is_advised_where_there_is_none_and_keeps_its_word(compliant, measured) -> None:
    assert not any("ilm the tibialis" in h for h in what_would_help(compliant))
    blind = surae.fit(measured("PL_0_01", film=False), quality=())
    (advice,) = (h for h in what_would_help(blind) if "ilm the tibialis" in h)
    assert "instead of" in advice
    told = covariance_if_filmed(*_known(blind), "tib")
    at = blind.result.problem.free.index("dlt_tib")
    promised = np.sqrt(told[at, at]) / blind.result.values["dlt_tib"]
    low, high = compliant.parameters["dlt_tib"].ci95
    kept = np.log(high / low) / 3.92
    assert 0.5 < kept / promised < 2.0


def _known(fit: surae.Fit):
    return fit.result, fit.assessment.uncertainty
