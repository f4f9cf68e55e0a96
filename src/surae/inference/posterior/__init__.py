"""The family of models with an imperfect laboratory: one posterior, its mode, its departures."""
