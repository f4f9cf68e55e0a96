"""The posterior that a fit of `auto` chose, at its mode, from the fit as it was saved."""

from dataclasses import replace

from surae.base.errors import InputError
from surae.base.threads import one_blas_thread
from surae.inference import FitResult, PosteriorMode
from surae.inference.metres import OwnMetres
from surae.inference.posterior.empirical_bayes import NEARLY_NONE, Reached
from surae.inference.posterior.family import RATE_HZ, Family


def resumed(result: FitResult) -> Reached:
    """The posterior that a fit of `fit_family` chose, and its mode."""
    solution = result.solution
    assert isinstance(solution, PosteriorMode)
    with one_blas_thread():
        metres = OwnMetres.of(result.problem)
        latent = result.problem.spec.vector(result.values, result.problem.options)
        family = Family(metres.limits(result.problem, latent, back=True))
        if solution.sizes["gain"] == NEARLY_NONE["gain"]:
            family.hold_still()
        sizes = {**NEARLY_NONE, **solution.sizes}  # older fits know of no softening
        post = family.posterior(solution.candidates[0].groups, RATE_HZ, solution.noise, sizes)
        if len(solution.films) != sum(len(latent.films) for latent in post.latents):
            raise InputError("this fit kept no noise of its films: fit again")
        noise = iter(solution.films)
        latents = tuple(
            replace(
                latent, films=tuple([replace(film, noise=next(noise)) for film in latent.films])
            )
            for latent in post.latents
        )
        fast = None if family.is_perfect else solution.sizes.get("drive")
        post = post.having(latents=latents, fast=fast)
        z = post.start(result.values)
        for j, name in enumerate(post.per_recording):
            if name in solution.each:  # older fits share the EMG at rest
                post.each(z)[:, j] = solution.each[name]
        return post, post.descend(z, tolerance=1e-3)
