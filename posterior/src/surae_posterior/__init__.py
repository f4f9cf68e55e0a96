"""Draws from the posterior of a named model, by adaptive importance sampling."""
