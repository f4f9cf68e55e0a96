"""Tissue that no exponential describes goes from rest to the muscles' fit; any other does not."""

from dataclasses import replace

import numpy as np
import pytest

from relaxed_ankle import Ankle, efforts, measured, movement
from surae.base.errors import InputError
from surae.inference.noise import NoiseModel
from surae.inference.posterior import laplace
from surae.inference.posterior.empirical_bayes import BEGIN
from surae.inference.posterior.family import Family
from surae.inference.problem import make_problem
from surae.inference.relaxed.build import curve_of
from surae.inference.relaxed.context import Laboratory
from surae.inference.relaxed.cut import doubts_of, tissue_beside, with_rest
from surae.inference.relaxed.regressors import TAUS
from surae.model import ModelOptions, get_model
from surae.model.tissue_curve import TissueCurve
from surae.recording import read
from surae.settings import FitSettings
from surae.signals.windows import parted

TIME = movement()[0]
EMG = efforts(TIME, (10.0, 30.0))


class Exponential(Ankle):
    """A leg whose tissue is what the models' is."""

    def torque(self, degrees):
        return 10.0 * np.exp((degrees - 20.0) / 14.0) - 0.5 * np.exp(-(degrees + 40.0) / 15.0)


def problem(ankle, seed=1):
    inputs = FitSettings.of().inputs(parted([measured(ankle, seed, emg=EMG)]))
    return make_problem(inputs, "auto")


@pytest.fixture(scope="module")
def toe():
    """A linear–quadratic tissue that begins at 0°, steep."""
    return problem(Ankle(toe=-5.0, stiff=0.8))


def test_a_toe_is_taken_from_rest(toe) -> None:
    asked = with_rest(toe)
    tissue = asked.options.tissue
    assert tissue is not None
    assert tissue.seconds == TAUS
    assert asked.inputs is toe.inputs
    curve = curve_of(toe.inputs, Laboratory.of(toe.settings))
    assert tissue.degrees[0] == pytest.approx(curve.low)
    assert 0.1 < np.ptp(tissue.torque) < 0.5 * np.ptp(curve.torque([curve.low, curve.high])[0])
    again = with_rest(asked)
    assert again is asked  # what is there stays


def test_an_exponential_stays_alone() -> None:
    for seed in range(3):
        asked = problem(Exponential(), seed)
        assert with_rest(asked) is asked


def test_rest_that_is_declared_or_short_gives_nothing(toe) -> None:
    ankle = Ankle(toe=-5.0, stiff=0.8)
    alone = FitSettings.of().inputs(parted([measured(ankle, 1)]))
    declared = make_problem(alone, "auto")
    assert with_rest(declared) is declared
    curve = curve_of(toe.inputs, Laboratory.of(toe.settings))
    assert tissue_beside(replace(curve, samples=replace_samples(curve.samples))) is None


def replace_samples(samples):
    """The same where the leg passed ten degrees alone."""
    near = np.abs(samples.angle) < 5.0
    return replace(
        samples, angle=samples.angle[near], velocity=samples.velocity[near], torque=samples.torque
    )


def test_the_tissue_is_in_the_torque_of_every_model(toe) -> None:
    inputs = toe.inputs[0]
    tissue = TissueCurve((-40.0, 0.0, 20.0), (0.0, 1.0, 4.0), (0.3,), (1.0,))
    for name in ("muscle", "muscle-tendon", "muscle-2010"):
        spec = get_model(name)
        values = np.array([p.start for p in spec.parameters])
        bare = spec.simulator(inputs, ModelOptions())
        beside = spec.simulator(inputs, ModelOptions(tissue=tissue))
        expected = tissue.of(inputs)
        np.testing.assert_allclose(
            beside.torque(values) - bare.torque(values), expected, rtol=0, atol=1e-9
        )
        torque, jacobian = beside.torque_jacobian(values, [0, 1])
        np.testing.assert_allclose(torque, beside.torque(values), rtol=0, atol=1e-9)
        np.testing.assert_allclose(jacobian, bare.torque_jacobian(values, [0, 1])[1])
        parts = beside.parts(values)
        np.testing.assert_allclose(parts.joint, expected)
        np.testing.assert_allclose(parts.total, torque, rtol=0, atol=1e-9)


def test_a_curve_relaxes_as_it_says() -> None:
    curve = TissueCurve((0.0, 10.0), (0.0, 5.0), (0.4,), (2.0,))
    rate = 100.0
    degrees = np.concatenate([[0.0], np.full(1000, 10.0)])
    after = np.arange(1000) / rate
    stays = np.exp(-1.0 / (rate * 2.0))
    expected = 5.0 * (1.0 + 0.4 * stays * np.exp(-after / 2.0))
    np.testing.assert_allclose(curve.along(degrees, rate)[1:], expected, rtol=1e-9)
    assert curve.relaxed(5.0) == 2.5
    assert curve.slope(5.0) == pytest.approx(0.5)
    assert curve.relaxed(30.0) == 5.0


@pytest.mark.parametrize(
    ("table", "said"),
    [
        (((0.0,), (1.0,)), "two or more angles"),
        (((0.0, 1.0), (1.0,)), "two or more angles"),
        (((0.0, 0.0), (1.0, 2.0)), "angles that rise"),
        (((0.0, 1.0), (1.0, 2.0), (0.1,), (0.0,)), "time above 0 s"),
        (((0.0, 1.0), (1.0, 2.0), (0.1,)), "time above 0 s"),
    ],
)
def test_what_is_no_table_is_refused(table, said) -> None:
    with pytest.raises(InputError, match=said):
        TissueCurve(*table)


def test_options_with_a_curve_are_saved_and_read() -> None:
    given = ModelOptions(tissue=TissueCurve((0.0, 10.0), (0.0, 5.0), (0.4,), (2.0,)))
    assert ModelOptions.of(**given.as_dict()) == given
    assert "tissue" not in ModelOptions().as_dict()


@pytest.mark.parametrize("fast", [None, 0.0])
def test_what_another_curve_would_move(toe, fast) -> None:
    """The shift is −V times the change of the gradient, which is linear in the torque."""
    short = replace(toe, inputs=FitSettings.of().inputs(parted([brief()])))
    family = Family(short)
    noise = (NoiseModel.white(0.04, float(short.inputs[0].n)),)
    post = family.posterior((), 32.0, noise, BEGIN).having(fast=fast)
    point = post.descend(post.start({}), tolerance=1.0, evaluations=3)
    post.observed.anew()  # what latents add is that of this point, in both
    point = post.again(point)
    tissue = TissueCurve((-40.0, -10.0, 20.0), (0.0, 0.4, 1.5), (0.2,), (1.0,))
    V = post.covariance(point)
    recording = post.problem.inputs[0]
    moved = tissue.of(recording)
    shifts = laplace.by_torque(post, point, V, [moved[:, None]])
    less = replace(recording, torque=recording.torque - moved)
    other = post.having(problem=replace(post.problem, inputs=(less,)))
    other.observed = other._anew()
    at = post.block(point.z, point.c[0], point.w[0], 0)
    there = other.block(point.z, point.c[0], point.w[0], 0)
    np.testing.assert_allclose(shifts[0], -V @ (there.g - at.g), rtol=1e-5, atol=1e-9)


def brief():
    recording = measured(Ankle(toe=-5.0, stiff=0.8), 1, emg=EMG)
    inside = TIME < 20.0
    channels = {
        role: replace(c, time=c.time[inside], values=c.values[inside])
        for role, c in recording.channels.items()
    }
    return replace(recording, channels=channels)


def test_doubts_are_of_the_curve(toe) -> None:
    curve = curve_of(toe.inputs, Laboratory.of(toe.settings))
    each = doubts_of(with_rest(toe))
    degrees = np.array(each[0].degrees)
    spread = sum(np.array(one.torque) ** 2 for one in each)
    np.testing.assert_allclose(spread, np.diag(curve.torque(degrees)[1]), rtol=0.02, atol=1e-4)


@pytest.mark.slow
@pytest.mark.parametrize(
    ("leg", "asked"),
    [("ra-501", False), ("ra-502", False), ("rl-3-502", False), ("rb-501", True), ("rc-502", True)],
)
def test_whose_tissue_is_no_exponential_on_legs_of_others(leg, asked, tmp_path) -> None:
    make = pytest.importorskip("ankle_legs.make")
    family, seed = leg.rsplit("-", 1)
    make.make(family, int(seed), tmp_path, trials=[2])
    inputs = FitSettings.of().inputs(parted([read(tmp_path / leg / "trial-2.csv")]))
    given = make_problem(inputs, "auto")
    assert (with_rest(given).options.tissue is not None) is asked
