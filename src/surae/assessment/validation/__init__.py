"""How well parameters of some recordings predict others."""
