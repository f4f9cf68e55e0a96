from dataclasses import replace

import numpy as np
import pytest

from surae.assessment.posterior.sample import sample
from surae.estimation import fit_problem, make_problem
from surae.report.figures import png
from surae.report.figures.intervals import posterior_figure

from .conftest import TRUTH


@pytest.fixture(scope="module")
def posterior(sampler, make_trial):
    fixed = {name: TRUTH[name] for name in TRUTH if name not in ("f0", "beta", "tau_rel", "k_rel")}
    fitted = fit_problem(make_problem([make_trial()], fixed=fixed), starts=1)
    return sample(fitted, draws=60, tune=100, chains=2)


def titles(figure):
    return [axes.get_title(loc="left") for axes in figure.axes]


def test_a_panel_for_each_parameter_and_the_correlated_pairs(posterior):
    figure = posterior_figure(posterior)
    drawn = titles(figure)
    assert drawn[:4] == ["tau_rel", "k_rel", "f0", "beta"]
    assert all(title.startswith("correlation") for title in drawn[4:])
    assert len(drawn) > 4
    assert figure.get_supxlabel() == posterior.noise == "variance of the noise ×1"
    filmed = replace(posterior, names=(*posterior.names, "film_zero_gm"))
    assert filmed.noise.endswith("of the torque alone: without the film of gm")
    labels = [text.get_text() for text in figure.legends[0].get_texts()]
    assert labels == ["posterior", "covariance", "prior", "95 % credible"]
    assert png(figure).startswith(b"\x89PNG")


def test_the_prior_is_a_density(posterior):
    figure = posterior_figure(posterior)
    (line,) = [line for line in figure.axes[2].get_lines() if line.get_label() == "prior"]
    x, y = line.get_data()
    median, spread = posterior["f0"].prior.median, posterior["f0"].prior.spread
    expected = np.exp(-((np.log(x / median) / spread) ** 2) / 2) / (spread * x * np.sqrt(2 * np.pi))
    assert y == pytest.approx(expected)


def test_a_parameter_without_variance_has_no_gaussian(posterior):
    names = posterior.covariance.names[1:]
    less = replace(
        posterior,
        covariance=replace(
            posterior.covariance, names=names, matrix=posterior.covariance.matrix[1:, 1:]
        ),
        marginals={
            name: replace(
                marginal, from_covariance=marginal.from_covariance if name in names else None
            )
            for name, marginal in posterior.marginals.items()
        },
    )
    drawn = posterior_figure(less).axes[0]
    assert "covariance" not in [line.get_label() for line in drawn.get_lines()]
    assert less["tau_rel"].off_covariance is None
