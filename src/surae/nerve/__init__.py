"""How much is nerve: tissue and reflex of an ankle, from perturbations and from stretches."""
