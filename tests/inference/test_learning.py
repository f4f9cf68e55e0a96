"""Sizes of what differs from moment to moment: of known ones, and as whole matrices have them."""

from dataclasses import replace

import numpy as np
import pytest
from scipy.linalg import block_diag

from surae.base.frozen import read_only
from surae.inference import make_problem
from surae.inference.noise import NoiseModel
from surae.inference.posterior import log_posterior as posterior_module
from surae.inference.posterior.banded import solve_band, solve_band_transposed
from surae.inference.posterior.empirical_bayes import BEGIN, learnt_sizes
from surae.inference.posterior.family import Family
from surae.inference.posterior.laplace import shifts_by_source, softened
from surae.inference.posterior.latent import SOURCES
from surae.inference.posterior.linearised import measured
from surae.inference.posterior.log_posterior import LogPosterior
from surae.inference.posterior.valleys import white_noise
from surae.protocol import Protocol, generate
from surae.signals import Film
from surae.studies import virtual_subject, virtual_trial

#: Standard deviation of the torque's noise [Nm].
NOISE = 0.05


def a_posterior(
    seconds: float = 12.0,
    *,
    films: bool = False,
    number: int = 1,
    rectified: tuple[float, ...] = (),
) -> LogPosterior:
    """Of short trials of one leg, its departures off."""
    protocol = Protocol(profile="multiple-holds", duration=seconds, rate_hz=64.0)
    trial = virtual_trial(virtual_subject(3), generate(protocol), noise=0.02, model="muscle-tendon")
    if films:
        time = np.arange(1.0, seconds - 1.0, 1 / 30.0)
        length = 0.06 + 0.01 * np.sin(time)
        trial = replace(trial, films=(Film("fascicle_tib", read_only(time), read_only(length)),))
    trials = [replace(trial, name=f"trial {i}", rectified=rectified) for i in range(number)]
    family = Family(make_problem(trials, "auto"))
    return family.posterior((), 64.0, white_noise(family.original, 0.05), BEGIN)


def dense(posterior: LogPosterior, point) -> dict[str, float]:
    """The sizes by MacKay's formula, of the inverse of one matrix of everything."""
    q = len(point.z)
    columns, priors, spans = [], [], []
    at = q
    for i, latents in enumerate(posterior.latents):
        m, k = len(point.c[i]), len(point.w[i])
        rows_of = []
        for rows, variance in zip(posterior.rows(point, i), posterior.variances(i), strict=True):
            fast = np.zeros((k, rows.whole.shape[1]))
            for row, column, first in zip(fast, rows.fast, rows.first, strict=True):
                piece = row[first : first + len(column)]
                piece[:] = column[: len(piece)]
            rows_of.append(np.concatenate([rows.by_z, rows.by_c, fast]) / np.sqrt(variance))
        columns.append(np.concatenate(rows_of, axis=1))
        band = posterior._fast[i][0]
        fast = np.diag(band[0])
        for below in range(1, len(band)):
            fast += np.diag(band[below, :-below], -below) + np.diag(band[below, :-below], below)
        priors.append(block_diag(latents.precision(posterior.sizes), fast))
        spans.append(at)
        at += m + k
    H = block_diag(np.diag(posterior.weight**2), *priors)
    for J, begin, block in zip(columns, spans, point.blocks, strict=True):
        z = np.arange(q)[block.at]  # not those of other recordings
        own = np.r_[z, begin : begin + len(J) - len(z)]
        H[np.ix_(own, own)] += J @ J.T
    V = np.linalg.inv(H)
    sizes = {}
    for source, before in BEGIN.items():
        square = told = 0.0
        for c, latents, begin in zip(point.c, posterior.latents, spans, strict=True):
            at, K = latents.slices[source], latents.inverses[source]
            own = slice(begin + at.start, begin + at.stop)
            square += c[at] @ K @ c[at]
            told += len(K) - np.trace(K @ V[own, own]) / posterior.sizes[source] ** 2
        sizes[source] = np.sqrt((square + 2.0 * before**2) / (told + 2.0))
    return sizes


@pytest.mark.parametrize("number", [pytest.param(1, marks=pytest.mark.slow), 2])
def test_sizes_are_those_of_whole_matrices(number) -> None:
    """The banded and bordered algebra leaves nothing out: films, fast gains, several trials."""
    posterior = a_posterior(films=True, number=number).having(fast=0.1)
    rng = np.random.default_rng(2)
    c = [0.05 * rng.standard_normal(len(own)) for own in posterior.still()]
    w = [0.05 * rng.standard_normal(len(own)) for own in posterior.expected()]
    point = posterior.descend(posterior.start({}), c, w, evaluations=0, tolerance=1.0)
    learnt, whole = learnt_sizes(posterior, point, BEGIN), dense(posterior, point)
    assert set(learnt) == set(SOURCES)
    for source in SOURCES:
        assert learnt[source] == pytest.approx(whole[source], rel=1e-5), source


def test_errors_of_another_size_are_judged_without_a_simulation() -> None:
    """What is expected of the drives is another then: its difference is in the gains."""
    posterior = a_posterior().having(fast=0.1)
    point = posterior.descend(posterior.start({}), tolerance=0.1)
    # what gains move is kept as it was where a descent began: here both begin at the same point
    point = posterior.descend(point.z, point.c, point.w, tolerance=0.1)
    spent = posterior.observed.calls[0]
    other = posterior.with_errors(0.12)
    other.evidence(other.again(point))
    assert posterior.observed.calls[0] == spent
    whole = posterior.having(fast=0.12)
    differ = other.evidence(other.again(point)) - whole.evidence(whole.again(point))
    assert abs(differ) < 0.1  # to first order
    assert posterior.with_errors(0.1).evidence(point) == posterior.evidence(point)


def test_where_drives_have_known_noise_a_descent_factorises_it_once(monkeypatch) -> None:
    """And once more for every posterior whose noise or sizes are others."""
    posterior = a_posterior(rectified=(0.01,) * 4).having(fast=0.0)
    points, factors = [], []
    block, factorise = LogPosterior.block, posterior_module.cholesky_banded
    monkeypatch.setattr(LogPosterior, "block", lambda *of: points.append(of) or block(*of))
    monkeypatch.setattr(
        posterior_module,
        "cholesky_banded",
        lambda *of, **how: factors.append(of) or factorise(*of, **how),
    )
    at = posterior.descend(posterior.start({}), evaluations=3, tolerance=1e-9)
    assert (len(points), len(factors)) == (4, 1)
    posterior.having(sizes={**BEGIN, "drift": 0.2}).again(at)
    assert len(factors) == 2


def simulated(posterior: LogPosterior, sizes: dict[str, float], seed: int):
    """The posterior of a trial whose latents are drawn with these sizes, its true z and c."""
    rng = np.random.default_rng(seed)
    (latents,), (recording,) = posterior.latents, posterior.problem.inputs
    root = np.linalg.cholesky(np.linalg.inv(latents.precision(sizes)))
    c = root @ rng.standard_normal(latents.size)
    z = posterior.start(virtual_subject(3).truth("muscle-tendon"))
    torque = posterior.observed.rows(z, c, np.zeros(0), 0)[0].residual + measured(recording)
    torque = read_only(torque + NOISE * rng.standard_normal(len(torque)))
    noise = NoiseModel(np.zeros(0), NOISE**2, np.array([NOISE**2]), float(len(torque)))
    problem = replace(posterior.problem, inputs=(replace(recording, torque=torque),))
    beliefs = posterior.beliefs
    one = LogPosterior(problem, posterior.priors, [noise], [latents], BEGIN, beliefs=beliefs)
    return one, z, c


@pytest.mark.parametrize(
    "true",
    [
        {"gain": 0.1, "drift": 0.5, "misfit": 0.001, "softening": 0.01},
        pytest.param(
            {"gain": 0.003, "drift": 0.02, "misfit": 0.05, "softening": 0.3},
            marks=pytest.mark.slow,
        ),
    ],
)
def test_known_sizes_are_learnt(true) -> None:
    """Of a leg that is known. What is smaller than expected beforehand is never taken for more."""
    posterior, ratios = a_posterior(25.0), {source: [] for source in SOURCES}
    for seed in range(6):
        one, z, c = simulated(posterior, true, seed)
        one = one.having(mean=z, weight=1e6 * one.weight)  # else it follows some of what was drawn
        point = one.descend(z, evaluations=15, tolerance=0.1)
        for _ in range(5):
            one = one.having(sizes=learnt_sizes(one, point, BEGIN))
            point = one.descend(point.z, point.c, evaluations=10, tolerance=0.1)
        for source, before in BEGIN.items():
            if true[source] < before:
                assert one.sizes[source] < before
                continue
            at, K = one.latents[0].slices[source], one.latents[0].inverses[source]
            # what was drawn, and the size beforehand, which counts for two values
            drawn = np.sqrt((c[at] @ K @ c[at] + 2.0 * before**2) / (len(K) + 2.0))
            ratios[source].append(one.sizes[source] / drawn)
    for source, each in ratios.items():
        if each:
            assert np.mean(each) == pytest.approx(1.0, abs=0.15), source
            np.testing.assert_allclose(each, 1.0, atol=0.35)


def test_what_the_data_do_not_tell_stays_as_it_was() -> None:
    posterior = a_posterior()
    huge = NoiseModel(np.zeros(0), 1e12, np.array([1e12]), 100.0)
    posterior = posterior.having(noise=(huge,))
    point = posterior.descend(posterior.start({}), evaluations=0, tolerance=1.0)
    assert learnt_sizes(posterior, point, BEGIN) == pytest.approx(BEGIN, rel=1e-3)


def test_what_makes_estimates_unsure_adds_up_to_their_covariance() -> None:
    """V = V·JᵀJ·V + Σ V·P·V: priors, latents, films and fast gains, and the rest is noise."""
    posterior = a_posterior(films=True).having(fast=0.1)
    point = posterior.descend(posterior.start({}), evaluations=0, tolerance=1.0)
    V = posterior.covariance(point)
    shifts = shifts_by_source(posterior, point.blocks, V)
    total = sum(by.T @ by for by in shifts.values())
    sd = np.sqrt(np.diag(V))
    # But for rounding, beside the widest of coordinates of very different size.
    np.testing.assert_allclose(total / sd / sd[:, None], V / sd / sd[:, None], atol=1e-3)
    assert {"noise", "population", "zero", "emg_gain", "film_drift", "emg_noise"} <= set(shifts)


def test_a_banded_system_is_solved_as_a_dense_one() -> None:
    rng = np.random.default_rng(4)
    lower = np.tril(rng.normal(size=(9, 9))) * (np.subtract.outer(range(9), range(9)) < 4)
    lower += 5.0 * np.eye(9)
    band = np.array([np.pad(np.diag(lower, -d), (0, d)) for d in range(4)]).T.copy()
    right = rng.normal(size=(9, 3))
    np.testing.assert_allclose(solve_band(band, right), np.linalg.solve(lower, right))
    np.testing.assert_allclose(solve_band_transposed(band, right), np.linalg.solve(lower.T, right))


@pytest.mark.parametrize("share", [0.0, 0.35, -0.35])
def test_tissue_that_softens_is_told_and_its_conditioned_state_is_read(share) -> None:
    """Steady tissue, and such as becomes stiffer, is not said to soften."""
    posterior, few = a_posterior(25.0), dict.fromkeys(SOURCES, 1e-06)
    one, z, c = simulated(posterior, few, 3)
    (latents,), at = posterior.latents, posterior.latents[0].slices["softening"]
    c[at] = share * np.tile([0.0, 1.0, 0.0], 2)
    more = posterior.observed.rows(z, c, np.zeros(0), 0)[0].residual.copy()
    more -= posterior.observed.rows(z, 0.0 * c, np.zeros(0), 0)[0].residual
    (recording,) = one.problem.inputs
    torque = read_only(recording.torque + more)
    problem = replace(one.problem, inputs=(replace(recording, torque=torque),))
    one = LogPosterior(problem, one.priors, one.noise, [latents], BEGIN, beliefs=one.beliefs)
    point = one.descend(z, evaluations=15, tolerance=0.1)
    for _ in range(3):
        one = one.having(sizes=learnt_sizes(one, point, BEGIN))
        point = one.descend(point.z, point.c, evaluations=10, tolerance=0.1)
    ((size, sd),) = softened(one, point, one.covariance(point))
    assert (size > 3.0 * sd) == (share > 0.0)
    apart = np.abs(point.z - z) / np.sqrt(np.diag(one.covariance(point)))
    assert np.median(apart) < 1.0
    assert apart[one.names.index("k_tri")] < 3.0
