"""The relaxed leg by its rest alone: torque over angle as measured, without a model of muscles.

    T = E(θ) + Σ γᵢ·HP_τᵢ[E(θ(t))] + N·c + n

E is a flexible elastic curve, linear in its weights; γ is quasi-linear relaxation (Fung 1993), N
are foot, plate, sensor and what went before, n is noise that may be correlated. Everything is
linear but γ, so that the posterior is linear algebra.
"""
