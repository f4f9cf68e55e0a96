"""Default priors: consistent with the virtual populations, and a help where data are weak."""

import numpy as np
import pytest

from surae.base.errors import InputError
from surae.inference import Prior, assess, fit_problem, make_problem
from surae.inference.population_priors import WIDENED, population_priors, wide_priors
from surae.model import ModelOptions, get_model
from surae.model.parameters import MUSCLE_PARAMETERS, TENDON_PARAMETERS
from surae.model.registry import PARAMETERS
from surae.protocol import Protocol, generate
from surae.studies import POPULATIONS, virtual_subject, virtual_trial
from surae.studies.populations import TENDONS


@pytest.mark.parametrize("population", POPULATIONS)
def test_priors_lie_in_the_middle_of_the_virtual_population_and_are_as_wide(population):
    ranges = POPULATIONS[population] | TENDONS[population]
    records = {name: p.known[population] for name, p in PARAMETERS.items() if p.known}
    assert len(records) > 12
    for name, known in records.items():
        low, high = ranges[name]
        assert known.median == pytest.approx(np.sqrt(low * high), rel=0.02), name
        assert known.spread >= 0.98 * np.log(high / low) / 2, name
        assert len(known.source) > 20


@pytest.mark.parametrize("population", POPULATIONS)
def test_every_parameter_but_the_weights_has_a_prior_within_its_bounds(population):
    table = {p.name: p for p in (*MUSCLE_PARAMETERS, *TENDON_PARAMETERS)}
    known = population_priors(population)
    assert set(known) >= {p.name for p in MUSCLE_PARAMETERS if not p.name.startswith("g")}
    assert not {"g1", "g2", "g3", "g4", "e1", "e2", "e3", "e4"} & set(known)
    for name, (median, _) in known.items():
        assert table[name].lower < median < table[name].upper, name


def test_populations_have_the_same_parameters():
    for p in PARAMETERS.values():
        assert not p.known or set(p.known) == set(POPULATIONS)


def test_priors_follow_the_model_options():
    virtual = population_priors("healthy", ModelOptions(geometry="virtual-work"))
    assert not {"k_tri", "x0_tib", "l0_tri"} & set(virtual)
    assert {"m", "tau_rel", "f0"} <= set(virtual)
    strain = population_priors("healthy", ModelOptions(tendon_strain="slack-length"))
    assert strain["dlt_tri"][0] == pytest.approx(0.0374 / 0.415)
    assert strain["dlt_tri"][1] == population_priors("healthy")["dlt_tri"][1]


@pytest.mark.parametrize("strain", ["thesis", "slack-length"])
def test_the_wide_ones_are_those_of_health_but_wider_and_hold_for_patients(strain):
    options = ModelOptions(tendon_strain=strain)
    wide = wide_priors(options)
    for name, (median, spread) in population_priors("healthy", options).items():
        assert wide[name] == (median, WIDENED * spread)
    for name, (median, _) in population_priors("patient", options).items():
        assert abs(np.log(median / wide[name][0])) < wide[name][1], name


def test_the_wide_ones_follow_the_geometry_and_the_emg():
    virtual = wide_priors(ModelOptions(geometry="virtual-work"), "1")
    assert set(virtual) == set(wide_priors())
    differ = {name for name, pair in wide_priors().items() if virtual[name] != pair}
    weights = {f"{kind}{number}" for kind in "ge" for number in (1, 2, 3, 4)}
    assert differ == weights | {"k_tri", "k_tib", "x0_tri", "x0_tib", "l0_tri", "l0_tib"}


@pytest.mark.parametrize("model", ["muscle", "muscle-tendon-toe", "muscle-2010"])
def test_only_free_parameters_get_one_and_given_ones_go_first(noisy, model):
    problem = make_problem(
        [noisy], model, population="patient", fixed={"m": 2.0}, priors={"k_tri": (180.0, 0.1)}
    )
    assert problem.priors["k_tri"] == Prior(180.0, 0.1)
    free = set(get_model(model).free) - {"m"}
    assert set(problem.priors) == free & set(population_priors("patient"))
    assert problem.priors["x0_tri"] == Prior(0.0155, 0.12)


def test_a_priors_row_is_its_deviation_and_the_derivative():
    prior = Prior(2.0, 0.4)
    for value in (0.3, 2.0, 7.0):
        slope, away = prior.row(value)
        assert away == pytest.approx(np.log(value / prior.median) / prior.spread)
        step = 1e-6 * value
        numeric = (prior.row(value + step)[1] - prior.row(value - step)[1]) / (2.0 * step)
        assert slope == pytest.approx(numeric, rel=1e-6)


def test_a_priors_logarithm_ends_where_the_parameter_does():
    assert Prior(2.0, 0.5).row(0.0) == Prior(2.0, 0.5).row(2e-6)
    assert np.isfinite(Prior(2.0, 0.5).row(0.0)).all()


def test_a_population_unknown(noisy):
    with pytest.raises(InputError, match="'athletes'; use one of: healthy, patient"):
        make_problem([noisy], population="athletes")


@pytest.mark.slow
def test_priors_help_where_the_data_are_weak():
    """Three seconds say little of a relaxation that takes seconds."""
    motion = generate(
        Protocol(
            profile="multiple-holds",
            chirp_amplitude=0.2,
            chirp_rate=0.5,
            rate_hz=64.0,
            duration=3.0,
            task="active",
        )
    )
    plain, informed, errors = [], [], []
    for seed in range(1, 9):
        subject = virtual_subject(seed)
        trial = virtual_trial(subject, motion)
        for population, found in ((None, plain), ("healthy", informed)):
            result = fit_problem(make_problem([trial], population=population), starts=2)
            values = result.values
            found.append(np.log(values["tau_rel"] / subject.parameters["tau_rel"]))
            if population:
                errors.append(assess(result).parameters["tau_rel"].sem)
    wrong, better = (np.sqrt(np.mean(np.square(found))) for found in (plain, informed))
    assert wrong > 0.8  # a factor of two and more
    assert better < 0.5 * wrong
    assert None not in errors  # and no estimate at a bound
