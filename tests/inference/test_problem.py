"""Every refusal with its message, and what a problem holds."""

from dataclasses import replace

import numpy as np
import pytest

from surae.base.errors import InputError
from surae.inference import make_problem
from surae.inference.least_squares.residuals import Residuals
from surae.model import ModelOptions
from surae.model.parameters import MUSCLE_PARAMETERS
from surae.signals import emg_sizes

FIFTEEN = tuple(p.name for p in MUSCLE_PARAMETERS)


def refused(*args, **kwargs):
    """The message of the refusal: always one line."""
    with pytest.raises(InputError) as caught:
        make_problem(*args, **kwargs)
    text = str(caught.value)
    assert "\n" not in text
    return text


def test_the_default_problem(clean):
    problem = make_problem([clean])
    assert problem.free == FIFTEEN
    assert problem.n == clean.n
    assert problem.spec.name == "muscle"
    np.testing.assert_array_equal(problem.start, problem.base)
    assert np.all((problem.lower < problem.start) & (problem.start < problem.upper))


def test_no_recording():
    assert "nothing to fit" in refused([])


def test_unknown_model(clean):
    text = refused([clean], "muscles")
    assert "'muscles'" in text
    assert "muscle-tendon-toe" in text


@pytest.mark.parametrize(
    "given",
    [
        {"fixed": {"l0": 1.0}},
        {"free": ("l0",)},
        {"start": {"l0": 1.0}},
        {"bounds": {"l0": (0.0, 1.0)}},
    ],
)
def test_unknown_parameter_lists_the_known_ones(clean, given):
    text = refused([clean], **given)
    assert "'l0'" in text
    assert all(name in text for name in FIFTEEN)


def test_a_parameter_of_another_model_is_unknown(clean):
    assert "no parameter 'dlt_tri'" in refused([clean], "muscle", fixed={"dlt_tri": 0.04})


def test_free_and_fixed(clean):
    assert "beta is both free and fixed" in refused([clean], fixed={"beta": 1.0}, free=("beta",))


@pytest.mark.parametrize("value", [np.nan, -np.inf, True, "1"])
@pytest.mark.parametrize("where", ["fixed", "start"])
def test_a_value_that_is_no_number(clean, where, value):
    text = refused([clean], **{where: {"beta": value}})
    assert "beta" in text
    assert "finite number" in text


@pytest.mark.parametrize("where", ["fixed", "start"])
def test_a_negative_value(clean, where):
    assert "m is -1 kg; it must be zero or more" in refused([clean], **{where: {"m": -1.0}})
    assert "f0 is 0 Hz; it must be above zero" in refused([clean], **{where: {"f0": 0.0}})


@pytest.mark.parametrize("pair", [(2.0, 1.0), (1.5, 1.5)])
def test_bounds_reversed(clean, pair):
    text = refused([clean], bounds={"m": pair})
    assert "bounds of m" in text
    assert "lower must be the smaller" in text


@pytest.mark.parametrize("pair", [(-1.0, 2.0), (0.5, np.inf), (np.nan, 2.0)])
def test_bounds_that_are_not_physical(clean, pair):
    assert "m is" in refused([clean], bounds={"m": pair})


@pytest.mark.parametrize("bounds", [(1.0,), (1.0, 2.0, 3.0), 2.0, None])
def test_bounds_of_another_shape(clean, bounds):
    assert "bounds of m" in refused([clean], bounds={"m": bounds})


def test_start_outside_the_bounds(clean):
    text = refused([clean], start={"m": 5.0})
    assert "start of m is 5, outside its bounds 1.2 … 3" in text
    text = refused([clean], start={"m": 2.0}, bounds={"m": (0.5, 1.5)})
    assert "outside its bounds 0.5 … 1.5" in text


def test_a_default_start_outside_given_bounds_is_brought_in(clean):
    problem = make_problem([clean], bounds={"m": (0.5, 1.5)})
    assert problem.start[0] == 1.5


def test_everything_fixed(clean):
    values = dict(zip(FIFTEEN, make_problem([clean]).base.tolist(), strict=True))
    assert "every parameter is fixed" in refused([clean], fixed=values)


@pytest.mark.parametrize(("muscle", "weight"), [("ta", "g1"), ("gl", "g2"), ("gm", "g4")])
def test_missing_emg_needs_its_weight_fixed(clean, muscle, weight):
    lacking = replace(clean, missing_emg=(muscle,))
    text = refused([lacking])
    assert f"no EMG of muscle '{muscle}'" in text
    assert f"{weight}=0" in text
    problem = make_problem([lacking], fixed={weight: 0.0})
    assert weight not in problem.free


def test_two_recordings_that_prescribe_different_values(clean):
    one, two = (replace(clean, fixed={"m": value}) for value in (0.0, 1.5))
    assert "fixes m at 1.5, another recording at 0" in refused([one, two])


def test_a_recording_prescribes_and_the_user_overrides(clean):
    prescribing = replace(clean, fixed={"m": 0.0})
    assert make_problem([prescribing]).base[0] == 0.0
    assert "m" not in make_problem([prescribing]).free
    assert make_problem([prescribing], fixed={"m": 1.0}).base[0] == 1.0
    assert "m is both free and fixed" in refused([prescribing], free=("m",))


def test_a_recording_that_prescribes_an_unknown_parameter(clean):
    assert "no parameter 'mass'" in refused([replace(clean, fixed={"mass": 0.0})])


def test_mixed_emg_units(clean):
    text = refused([clean, replace(clean, emg_unit="1")])
    assert "some recordings have EMG in V and some normalised" in text


def test_normalised_emg_has_its_own_weights(clean):
    problem = make_problem([replace(clean, emg_unit="1", emg=clean.emg / clean.emg.max(axis=0))])
    assert problem.upper[problem.free.index("g2")] == pytest.approx(2e4, rel=0.3)


@pytest.mark.parametrize("size", [1e-3, 1e3])
def test_weights_have_the_bounds_and_start_of_their_electrodes(clean, size):
    """No unit and no gain of an amplifier decides: what an effort is, the leg itself shows."""
    plain, other = (
        make_problem([replace(clean, emg=clean.emg * s)], free=("emg_rest",)) for s in (1.0, size)
    )
    for name, p in plain.table.items():
        q = other.table[name]
        factor = 1 / size if name in plain.spec.weights else size if "emg_rest" in name else 1.0
        assert (q.start, q.lower, q.upper) == pytest.approx(
            (factor * p.start, factor * p.lower, factor * p.upper)
        )
    weights = [plain.free.index(name) for name in plain.spec.weights]
    assert plain.upper[weights] == pytest.approx(size * other.upper[weights])


def test_an_electrode_without_effort_is_amplified_as_the_others(clean):
    """Noise of an electrode is no effort that could be as weak as it."""
    quiet = clean.emg.copy()
    quiet[:, 2] = 1e-6 * (1.0 + 0.1 * np.sin(np.arange(len(quiet))))
    sizes = emg_sizes([replace(clean, emg=quiet)])
    assert min(sizes) < sizes[2] < max(sizes)
    assert sizes[2] > 0.1 * emg_sizes([clean])[2]


def cut(inputs, n):
    """The first `n` samples."""
    names = ("time", "angle", "velocity", "acceleration", "emg", "torque")
    return replace(inputs, **{name: getattr(inputs, name)[:n] for name in names})


def test_too_few_samples(clean):
    # From the middle, where the angle moves.
    names = ("time", "angle", "velocity", "acceleration", "emg", "torque")
    late = replace(clean, **{name: getattr(clean, name)[1000:] for name in names})
    assert "15 samples cannot determine 15 parameters" in refused([cut(late, 15)])
    assert make_problem([cut(late, 16)]).n == 16
    assert make_problem([cut(late, 8), cut(late, 8)]).n == 16


def test_no_torque(clean):
    assert "no torque" in refused([replace(clean, torque=None)])


def test_nothing_moves(clean):
    still = np.zeros(clean.n)
    assert "angle never changes" in refused([replace(clean, angle=still)])
    assert "torque never changes" in refused([replace(clean, torque=still)])
    assert "torque never changes" in refused([clean, replace(clean, torque=still)])


def test_fixed_lies_within_the_bounds_unless_others_are_given(clean):
    assert "fixed value of k_rel is 7, outside its bounds 0 … 3" in refused(
        [clean], fixed={"k_rel": 7.0}
    )
    problem = make_problem([clean], fixed={"k_rel": 7.0}, bounds={"k_rel": (0.0, 10.0)})
    assert problem.values(problem.start)[problem.spec.names.index("k_rel")] == 7.0


def test_a_mass_that_was_weighed_may_be_any_foots(clean):
    problem = make_problem([clean], fixed={"m": 0.0})
    assert problem.values(problem.start)[problem.spec.names.index("m")] == 0.0
    assert "fixed value of m is 99" in refused([clean], fixed={"m": 99.0})


def test_free_adds_a_tendon_parameter(clean):
    problem = make_problem([clean], "muscle-tendon", free=("pt_tri",))
    assert problem.free == (*FIFTEEN, "pt_tri")
    assert make_problem([clean], "muscle", free=("m",)).free == FIFTEEN


def test_options_move_starts_and_bounds(clean):
    thesis, other = (
        make_problem([clean], options=ModelOptions(geometry=geometry))
        for geometry in ("thesis", "virtual-work")
    )
    j = thesis.free.index("l0_tri")
    assert other.start[j] > thesis.start[j]
    assert other.upper[j] > thesis.upper[j]


def test_the_problem_keeps_nothing_of_what_was_given(clean):
    fixed, bounds = {"beta": 1.0}, {"m": (1.0, 2.5)}
    problem = make_problem([clean], fixed=fixed, bounds=bounds)
    fixed["beta"], bounds["m"] = 2.0, (1.0, 1.1)
    assert problem.values(problem.start)[-1] == 1.0
    assert problem.upper[0] == 2.5


def test_residuals_of_two_recordings(clean, noisy, subject):
    problem = make_problem([clean, noisy], fixed={"beta": subject.parameters["beta"]})
    residuals = Residuals(problem)
    truth = np.array([subject.parameters[name] for name in problem.free])
    rows = residuals.rows(truth).copy()
    assert rows.shape == (15, clean.n + noisy.n)
    first, second = residuals.of(truth)
    np.testing.assert_allclose(first, 0.0, atol=1e-12)
    assert np.std(second) > 0.01
    np.testing.assert_allclose(rows[-1], -np.concatenate([first, second]), atol=1e-10)
    assert residuals.sse([first, second]) == pytest.approx(rows[-1] @ rows[-1])
    # Each part is what its recording alone gives, and the order is that of the recordings.
    alone = Residuals(make_problem([noisy], fixed={"beta": subject.parameters["beta"]}))
    np.testing.assert_array_equal(rows[:, clean.n :], alone.rows(truth))


def test_a_prior_adds_its_part_to_the_problem(noisy):
    problem = make_problem([noisy], priors={"tau_rel": (3.0, 0.2), "l0_tri": (0.05, 0.1)})
    residuals = Residuals(problem, noise=0.7)
    x = problem.start
    rows = residuals.rows(x).copy()
    assert rows.shape == (16, noisy.n + 2)
    j = problem.free.index("tau_rel")
    assert rows[-1, noisy.n] == pytest.approx(0.7 * np.log(x[j] / 3.0) / 0.2)
    step = 1e-6
    moved = x.copy()
    moved[j] += step
    slope = (residuals.rows(moved)[-1, noisy.n] - rows[-1, noisy.n]) / step
    assert rows[j, noisy.n] == pytest.approx(slope, rel=1e-5)
    assert np.count_nonzero(rows[:-1, noisy.n :]) == 2


def test_weights_scale_residual_and_jacobian(noisy):
    weight = np.where(noisy.time < noisy.time.mean(), 4.0, 0.0)
    problem = make_problem([replace(noisy, weight=weight)])
    plain, weighted = Residuals(make_problem([noisy])), Residuals(problem)
    x = problem.start
    np.testing.assert_allclose(weighted.rows(x), plain.rows(x) * np.sqrt(weight), rtol=1e-12)
    assert problem.n == np.count_nonzero(weight)


@pytest.mark.parametrize(
    ("priors", "words"),
    [
        ({"nope": (1.0, 0.1)}, "it is not estimated"),
        ({"beta": (0.0, 0.1)}, "must be above zero"),
        ({"beta": (1.0, -0.1)}, "must be above zero"),
        ({"beta": (1.0, True)}, "must be above zero"),
        ({"beta": 1.0}, "give its median and its spread"),
    ],
)
def test_priors_that_are_refused(clean, priors, words):
    assert words in refused([clean], priors=priors)


@pytest.mark.parametrize("weight", [-1.0, np.nan, np.inf])
def test_weights_that_are_refused(clean, weight):
    weights = np.ones(clean.n)
    weights[3] = weight
    assert "weight must hold" in refused([replace(clean, weight=weights)])
    assert "weight must hold" in refused([replace(clean, weight=np.ones(3))])
